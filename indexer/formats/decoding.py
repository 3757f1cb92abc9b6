"""What files are wrapped in: gzip and UTF-16 become the plain bytes that the readers take."""

from __future__ import annotations

import re
import zlib
from os import PathLike

from encoders.errors import UnreadableMotion

#: Bytes that a compressed file may become: this many, and so many for each of its own.
FREE, PER_BYTE = 64 << 20, 20

_GZIP = b"\x1f\x8b"
_UTF16 = ((b"\xff\xfe", "utf-16-le"), (b"\xfe\xff", "utf-16-be"))
_WIDE = ((re.compile(rb"(?:[\t-~]\0){8}"), "utf-16-le"), (re.compile(rb"(?:\0[\t-~]){8}"), "utf-16-be"))


def decoded(path: str | PathLike[str], data: bytes) -> bytes:
    """Content without its compression by gzip, and text in UTF-8 that is in UTF-16, with or without a mark.

    Raises
    ------
    UnreadableMotion
        If the compressed data is damaged, or becomes too large.
    """
    if data.startswith(_GZIP):
        data = _unzipped(path, data)
    encoding = next((name for mark, name in _UTF16 if data.startswith(mark)), None)
    encoding = encoding or next((name for letters, name in _WIDE if letters.match(data)), None)
    if encoding is not None:
        data = data.decode(encoding, "replace").removeprefix("\ufeff").encode("utf-8", "replace")
    return data


def _unzipped(path: str | PathLike[str], data: bytes) -> bytes:
    limit = FREE + PER_BYTE * len(data)
    unzip = zlib.decompressobj(wbits=31)
    try:
        plain = unzip.decompress(data, limit)
    except zlib.error as error:
        raise UnreadableMotion(path, f"its gzip compression is damaged: {error}") from None
    if unzip.unconsumed_tail:
        raise UnreadableMotion(path, f"uncompressed it is larger than {limit >> 20} MB; cut it into takes")
    if not unzip.eof:
        raise UnreadableMotion(path, "its gzip compression is cut short; copy the file again")
    return plain
