"""Which stretches of a motion a figure looks at: sliding windows, windows on transitions, random crops."""

from __future__ import annotations

from collections.abc import Sequence

from numpy.random import Generator

#: Frames of a window and between two, at 20 frames a second: T2LM's.
WINDOW, STRIDE = 80, 40
#: Crops of a motion and seconds of each: STMC's.
CROPS, CROP_SECONDS = 5, 5.0

Span = tuple[int, int]


def sliding_windows(frames: int, length: int = WINDOW, stride: int = STRIDE) -> list[Span]:
    """First and last frame (excluded) of windows from the start to the end of a motion; what is left over is not seen.

    Sliding scope (SS) of T2LM (Lee et al., CVPRW 2024).

    Raises
    ------
    ValueError
        If the motion is shorter than a window.
    """
    _check(frames, length)
    return [(start, start + length) for start in range(0, frames - length + 1, stride)]


def transition_windows(frames: int, transitions: Sequence[int], length: int = WINDOW) -> list[Span]:
    """Windows centred on transitions, moved in from the ends of the motion: the transition scope (TS) of T2LM.

    Raises
    ------
    ValueError
        If the motion is shorter than a window, or a transition lies outside it.
    """
    _check(frames, length)
    outside = [place for place in transitions if not 0 < place < frames]
    if outside:
        raise ValueError(f"a transition at frame {outside[0]} lies outside the {frames} frames")
    starts = [min(max(place - length // 2, 0), frames - length) for place in transitions]
    return [(start, start + length) for start in starts]


def random_crops(frames: int, length: int, rng: Generator, count: int = CROPS) -> list[Span]:
    """`count` random stretches of `length` frames, as FID+ of STMC (CVPRW 2024); a shorter motion as it is."""
    if frames <= length:
        return [(0, frames)] * count
    return [(int(start), int(start) + length) for start in rng.integers(frames - length + 1, size=count)]


def _check(frames: int, length: int) -> None:
    if frames < length:
        raise ValueError(f"a motion of {frames} frames is shorter than a window of {length}")
