"""Records of a binary FBX, versions 6.1 to 7.7."""

from __future__ import annotations

from struct import Struct
from typing import Any

from indexer.formats.fbx.records import (
    MAX_DEPTH,
    MAX_RECORDS,
    WANTED,
    DamagedFbx,
    PackedArray,
    Record,
    Unpacker,
    Wanted,
)

MAGIC = b"Kaydara FBX Binary  \x00\x1a\x00"
_WIDE = 7500  # from this version on, offsets have 64 bits

_SCALARS = {
    ord(kind): (Struct(layout).unpack_from, Struct(layout).size)
    for kind, layout in {"Y": "<h", "C": "<B", "B": "<B", "I": "<i", "F": "<f", "D": "<d", "L": "<q"}.items()
}
_ARRAYS = {ord(kind): kind for kind in "fdlibc"}
_ARRAY_HEADER = Struct("<III")
_LENGTH = Struct("<I")
_TEXT, _BYTES = ord("S"), ord("R")


def parse(data: bytes) -> Record:
    """The wanted records of a file, within one without a name whose value is the version.

    Raises
    ------
    DamagedFbx
        Where lengths and counts do not fit what follows.
    """
    if not data.startswith(MAGIC) or len(data) < len(MAGIC) + 4:
        raise DamagedFbx("its header is not that of a binary FBX of these days")
    (version,) = _LENGTH.unpack_from(data, len(MAGIC))
    parser = _Parser(data, version)
    return Record("", [version], parser.records(len(MAGIC) + 4, len(data), WANTED, 0))


class _Parser:
    def __init__(self, data: bytes, version: int) -> None:
        self.data = data
        self.header = Struct("<QQQB" if version >= _WIDE else "<IIIB")
        self.unpacker = Unpacker()
        self.left = MAX_RECORDS

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
            if wanted is None or name in wanted:
                values = self.values(begin, begin + length, count)
                inner = wanted[name] if wanted is not None else None
                has_children = stop - begin - length > size
                children = self.records(begin + length, stop, inner, depth + 1) if has_children else None
                found.append(Record(name, values, children))
            at = stop
        return found

    def values(self, at: int, end: int, count: int) -> list[Any]:
        """The values that stand between two places."""
        if count > end - at:
            raise DamagedFbx(f"the record at byte {at} announces {count} values in {end - at} bytes")
        data = self.data
        values: list[Any] = []
        for _ in range(count):
            if at >= end:
                raise DamagedFbx(f"values are missing at byte {at}")
            kind = data[at]
            at += 1
            scalar = _SCALARS.get(kind)
            if scalar is not None:
                at += scalar[1]
                if at > end:
                    raise DamagedFbx(f"a value at byte {at} is cut short")
                values.append(scalar[0](data, at - scalar[1])[0])
                continue
            header = _ARRAY_HEADER if kind in _ARRAYS else _LENGTH
            if not (kind in _ARRAYS or kind in (_TEXT, _BYTES)) or at + header.size > end:
                raise DamagedFbx(f"a value at byte {at - 1} is of an unknown kind, or cut short")
            fields = header.unpack_from(data, at)
            at += header.size
            content = data[at : at + fields[-1]]
            if at + fields[-1] > end:
                raise DamagedFbx(f"a value at byte {at} is longer than its record")
            at += fields[-1]
            if kind == _TEXT:
                values.append(decode(content))
            elif kind == _BYTES:
                values.append(content)
            else:
                values.append(PackedArray(_ARRAYS[kind], fields[0], fields[1] != 0, content, self.unpacker))
        return values


def decode(text: bytes) -> str:
    """A text as UTF-8, or, where it is none, letter by letter."""
    try:
        return text.decode("utf-8")
    except UnicodeDecodeError:
        return text.decode("latin-1")
