"""Take: a recording as a file holds it, before any skeleton is agreed on."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

UP_AXES = ("x", "y", "z", "-x", "-y", "-z")


@dataclass(frozen=True)
class Take:
    """A skeleton in motion, in the file's own units, axes and frame rate.

    Attributes
    ----------
    names : tuple of str
        Joint names, parents before children.
    parents : int array (J,)
        Parent of each joint, -1 for a root.
    rest : float array (J, 3)
        Joint positions of the rest pose.
    positions : float array (T, J, 3)
        Joint positions in the world.
    fps : float or None
        Frames a second; None where the format does not say.
    name : str
        Which of several takes of one file this is: the name of an animation, the number of a figure. Empty where the
        file holds one.
    up : str or None
        The axis that is up by what the file states, one of `UP_AXES`; None where it states none.
    up_is_certain : bool
        Whether that axis is up whatever the movement looks like.
    warnings : tuple of str
        What was left out, mended or taken for granted.
    rotations : callable or None
        Gives the rotations of the joints in the world, float array (T, J, 3, 3), which turn the bones of the rest pose
        into those of a frame; only an export in the rig of the file asks for them. None where the file has positions
        alone.
    """

    names: tuple[str, ...]
    parents: NDArray[np.int64]
    rest: NDArray[np.float64]
    positions: NDArray[np.float64]
    fps: float | None
    name: str = ""
    up: str | None = None
    up_is_certain: bool = False
    warnings: tuple[str, ...] = ()
    rotations: Callable[[], NDArray[np.float64]] | None = field(default=None, repr=False, compare=False)

    def with_up(self, axis: str | None) -> Take:
        """The take with the axis that a person says is up; None where nobody says so."""
        return self if axis is None else replace(self, up=axis, up_is_certain=True)
