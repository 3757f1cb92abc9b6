"""Records of an ASCII FBX."""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import Any

import numpy as np

from indexer.formats.fbx.binary_records import decode
from indexer.formats.fbx.records import MAX_DEPTH, MAX_RECORDS, WANTED, DamagedFbx, Record, Wanted
from indexer.formats.numbers import parse_numbers

_SPACE = re.compile(rb"(?:\s|;[^\n]*)*")
_NAME = re.compile(rb"([A-Za-z_][\w|.-]*)[ \t]*:[ \t]*(?:,\s*)?")
_VALUE = re.compile(rb'"(?P<text>[^"]*)"|\*(?P<count>\d+)|(?P<words>[^\s,:;{}"]+(?:\s*,\s*[^\s,:;{}"]+)*)')
_COMMA = re.compile(rb"\s*,\s*")
_BRACE = re.compile(rb'"[^"]*"|;[^\n]*|[{}]')
_WHOLE = re.compile(rb"[-+]?\d{1,19}")
_ARRAY = re.compile(rb"\s*\{\s*a\s*:")


def parse(data: bytes) -> Record:
    """The wanted records of a file, within one without a name.

    Raises
    ------
    DamagedFbx
        Where the text is not laid out as such a file is.
    """
    parser = _Parser(data)
    return Record("", [], parser.records(WANTED, 0))


class _Parser:
    def __init__(self, data: bytes) -> None:
        self.data = data
        self.at = 0
        self.left = MAX_RECORDS

    def records(self, wanted: Wanted | None, depth: int) -> list[Record]:
        """The records from here to the brace that closes what they stand in, or to the end of the file."""
        found: list[Record] = []
        while True:
            self.skip(_SPACE)
            if self.at >= len(self.data):
                if depth:
                    raise DamagedFbx("closing braces are missing: the file is cut short")
                return found
            if self.data[self.at] == ord("}"):
                self.at += 1
                return found
            name = _NAME.match(self.data, self.at)
            if name is None:
                line = self.data.count(b"\n", 0, self.at) + 1
                raise DamagedFbx(f"line {line} holds no name where one is expected")
            self.left -= 1
            if self.left < 0 or depth > MAX_DEPTH:
                raise DamagedFbx(f"it holds more than {MAX_RECORDS} records, or more than {MAX_DEPTH} in one another")
            self.at = name.end()
            record = self.record(name[1].decode("latin-1"), wanted, depth)
            if record is not None:
                found.append(record)

    def record(self, name: str, wanted: Wanted | None, depth: int) -> Record | None:
        """The record whose values begin here; None where it is not wanted."""
        values = self.values()
        self.skip(_SPACE)
        has_children = self.data[self.at : self.at + 1] == b"{"
        if wanted is not None and name not in wanted:
            if has_children:
                self.pass_over()
            return None
        children: Sequence[Record] = ()
        if has_children:
            self.at += 1
            children = self.records(wanted[name] if wanted is not None else None, depth + 1)
        return Record(name, values, children)

    def values(self) -> list[Any]:
        """The values that begin here, separated by commas."""
        values: list[Any] = []
        while True:
            value = _VALUE.match(self.data, self.at)
            if value is None:
                return values
            self.at = value.end()
            if value["count"] is not None:
                return [self.array(int(value["count"]))]
            if value["text"] is not None:
                values.append(decode(value["text"]).replace("&quot;", '"'))
            else:
                values += [_word(word) for word in _COMMA.split(value["words"])]
            comma = _COMMA.match(self.data, self.at)
            if comma is None:
                return values
            self.at = comma.end()

    def array(self, count: int) -> np.ndarray[Any, Any]:
        """The numbers of `{ a: 1,2,3 }`, which begins here."""
        start = _ARRAY.match(self.data, self.at)
        end = self.data.find(b"}", self.at)
        if start is None or end < 0:
            raise DamagedFbx("an array is not closed: the file is cut short")
        self.at = end + 1
        words = self.data[start.end() : end]
        try:
            numbers = parse_numbers(words) if b"." in words or b"e" in words else np.array(words.split(b","), np.int64)
        except (ValueError, OverflowError):
            numbers = np.array([_float(word) for word in words.split(b",")])
        if len(numbers) != count:
            raise DamagedFbx(f"an array of {count} numbers holds {len(numbers)}")
        return numbers

    def pass_over(self) -> None:
        """Past the closing brace that belongs to the opening one here."""
        depth = 0
        for brace in _BRACE.finditer(self.data, self.at):
            depth += {b"{": 1, b"}": -1}.get(brace[0], 0)
            if depth == 0 and brace[0] == b"}":
                self.at = brace.end()
                return
        raise DamagedFbx("closing braces are missing: the file is cut short")

    def skip(self, pattern: re.Pattern[bytes]) -> None:
        found = pattern.match(self.data, self.at)
        if found is not None:
            self.at = found.end()


def _word(word: bytes) -> Any:
    """A whole number, a number, or a text."""
    if _WHOLE.fullmatch(word):
        return int(word)
    try:
        return float(word)
    except ValueError:
        return decode(word)


def _float(word: bytes) -> float:
    """A number; not a number where it is none, as in arrays of packed bits."""
    try:
        return float(word)
    except ValueError:
        return float("nan")
