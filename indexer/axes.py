"""Which way is up, and is the figure seen in a mirror?"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

#: Rotations that bring an axis to +Y, for +x, +y, +z, -x, -y, -z.
_TO_Y = (
    np.array([[0.0, -1, 0], [1, 0, 0], [0, 0, 1]]),
    np.eye(3),
    np.array([[1.0, 0, 0], [0, 0, 1], [0, -1, 0]]),
    np.array([[0.0, 1, 0], [-1, 0, 0], [0, 0, 1]]),
    np.diag([1.0, -1, -1]),
    np.array([[1.0, 0, 0], [0, 0, -1], [0, 1, 0]]),
)


def to_y_up(marks: dict[str, Array], spine: Array) -> tuple[dict[str, Array], Array]:
    """The same figure with +Y up, turned, not mirrored."""
    trunk = marks["head"] - (marks["left_hip"] + marks["right_hip"]) / 2
    trunk = trunk / np.maximum(np.linalg.norm(trunk, axis=-1, keepdims=True), 1e-9)
    mean = trunk.mean(axis=0)
    turn = _TO_Y[int(np.argmax(np.concatenate([mean, -mean])))]
    return {name: place @ turn.T for name, place in marks.items()}, spine @ turn.T
