"""The container of a glTF 2.0 asset: its JSON document, alone (.gltf) or in a GLB, and the buffers it names."""

from __future__ import annotations

import base64
import binascii
import json
import re
import struct
from os import PathLike
from pathlib import Path, PureWindowsPath
from typing import Any, cast
from urllib.parse import unquote_to_bytes

from encoders.errors import UnreadableMotion
from indexer.formats.opening import read_bytes

#: A document may hold so many values, which bounds the memory that they take.
MAX_VALUES = 4_000_000
#: So many numbers are read from the buffers of a file, however often accessors share them: a gigabyte.
MAX_NUMBERS = 1 << 27
_MAX_DIGITS = 20
_MAGIC, _JSON, _BIN = b"glTF", 0x4E4F534A, 0x004E4942
_DATA_URI = re.compile(r"data:[^,;]{0,100}(?:;[^,;]{0,100}){0,4}?(?P<base64>;base64)?,")


class Document:
    """A glTF document and its buffers, each read when it is first asked for.

    Every part of the JSON is got through `rows`, `row` or the functions of this module, which check its kind.
    """

    def __init__(self, path: str | PathLike[str], data: bytes) -> None:
        """Read the JSON of a file; see `read_document`."""
        self.path = path
        text, self._chunk = _chunks(path, data) if data[:4] == _MAGIC else (data, None)
        self.json = _parse(path, text)
        self._lists: set[int] = set()  # identities of lists in the JSON that hold only objects
        version = str(self.row(self.json, "asset").get("version", ""))
        if not version.startswith("2."):
            raise self.error(f"glTF {version[:10] or 'of no version'} is not read, only 2.0; export it again as 2.0")
        self._buffers: dict[int, bytes] = {}
        self._numbers = 0

    def error(self, reason: str) -> UnreadableMotion:
        """What is wrong with this file, to be raised."""
        return UnreadableMotion(self.path, reason)

    def damaged(self, what: str) -> UnreadableMotion:
        """That the document breaks the specification, to be raised."""
        return self.error(f"the glTF is damaged: {what}")

    def row(self, owner: dict[str, Any], key: str) -> dict[str, Any]:
        """The object under a key; empty where there is none."""
        value = owner.get(key, {})
        if not isinstance(value, dict):
            raise self.damaged(f"{key!r} is no object")
        return value

    def rows(self, owner: dict[str, Any], key: str) -> list[dict[str, Any]]:
        """The list of objects under a key; empty where there is none."""
        if key not in owner:
            return []
        value = owner[key]
        if id(value) not in self._lists:  # a list of accessors is asked for once by each of them
            if not isinstance(value, list) or not all(isinstance(item, dict) for item in value):
                raise self.damaged(f"{key!r} is no list of objects")
            self._lists.add(id(value))
        return cast("list[dict[str, Any]]", value)

    def whole(self, owner: dict[str, Any], key: str, default: int | None = None) -> int:
        """The number under a key, not negative and no fraction."""
        value = owner.get(key, default)
        if isinstance(value, float) and value.is_integer():
            value = int(value)
        if not isinstance(value, int) or isinstance(value, bool) or value < 0:
            raise self.damaged(f"{key!r} is no number from 0")
        return value

    def number(self, owner: dict[str, Any], key: str, of: int) -> int:
        """The number under a key, of one among `of` things."""
        value = self.whole(owner, key)
        if value >= of:
            raise self.damaged(f"{key!r} is {value}, of {of}")
        return value

    def spend(self, numbers: int) -> None:
        """Account for numbers about to be read; a few bytes of JSON can ask for any amount.

        Raises
        ------
        UnreadableMotion
            If they are more than `MAX_NUMBERS`.
        """
        self._numbers += numbers
        if self._numbers > MAX_NUMBERS:
            raise self.error("its animations hold too many keys; cut the file into parts")

    def buffer(self, number: int) -> bytes:
        """The bytes of a buffer.

        Raises
        ------
        UnreadableMotion
            If it is missing, shorter than announced, or lies outside the file's folder.
        """
        if number not in self._buffers:
            buffers = self.rows(self.json, "buffers")
            row = buffers[self.number({"buffer": number}, "buffer", len(buffers))]
            data = self._load(row, number)
            length = self.whole(row, "byteLength")
            if len(data) < length:
                raise self.error(f"buffer {number} is cut short: {len(data)} of {length} bytes")
            self._buffers[number] = data
        return self._buffers[number]

    def _load(self, row: dict[str, Any], number: int) -> bytes:
        uri = row.get("uri")
        if uri is None:
            if self._chunk is None or number:
                raise self.error(f"buffer {number} is not in the file")
            return self._chunk
        if not isinstance(uri, str):
            raise self.damaged("'uri' is no text")
        inline = _DATA_URI.match(uri)
        if inline:
            return self._decoded(uri[inline.end() :], bool(inline["base64"]))
        try:
            return read_bytes(self._beside(uri), as_it_is=True)
        except UnreadableMotion as error:
            if error.__cause__ is None:
                raise
            raise self.error(f"its buffer {uri[:80]!r} cannot be read: {error.reason}") from error.__cause__

    def _decoded(self, text: str, is_base64: bool) -> bytes:
        try:
            return base64.b64decode(text) if is_base64 else unquote_to_bytes(text)
        except (binascii.Error, ValueError) as error:
            raise self.damaged(f"a buffer in it cannot be decoded ({error})") from None

    def _beside(self, uri: str) -> Path:
        """The file of a relative reference, which must not lead out of the folder."""
        name = unquote_to_bytes(uri).decode("utf-8", "replace")
        place = PureWindowsPath(name)  # knows both kinds of slashes, drives and shares
        if place.drive or place.root or ".." in place.parts or ":" in name or "\0" in name or not place.parts:
            raise self.error(f"its buffer {uri[:80]!r} is no file in the same folder; save it as .glb, which holds all")
        return Path(self.path).parent.joinpath(*place.parts)


def _chunks(path: str | PathLike[str], data: bytes) -> tuple[bytes, bytes | None]:
    """The JSON and the binary chunk of a GLB."""
    if len(data) < 20:
        raise UnreadableMotion(path, "the GLB is cut short after its first bytes")
    version, length = struct.unpack_from("<II", data, 4)
    if version != 2:
        raise UnreadableMotion(path, f"glTF {version} is not read, only 2.0; export it again as 2.0")
    if length > len(data):
        raise UnreadableMotion(path, f"the GLB is cut short: {len(data)} of {length} bytes")
    text, chunk, at = None, None, 12
    while at + 8 <= length:
        size, kind = struct.unpack_from("<II", data, at)
        if at + 8 + size > length:
            raise UnreadableMotion(path, "the glTF is damaged: a chunk is longer than the file")
        if kind == _JSON and text is None:
            text = data[at + 8 : at + 8 + size]
        elif kind == _BIN and chunk is None:
            chunk = data[at + 8 : at + 8 + size]
        at += 8 + size
    if text is None:
        raise UnreadableMotion(path, "the glTF is damaged: it has no JSON")
    return text, chunk


def _parse(path: str | PathLike[str], text: bytes) -> dict[str, Any]:
    if sum(text.count(mark) for mark in (b",", b"{", b"[")) > MAX_VALUES:
        raise UnreadableMotion(path, f"the glTF holds more than {MAX_VALUES} values; cut the scene into parts")
    try:
        document = json.loads(text.removeprefix(b"\xef\xbb\xbf").decode("utf-8"), parse_int=_integer)
    except RecursionError:
        raise UnreadableMotion(path, "the glTF is damaged: its JSON is nested too deeply") from None
    except ValueError as error:
        raise UnreadableMotion(path, f"the glTF is damaged: {str(error)[:200]}") from None
    if not isinstance(document, dict):
        raise UnreadableMotion(path, "the glTF is damaged: its JSON is no object")
    return document


def _integer(digits: str) -> int:
    """An integer; the time that `int` takes grows with the square of the digits."""
    if len(digits) > _MAX_DIGITS:
        raise ValueError(f"a number of {len(digits)} digits")
    return int(digits)
