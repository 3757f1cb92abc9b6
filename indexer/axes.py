"""Which way is up, and is the figure seen in a mirror?"""

from __future__ import annotations

import numpy as np

from indexer.figure import Array, Figure, unit

#: Rotations that bring an axis to +Y, for +x, +y, +z, -x, -y, -z.
_TO_Y = (
    np.array([[0.0, -1, 0], [1, 0, 0], [0, 0, 1]]),
    np.eye(3),
    np.array([[1.0, 0, 0], [0, 0, 1], [0, -1, 0]]),
    np.array([[0.0, 1, 0], [-1, 0, 0], [0, 0, 1]]),
    np.diag([1.0, -1, -1]),
    np.array([[1.0, 0, 0], [0, 0, -1], [0, 1, 0]]),
)


def upright(figure: Figure) -> Array:
    """The rotation (3, 3) that brings a figure's up axis to +Y."""
    trunk = unit(figure.marks["head"] - figure.middle("hip")).mean(axis=0)
    return _TO_Y[int(np.argmax(np.concatenate([trunk, -trunk])))]
