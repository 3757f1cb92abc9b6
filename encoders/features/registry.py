"""The feature kinds a model can be trained on, by the name its bundle states."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from encoders.features import canonical, humanml3d
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
    """

    name: str
    size: int
    fps: float
    compute: Callable[[Motion], NDArray[np.float32]]


FEATURE_KINDS = {
    kind.name: kind
    for kind in (
        FeatureKind("body", canonical.SIZE, canonical.FPS, canonical.of_motion),
        FeatureKind("humanml3d", humanml3d.SIZE, humanml3d.FPS, humanml3d.of_motion),
    )
}
