"""The text of an AMC file: a header, then frames, each a number and lines of a bone's name and its values."""

from __future__ import annotations

import re
from os import PathLike
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from encoders.errors import UnreadableMotion
from indexer.formats.mending import is_hopeless
from indexer.formats.numbers import Words, as_number, blocks

#: Bytes in which the header ends, and in which the first frame does.
MAX_HEADER, MAX_FRAME = 65_536, 262_144

_FRAME = re.compile(rb"^[ \t]*\d+[ \t]*\r?$", re.MULTILINE)
_FIRST = re.compile(rb"^[ \t]*\d+\s+[^\s:#\d+.,-]", re.MULTILINE)
_RATE = re.compile(rb"^[ \t]*:[ \t]*samples[-_ ]per[-_ ]second[ \t:=]*\s*([-+.,\deE]+)", re.MULTILINE | re.IGNORECASE)
_UNIT = re.compile(rb"^[ \t]*:[ \t]*(degrees|radians)\b", re.MULTILINE | re.IGNORECASE)


class AmcFrames(NamedTuple):
    """Values (n, T) by bone, NaN where a frame is damaged; what the header states or None; what was left out."""

    values: dict[str, NDArray[np.float64]]
    is_radians: bool | None
    fps: float | None
    warnings: tuple[str, ...]


def read_frames(path: str | PathLike[str], data: bytes) -> AmcFrames:
    """The header and the frames of a file.

    Raises
    ------
    UnreadableMotion
        Where no frame is whole, or many are damaged.
    """
    first = _FIRST.search(data[:MAX_HEADER])
    header, body = (data[: first.start()], data[first.start() :]) if first else (data[:MAX_HEADER], b"")
    if not body:
        lines = [line for line in header.splitlines() if line.strip() and not line.lstrip().startswith((b"#", b":"))]
        if not lines:
            raise UnreadableMotion(path, "the file holds no frames")
        found = lines[0].split()[0][:40].decode("latin-1")
        raise UnreadableMotion(path, f"a frame, its number and then a bone's name, is expected where {found!r} stands")
    unit, rate = _UNIT.search(header), _RATE.search(header)
    fps = as_number(rate[1].replace(b",", b".")) if rate else None
    if b"," in body:
        body = body.replace(b",", b".")
    layout = _layout(path, body[:MAX_FRAME].split())
    try:
        table, cut = _table(layout, body), ""
        if table is None:
            table, cut = _repaired(path, layout, body)
    except ValueError as error:
        raise UnreadableMotion(path, f"the motion is not all numbers: {error}") from None
    _check(path, table)
    ends = np.cumsum([count for _, count in layout]) + 1
    values = {name: table[:, end - count : end].T for (name, count), end in zip(layout, ends, strict=True)}
    return AmcFrames(values, None if unit is None else unit[1].lower() == b"radians", fps, (cut,) if cut else ())


def _layout(path: str | PathLike[str], words: list[bytes]) -> list[tuple[str, int]]:
    """Bone names and counts of values in the first frame."""
    layout: list[tuple[str, int]] = []
    for i, word in enumerate(words[1:], start=1):
        if not _is_value(word):
            layout.append((word.decode("latin-1"), 0))
        elif i + 1 < len(words) and not _is_value(words[i + 1]) and words[i + 1].decode("latin-1") == layout[0][0]:
            break  # this number is the next frame's
        else:
            layout[-1] = (layout[-1][0], layout[-1][1] + 1)
    if len({name for name, _ in layout}) < len(layout):
        raise UnreadableMotion(path, "the first frame names a bone twice, or is cut short")
    return layout


def _is_value(word: bytes) -> bool:
    return not np.isnan(as_number(word)) or word.lower().strip(b"+-").startswith((b"nan", b"1.#"))


def _table(layout: list[tuple[str, int]], body: bytes) -> NDArray[np.float64] | None:
    """Frame number and values of each frame, (T, 1 + n); None where a frame is not laid out as the first one."""
    names = np.concatenate([[b""], *([name.encode("latin-1")] + [b""] * count for name, count in layout)])
    is_name = names != b""
    width = len(names)
    expected = Words.of(b" ".join(names[is_name]))
    keys = np.zeros((width, 3), np.uint64)
    keys[is_name] = _keys(expected)
    numbers: list[NDArray[np.float64]] = []
    count = 0
    for words in blocks(body):
        places = (np.arange(len(words.starts)) + count) % width
        here = is_name[places]
        if (_keys(words.where(here)) != keys[places[here]]).any():
            return None
        numbers.append(words.where(~here).numbers())
        count += len(places)
    if count % width:
        return None
    return np.concatenate(numbers).reshape(-1, width - len(layout))


def _keys(words: Words) -> NDArray[np.uint64]:
    """Size, first and last eight characters of words, (N, 3)."""
    sizes = words.ends - words.starts
    firsts = words.eights(words.starts + 8, np.full_like(sizes, 8))
    shift = (np.maximum(8 - sizes, 0) << 3).view(np.uint64)
    return np.stack([sizes.view(np.uint64), firsts << shift, words.eights(words.ends, sizes)], axis=1)


def _repaired(path: str | PathLike[str], layout: list[tuple[str, int]], body: bytes) -> tuple[NDArray[np.float64], str]:
    """The whole frames of a damaged file, NaN in place of broken ones; what was left out at its end."""
    names = [name.encode("latin-1") for name, _ in layout]
    width = 1 + sum(1 + count for _, count in layout)
    places = 1 + np.cumsum([0, *(1 + count for _, count in layout[:-1])])
    starts = [match.start() for match in _FRAME.finditer(body)]
    pieces = [body[a:b] for a, b in zip(starts, [*starts[1:], len(body)], strict=True)]
    is_whole = []
    for piece in pieces:
        words = piece.split()
        is_whole.append(len(words) == width and [words[place] for place in places] == names)
    cut = ""
    if not is_whole[-1]:
        cut = "the last frame is cut short and left out"
        del is_whole[-1]
    if not any(is_whole):
        raise UnreadableMotion(path, "the file holds no whole frame")
    whole = _table(layout, b"\n".join(piece for piece, fits in zip(pieces, is_whole, strict=False) if fits))
    if whole is None:
        raise UnreadableMotion(path, "its frames hold characters that are neither words nor numbers")
    table = np.full((len(is_whole), width - len(layout)), np.nan)
    table[is_whole] = whole
    return table, cut


def _check(path: str | PathLike[str], table: NDArray[np.float64]) -> None:
    """Refuse a file most of which is damaged."""
    broken = ~np.asarray(np.isfinite(table).all(axis=1))
    if is_hopeless(broken):
        raise UnreadableMotion(
            path,
            f"{broken.sum()} of {len(table)} frames are damaged, the first of them frame {int(broken.argmax()) + 1}",
        )
    table[broken] = np.nan
