"""Side files: captions that people wrote, in files beside the motions.

`NAME.txt` beside `NAME.bvh` holds a caption a line; `captions.csv`, `.tsv` or `.jsonl` in any folder has the
columns path, text, start, end (seconds), fps and up, of which only the path and one of text, fps and up are needed.
"""

from __future__ import annotations

import csv
import io
import json
import math
import posixpath
import re
from codecs import BOM_UTF16_BE, BOM_UTF16_LE
from collections.abc import Callable, Iterable, Iterator, Mapping
from itertools import chain
from pathlib import Path
from typing import Any, TextIO

from encoders.arguments import shown
from indexer.formats.opening import open_file
from indexer.store.captions import CaptionRow
from indexer.take import UP_AXES

MAX_BYTES = 32 << 20  # of a side file, half a million captions; a larger one is not opened
MAX_TEXT = 2000
MAX_LINES = 1000  # of a .txt file: a longer one is no list of captions
COLUMNS = ("path", "text", "start", "end", "fps", "up")

#: What may stand between two cells, the usual one first.
_DELIMITERS = (",", "\t", ";", "|")
_DECIMAL_COMMA = re.compile(r"^\s*(-?\d+),(\d+)\s*$")

Warn = Callable[[str], None]


def read_table(file: Path, folder: str, warn: Warn) -> list[CaptionRow]:
    """The rows of a captions table; `folder` is where it lies, relative to the root, empty for the root itself.

    A row that makes no sense is left out, with a warning that names its line.
    """
    rows = []
    for number, record in _records(file, warn):
        try:
            rows.append(_row(record, folder))
        except ValueError as error:
            warn(f"{file}, line {number}: {error}; the row is left out")
    return rows


def read_lines(file: Path, warn: Warn) -> list[tuple[str, float | None, float | None]]:
    """The captions (text, start, end) of a `.txt` file, one a line: plain, or HumanML3D's `text#tokens#start#end`."""
    captions = []
    with _text_of(file) as lines:
        for number, line in enumerate(lines, start=1):
            if number > MAX_LINES:
                warn(f"{file}: only the first {MAX_LINES} lines are taken as captions")
                break
            try:
                text, start, end = _timed(line)
                if text.strip():
                    captions.append((_text(text), start, end))
            except ValueError as error:
                warn(f"{file}, line {number}: {error}; the line is left out")
    return captions


def _text_of(file: Path, newline: str | None = None) -> TextIO:
    """Open a file as UTF-8, or UTF-16 by its byte order mark; what is neither becomes surrogates, refused by line."""
    with open_file(file) as opened:
        is_utf16 = opened.read(2) in (BOM_UTF16_LE, BOM_UTF16_BE)
    encoding, errors = ("utf-16", "replace") if is_utf16 else ("utf-8-sig", "surrogateescape")
    return io.TextIOWrapper(open_file(file), encoding=encoding, errors=errors, newline=newline)


def _records(file: Path, warn: Warn) -> Iterator[tuple[int, Mapping[str, Any]]]:
    """The records of a table with the line each ends on."""
    with _text_of(file, newline="") as lines:
        if file.suffix.lower() == ".jsonl":
            yield from _json_records(file, lines, warn)
            return
        first = lines.readline()
        delimiter = max(_DELIMITERS, key=first.count)
        reader = csv.reader(chain([first], lines), delimiter=delimiter)
        try:
            header = [name.strip().lower() for name in next(reader, [])]
            if "path" not in header or not {"text", "fps", "up"} & set(header):
                warn(
                    f"{file}: the first line must name the columns, path and text among them ({', '.join(COLUMNS)}); "
                    f"it says {shown(' '.join(first.split()))}"
                )
                return
            for cells in reader:
                if delimiter == ";":  # as programs write it where a comma stands in numbers
                    cells = [_DECIMAL_COMMA.sub(r"\1.\2", cell) for cell in cells]
                if any(cell.strip() for cell in cells):
                    yield reader.line_num, dict(zip(header, cells, strict=False))
        except csv.Error as error:
            warn(f"{file}, line {reader.line_num}: {error}; the rest is left out")


def _json_records(file: Path, lines: Iterable[str], warn: Warn) -> Iterator[tuple[int, Mapping[str, Any]]]:
    for number, line in enumerate(lines, start=1):
        if not line.strip():
            continue
        try:
            record = json.loads(line)
        except (ValueError, RecursionError) as error:
            warn(f"{file}, line {number}: no JSON ({error}); the row is left out")
            continue
        if isinstance(record, dict):
            yield number, record
        else:
            warn(f"{file}, line {number}: {{...}} with path and text is expected; the row is left out")


def _row(record: Mapping[str, Any], folder: str) -> CaptionRow:
    text = record.get("text")
    text = None if text is None or not str(text).strip() else _text(str(text))
    fps, up = _number(record, "fps"), _axis(record.get("up"))
    if text is None and fps is None and up is None:
        raise ValueError("it has no text")
    if fps is not None and not 0 < fps < 1e5:
        raise ValueError(f"fps={fps:g} is no frame rate")
    start, end = _number(record, "start"), _number(record, "end")
    return CaptionRow(_path(record.get("path"), folder), text, *_span(start, end), fps, up)


def _path(value: Any, folder: str) -> str:
    given = str(value or "").strip().replace("\\", "/")
    if not given:
        raise ValueError("it names no path")
    path = posixpath.normpath(posixpath.join(folder, given))
    if posixpath.isabs(given) or given[1:2] == ":" or path.startswith("../") or path in ("..", "."):
        raise ValueError(f"path {given!r} must be relative to the table's folder and stay inside the indexed folder")
    return _utf8(path)


def _text(value: str) -> str:
    text = " ".join(value.split())
    if len(text) > MAX_TEXT:
        raise ValueError(f"{len(text)} characters are more than {MAX_TEXT}")
    return _utf8(text)


def _utf8(value: str) -> str:
    try:
        value.encode()
    except UnicodeEncodeError:
        raise ValueError("it is not UTF-8; save it as UTF-8") from None
    return value


def _number(record: Mapping[str, Any], name: str) -> float | None:
    value = record.get(name)
    if value is None or (isinstance(value, str) and not value.strip()):
        return None
    try:
        number = float(value)
    except (TypeError, ValueError, OverflowError):  # an integer of JSON may have hundreds of digits
        number = math.nan
    if isinstance(value, bool) or not math.isfinite(number):
        raise ValueError(f"{name} {shown(value)} is no number")
    return number


def _axis(value: Any) -> str | None:
    axis = "" if value is None else str(value).strip().lower()
    if axis and axis not in UP_AXES:
        raise ValueError(f"up={shown(value)} is no axis; it must be one of {', '.join(UP_AXES)}")
    return axis or None


def _span(start: float | None, end: float | None) -> tuple[float | None, float | None]:
    if start is None and end is None:
        return None, None
    if start is None or end is None or not 0 <= start < end:
        raise ValueError(f"start {start} and end {end} must both be given, in seconds, the end after the start")
    return start, end


def _timed(line: str) -> tuple[str, float | None, float | None]:
    """HumanML3D's fields where they are there; its 0.0#0.0 means the whole clip."""
    parts = line.rsplit("#", 3)
    if len(parts) < 4:
        return line, None, None
    try:
        start, end = float(parts[2]), float(parts[3])
    except ValueError:
        return line, None, None
    whole = not (math.isfinite(start) and math.isfinite(end)) or start == end == 0
    return (parts[0], None, None) if whole else (parts[0], *_span(start, end))
