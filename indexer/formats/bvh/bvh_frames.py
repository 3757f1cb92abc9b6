"""The numbers of a BVH file: one line of channel values a frame, whole or damaged."""

from __future__ import annotations

import re
from os import PathLike
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from encoders.errors import UnreadableMotion
from indexer.formats.mending import is_hopeless
from indexer.formats.numbers import SEPARATORS, Numbers, parse_lines

#: Neither an angle nor a place is larger, unless the usual one is in the same file.
ABSURD = 1e6

_NUMBER = r"[-+]?[\d.,]+(?:e[-+]?\d+)?"
_FRAMES = re.compile(r"[\s,]*frames[ \t]*:?[\s,]*(?P<count>[-+]?\d{1,18})", re.IGNORECASE)
_FRAME_TIME = re.compile(
    rf"[\s,]*frame[ \t_]*time[ \t]*:?[\s,]*(?P<time>{_NUMBER}|[-+]?nan|[-+]?inf\w*)", re.IGNORECASE
)
_DECIMAL_COMMAS = bytes.maketrans(b",;", b". ")


class BvhFrames(NamedTuple):
    """Channel values (T, C), NaN where a frame is damaged; the time between two frames; what was left out."""

    values: NDArray[np.float64]
    frame_time: float
    warnings: tuple[str, ...]


def read_frames(path: str | PathLike[str], data: bytes, at: int, channels: int) -> BvhFrames:
    """What follows MOTION, which ends at a place in a file.

    Raises
    ------
    UnreadableMotion
        Where no frame is whole, or most are damaged; the reason says what is wrong.
    """
    text = data[at : at + 1000].decode("latin-1")
    frames = _FRAMES.match(text)
    time = _FRAME_TIME.match(text, frames.end() if frames else 0)
    if time is None:
        raise UnreadableMotion(path, "the MOTION section names no Frame Time")
    if channels == 0:
        raise UnreadableMotion(path, "no joint has channels, so nothing moves")
    declared = int(frames["count"]) if frames else None
    try:
        numbers = _numbers(data[at + time.end() :], channels, declared)
    except ValueError as error:
        raise UnreadableMotion(path, f"the motion is not all numbers: {error}") from None
    values, missing = _rows(path, numbers, channels)
    warnings = []
    if missing:
        warnings.append(missing)
    if declared is not None and declared > len(values):
        warnings.append(f"it announces {declared} frames but holds {len(values)} whole ones")
    try:
        frame_time = float(time["time"].rstrip(",").replace(",", "."))
    except ValueError:
        frame_time = np.nan
    return BvhFrames(values, frame_time, tuple(warnings))


def _numbers(text: bytes, channels: int, declared: int | None) -> Numbers:
    """The numbers of a text; commas part them, unless there are as many as announced where commas are points."""
    if b"," not in text and b";" not in text:
        return parse_lines(text)
    parted = parse_lines(text.translate(SEPARATORS))
    if _fits(parted, channels, declared):
        return parted
    decimal = parse_lines(text.translate(_DECIMAL_COMMAS))
    return decimal if _fits(decimal, channels, declared) else parted


def _fits(numbers: Numbers, channels: int, declared: int | None) -> bool:
    """Whether there are as many numbers as announced, or as many in nearly every line."""
    if declared is not None and len(numbers.values) == declared * channels:
        return True
    counts = numbers.per_line()
    return bool(len(counts)) and float((counts == channels).mean()) > 0.5


def _rows(path: str | PathLike[str], numbers: Numbers, channels: int) -> tuple[NDArray[np.float64], str]:
    """Channel values (T, channels), those of a damaged line NaN; what is missing at the end, in words."""
    values = numbers.values
    counts = numbers.per_line()
    if len(counts) > 1 and (counts == channels).mean() > 0.5:  # lines are frames; else numbers run on
        lines = np.split(values, np.cumsum(counts)[:-1]) if (counts % channels).any() else []
        if lines and len(lines[-1]) % channels:
            lines.pop()
            cut = f"the last frame is cut short ({counts[-1]} of {channels} numbers) and left out"
        else:
            cut = ""
        if lines:
            damaged = np.full(channels, np.nan)
            values = np.concatenate([line if len(line) % channels == 0 else damaged for line in lines])
    else:
        left = len(values) % channels
        cut = f"the last frame is cut short ({left} of {channels} numbers) and left out" if left else ""
        values = values[: len(values) - left]
    if not len(values):
        raise UnreadableMotion(path, "the file holds no frames")
    rows = values.reshape(-1, channels)
    broken = _broken(rows)
    if broken.any():
        if is_hopeless(broken):
            frame = int(broken.argmax()) + 1
            word = f", such as {numbers.wrong!r}" if numbers.wrong else ""
            raise UnreadableMotion(path, f"frame {frame} holds values that are no numbers{word}")
        rows = np.where(broken[:, None], np.nan, rows)
    return rows, cut


def _broken(rows: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Which frames (T, C) hold values that are not finite, or absurd beside those of the other frames."""
    broken = np.zeros(len(rows), np.bool_)
    with np.errstate(invalid="ignore", over="ignore"):
        largest = np.abs(rows).max()
        if not largest <= ABSURD:
            usual = np.nanmedian(np.abs(rows), axis=0)
            broken = ~(np.abs(rows) <= np.maximum(ABSURD, 100 * usual)).all(axis=1)
    return broken
