"""The window grid: which stretches of a clip have a vector of their own."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

#: Seconds; each window starts a quarter of its length after the one before.
LENGTHS = (1.6, 3.2, 6.4)
WINDOWS_A_LENGTH = 4


@dataclass(frozen=True)
class Windows:
    """The windows of one clip and one length.

    Attributes
    ----------
    length : float
        Seconds.
    starts, ends : float32 arrays (n,)
        Seconds; only the one window of a clip shorter than `length` ends before start + length.
    vectors : float16 array (n, D)
        Unit vectors.
    """

    length: float
    starts: NDArray[np.float32]
    ends: NDArray[np.float32]
    vectors: NDArray[np.float16]

    @staticmethod
    def of(length: float, duration: float, starts: bytes, vectors: bytes) -> Windows:
        """From the arrays as they are stored."""
        begin = np.frombuffer(starts, np.float32)
        return Windows(
            length, begin, ends_of(begin, length, duration), np.frombuffer(vectors, np.float16).reshape(len(begin), -1)
        )


def ends_of(starts: NDArray[np.float32], length: float, duration: float) -> NDArray[np.float32]:
    """Where windows end, in seconds: never after the clip."""
    return np.asarray(np.minimum(starts + np.float32(length), duration), np.float32)


def first_rows(rows: int, size: int) -> NDArray[np.int64]:
    """Where windows of `size` feature rows start in a clip of `rows`; the last one is flush with the end."""
    stride = max(size // WINDOWS_A_LENGTH, 1)
    starts = np.arange(0, max(rows - size, 0) + 1, stride)
    return starts if starts[-1] + size >= rows else np.append(starts, rows - size)


def grid(rows: int, fps: float) -> dict[float, tuple[NDArray[np.int64], int]]:
    """Window length in seconds -> (first rows, rows a window) for a clip of `rows` feature rows at `fps`.

    A length longer than the clip has no windows, but the shortest length always has one: the whole clip.
    """
    sizes = {length: max(round(length * fps), 1) for length in LENGTHS}
    return {
        length: (first_rows(rows, size), min(size, rows))
        for length, size in sizes.items()
        if size <= rows or length == LENGTHS[0]
    }
