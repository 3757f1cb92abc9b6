"""Records of a binary FBX, versions 6.1 to 7.7."""

from __future__ import annotations

from struct import Struct
from struct import error as StructError
from typing import Any

from indexer.formats.fbx.records import (
    MAX_DEPTH,
    MAX_RECORDS,
    PROPERTIES,
    WANTED,
    DamagedFbx,
    PackedArray,
    Record,
    Room,
    Wanted,
)

MAGIC = b"Kaydara FBX Binary  \x00\x1a\x00"
_WIDE = 7500  # from this version on, offsets have 64 bits

_SCALARS = {
    ord(kind): (Struct(layout).unpack_from, 1 + Struct(layout).size)
    for kind, layout in {"Y": "<h", "C": "<B", "B": "<B", "I": "<i", "F": "<f", "D": "<d", "L": "<q"}.items()
}
_ARRAYS = {ord(kind): kind for kind in "fdlibc"}
_array_header, _length = Struct("<III").unpack_from, Struct("<I").unpack_from
_READ = frozenset(name.encode() for name in PROPERTIES)
_TEXT, _BYTES, _LONG = ord("S"), ord("R"), ord("L")
_link = Struct("<7sBqBq").unpack_from
_LINK_SIZE = Struct("<7sBqBq").size
_LINK_KINDS = {b"S\2\0\0\0" + kind.encode(): kind for kind in ("OO", "OP")}


def parse(data: bytes) -> Record:
    """The wanted records of a file, within one without a name whose value is the version.

    Raises
    ------
    DamagedFbx
        Where lengths and counts do not fit what follows.
    """
    if not data.startswith(MAGIC) or len(data) < len(MAGIC) + 4:
        raise DamagedFbx("its header is not that of a binary FBX of these days")
    (version,) = _length(data, len(MAGIC))
    parser = _Parser(data, version)
    return Record("", [version], parser.records(len(MAGIC) + 4, len(data), WANTED, 0))


class _Parser:
    def __init__(self, data: bytes, version: int) -> None:
        self.data = data
        self.header = Struct("<QQQB" if version >= _WIDE else "<IIIB")
        self.room = Room()
        self.left = MAX_RECORDS
        self.known: dict[tuple[int, bytes], list[Any]] = {}

    def records(self, at: int, end: int, wanted: Wanted | None, depth: int) -> list[Record]:
        """The records that stand between two places."""
        data, header, size = self.data, self.header.unpack_from, self.header.size
        found = []
        while at + size <= end:
            stop, count, length, name_length = header(data, at)
            if stop == 0:  # an empty record closes a list
                break
            begin = at + size + name_length
            if not begin + length <= stop <= end:
                raise DamagedFbx(f"the record at byte {at} ends at {stop}, outside of what it stands in")
            self.left -= 1
            if self.left < 0 or depth > MAX_DEPTH:
                raise DamagedFbx(f"it holds more than {MAX_RECORDS} records, or more than {MAX_DEPTH} in one another")
            name = data[at + size : begin].decode("latin-1")
            is_read = name in wanted if wanted is not None else True
            if is_read and (name != "P" or length < 5 or self.is_wanted(begin)):
                values = self.values(begin, begin + length, count)
                inner = wanted[name] if wanted is not None else None
                has_children = stop - begin - length > size
                children = self.records(begin + length, stop, inner, depth + 1) if has_children else ()
                found.append(Record(name, values, children))
            at = stop
        return found

    def values(self, at: int, end: int, count: int) -> list[Any]:
        """The values that stand between two places; equal ones, of which there are many, are one list."""
        if count >= 3 and end - at >= _LINK_SIZE:
            values = self.link(at, end, count)
            if values is not None:
                return values
        key = count, self.data[at:end]
        found = self.known.get(key)
        if found is None:
            found = self.known[key] = self.new_values(at, end, count)
        return found

    def link(self, at: int, end: int, count: int) -> list[Any] | None:
        """The values of a connection of version 7: its kind and two numbers, and a text where there are four."""
        kind, first, child, second, parent = _link(self.data, at)
        if kind not in _LINK_KINDS or first != _LONG or second != _LONG:
            return None
        values = [_LINK_KINDS[kind], child, parent]
        return values if count == 3 else values + self.values(at + _LINK_SIZE, end, count - 3)

    def new_values(self, at: int, end: int, count: int) -> list[Any]:
        """The values that stand between two places."""
        data = self.data
        values: list[Any] = []
        if count > end - at:
            raise DamagedFbx(f"the record at byte {at} announces {count} values in {end - at} bytes")
        try:
            for _ in range(count):
                kind = data[at]
                if kind == _TEXT:
                    stop = at + 5 + _length(data, at + 1)[0]
                    values.append(decode(data[at + 5 : stop]))
                    at = stop
                elif kind in _SCALARS:
                    unpack, size = _SCALARS[kind]
                    values.append(unpack(data, at + 1)[0])
                    at += size
                elif kind in _ARRAYS:
                    number, packing, size = _array_header(data, at + 1)
                    content = data[at + 13 : at + 13 + size]
                    at += 13 + size
                    values.append(PackedArray(_ARRAYS[kind], number, packing != 0, content, self.room))
                elif kind == _BYTES:
                    at += 5 + _length(data, at + 1)[0]
                    values.append(b"")
                else:
                    raise DamagedFbx(f"the value at byte {at} is of an unknown kind")
        except (IndexError, StructError):
            raise DamagedFbx("the file is cut short") from None
        if at > end:
            raise DamagedFbx(f"values at byte {end} are longer than their record")
        return values

    def is_wanted(self, at: int) -> bool:
        """Whether the property whose values begin at a place is one that is read."""
        data = self.data
        return data[at : at + 1] != b"S" or data[at + 5 : at + 5 + _length(data, at + 1)[0]] in _READ


def decode(text: bytes) -> str:
    """A text as UTF-8, or, where it is none, letter by letter."""
    try:
        return text.decode("utf-8")
    except UnicodeDecodeError:
        return text.decode("latin-1")
