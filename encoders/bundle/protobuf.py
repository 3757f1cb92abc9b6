"""The wire format of protobuf, in which ONNX files are written: the fields of a message, read and written."""

from __future__ import annotations

from collections.abc import Iterator

Message = bytes | memoryview
_VARINT, _FIXED64, _BYTES, _FIXED32 = 0, 1, 2, 5


def fields(data: Message) -> Iterator[tuple[int, int | memoryview]]:
    """The fields of a message: their numbers, and their values, where they are of bytes a view of them.

    Raises
    ------
    ValueError
        If it is no message.
    """
    view, at = memoryview(data), 0
    while at < len(view):
        key, at = _varint(view, at)
        kind = key & 7
        if kind == _VARINT:
            value, at = _varint(view, at)
            yield key >> 3, value
            continue
        if kind == _BYTES:
            size, at = _varint(view, at)
        elif kind in (_FIXED64, _FIXED32):
            size = 8 if kind == _FIXED64 else 4
        else:
            raise ValueError("no ONNX file")
        if size > len(view) - at:
            raise ValueError("no ONNX file, or one that is cut off")
        yield key >> 3, view[at : at + size]
        at += size


def varints(data: memoryview) -> Iterator[int]:
    """Numbers that are packed into one field."""
    at = 0
    while at < len(data):
        value, at = _varint(data, at)
        yield value


def message(value: int | memoryview) -> memoryview:
    """A field's value as bytes; ValueError for a number."""
    if isinstance(value, int):
        raise ValueError("no ONNX file")
    return value


def text(value: int | memoryview) -> str:
    """A field's value as text; ValueError for a number."""
    return bytes(message(value)).decode("utf-8", "replace")


def field(number: int, value: int | str | Message) -> bytes:
    """A field, to be joined with others to a message."""
    if isinstance(value, int):
        return _as_varint(number << 3 | _VARINT) + _as_varint(value)
    data = value.encode() if isinstance(value, str) else value
    return b"".join((_as_varint(number << 3 | _BYTES), _as_varint(len(data)), data))


def _varint(data: memoryview, at: int) -> tuple[int, int]:
    """A number of up to ten bytes, seven bits in each, and the place after it."""
    value = 0
    for shift in range(0, 70, 7):
        if at >= len(data):
            break
        byte = data[at]
        at += 1
        value |= (byte & 0x7F) << shift
        if byte < 0x80:
            return value, at
    raise ValueError("no ONNX file, or one that is cut off")


def _as_varint(value: int) -> bytes:
    encoded = bytearray()
    while value > 0x7F:
        encoded.append(value & 0x7F | 0x80)
        value >>= 7
    return bytes([*encoded, value])
