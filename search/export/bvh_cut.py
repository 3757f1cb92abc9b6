"""Cuts of BVH files: their own hierarchy and their own lines of frames."""

from __future__ import annotations

import re

_FRAMES = re.compile(rb"(?P<name>^[ \t]*Frames[ \t]*:?[ \t]*)(?P<value>\d+)", re.IGNORECASE | re.MULTILINE)
_TIME = re.compile(
    rb"(?P<name>^[ \t]*Frame[ \t]+Time[ \t]*:?[ \t]*)(?P<value>[\d.eE+-]+)", re.IGNORECASE | re.MULTILINE
)


def cut_lines(data: bytes, frames: int, first: int, count: int, fps: float) -> bytes | None:
    """The text of a BVH file with `count` of its frames, from frame `first` on, at a frame rate.

    Parameters
    ----------
    data : bytes
        The file.
    frames : int
        How many frames are read from it.

    Returns
    -------
    bytes or None
        None where the frames are not one a line.
    """
    counted = _FRAMES.search(data)
    time = None if counted is None else _TIME.search(data, counted.end())
    if counted is None or time is None or int(counted["value"]) != frames:
        return None
    end = data.find(b"\n", time.end())
    header = data[: end if end >= 0 else len(data)]
    lines = [line for line in data[len(header) :].splitlines() if line.strip()]
    kept = lines[first : first + count]
    if len(lines) != frames or len({len(line.split()) for line in lines}) != 1:
        return None
    header = _FRAMES.sub(lambda found: found["name"] + b"%d" % count, header)
    header = _TIME.sub(lambda found: found["name"] + b"%.8g" % (1 / fps), header)
    return header.rstrip(b"\r") + b"\n" + b"\n".join(kept) + b"\n"
