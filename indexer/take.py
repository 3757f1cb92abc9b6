"""Take: a recording as a file holds it, before any skeleton is agreed on."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray


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
    """

    names: tuple[str, ...]
    parents: NDArray[np.int64]
    rest: NDArray[np.float64]
    positions: NDArray[np.float64]
    fps: float | None
