"""Windows: the grid of stretches of a clip that have a vector of their own, and their encoding."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from encoders.protocol import Encoder

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


def window_starts(frames: int, length: int, stride: int = 1) -> NDArray[np.int64]:
    """First frames (N,) of windows of `length` frames, `stride` apart; the last window ends at the last of `frames`.

    A clip shorter than a window is one window.
    """
    last = max(frames - length, 0)
    return np.append(np.arange(0, last, max(stride, 1), dtype=np.int64), last)


def grid(frames: int, fps: float) -> dict[float, tuple[NDArray[np.int64], int]]:
    """Window length in seconds -> (first frames, frames a window) of a clip of `frames` feature frames at `fps`.

    A length longer than the clip has no windows, but the shortest length always has one: the whole clip.
    """
    sizes = {length: max(round(length * fps), 1) for length in LENGTHS}
    return {
        length: (window_starts(frames, size, size // WINDOWS_A_LENGTH), min(size, frames))
        for length, size in sizes.items()
        if size <= frames or length == LENGTHS[0]
    }


def encode_grids(
    encoder: Encoder, features: Sequence[NDArray[np.float32]], durations: Sequence[float]
) -> list[list[Windows]]:
    """The windows of clips with their vectors, of each clip shortest first; all of them are encoded together.

    Parameters
    ----------
    features : sequence of float32 arrays (T', F)
        Of the whole clips.
    durations : sequence of float
        Seconds, of each clip.
    """
    grids = [grid(len(rows), encoder.fps) for rows in features]
    pieces = [
        rows[start : start + size]
        for rows, lengths in zip(features, grids, strict=True)
        for starts, size in lengths.values()
        for start in starts
    ]
    counts = [len(starts) for lengths in grids for starts, _ in lengths.values()]
    vectors = iter(np.split(encoder.encode_features(pieces).astype(np.float16), np.cumsum(counts)[:-1]))
    encoded = []
    for lengths, duration in zip(grids, durations, strict=True):
        windows = []
        for length, (frames, _) in lengths.items():
            starts = (frames / encoder.fps).astype(np.float32)
            windows.append(Windows(length, starts, ends_of(starts, length, duration), next(vectors)))
        encoded.append(windows)
    return encoded
