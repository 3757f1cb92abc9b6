"""The feature kinds a model can read, by the name its bundle states: the project's and other distributions'."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from encoders import extensions
from encoders.errors import BundleError
from encoders.features import canonical, humanml3d, rifke
from encoders.motion import Motion


@dataclass(frozen=True)
class FeatureKind:
    """How a motion becomes numbers.

    Attributes
    ----------
    name : str
        The name in a bundle's manifest.
    size : int
        Numbers a frame.
    fps : float
        Feature frames a second.
    compute : callable
        Motion at any rate -> float32 array (T', size).
    compute_many : callable, optional
        Motions -> a list of the same arrays, where that is quicker than one by one.
    """

    name: str
    size: int
    fps: float
    compute: Callable[[Motion], NDArray[np.float32]]
    compute_many: Callable[[Sequence[Motion]], list[NDArray[np.float32]]] | None = None


FEATURE_KINDS = {
    kind.name: kind
    for kind in (
        FeatureKind("body", canonical.SIZE, canonical.FPS, canonical.of_motion, canonical.of_motions),
        FeatureKind("humanml3d", humanml3d.SIZE, humanml3d.FPS, humanml3d.of_motion),
        FeatureKind("rifke", rifke.SIZE, rifke.FPS, rifke.of_motion),
    )
}


def feature_kind(name: str) -> FeatureKind:
    """The feature kind of a name; one of another distribution is found by its entry point.

    Raises
    ------
    BundleError
        If there is none of that name, or what the entry point names is none.
    """
    if name in FEATURE_KINDS:
        return FEATURE_KINDS[name]
    found = extensions.load_extension(extensions.FEATURES, name)
    if found is None:
        known = [*FEATURE_KINDS, *dict(extensions.owners(extensions.FEATURES))]
        raise BundleError(f"feature kind {name!r} is unknown; known: {', '.join(known)}")
    if not isinstance(found, FeatureKind) or found.name != name or found.size < 1 or not found.fps > 0:
        raise BundleError(f"{extensions.FEATURES} {name!r} names {found!r}, which is no FeatureKind of that name")
    return found
