"""Compressed files and UTF-16 are read as what is in them."""

from __future__ import annotations

import gzip
from pathlib import Path

import numpy as np
import pytest

from encoders.errors import UnreadableMotion
from indexer.formats.decoding import FREE
from indexer.ingest.file_parts import read_take
from tests.indexer.formats.test_amc import AMC, ASF
from tests.indexer.formats.test_bvh import ARM


@pytest.mark.parametrize("encoding", ["utf-16", "utf-16-le", "utf-16-be", "utf-8-sig"])
@pytest.mark.parametrize("wrap", [bytes, gzip.compress])
def test_texts_are_read_in_any_encoding(tmp_path: Path, encoding: str, wrap) -> None:  # type: ignore[no-untyped-def]
    for name, text in (("a.bvh", ARM), ("b.amc", AMC), ("b.asf", ASF)):
        (tmp_path / "plain").mkdir(exist_ok=True)
        (tmp_path / "plain" / name).write_text(text)
        (tmp_path / name).write_bytes(wrap(text.encode(encoding)))
    for name in ("a.bvh", "b.amc"):
        expected = read_take(tmp_path / "plain" / name).positions
        np.testing.assert_array_equal(read_take(tmp_path / name).positions, expected)


def test_damaged_compression_is_named(tmp_path: Path) -> None:
    data = gzip.compress(ARM.encode())
    for content, reason in ((data[:-20], "cut short"), (data[:20] + b"xxxx" + data[24:], "damaged")):
        (tmp_path / "a.bvh").write_bytes(content)
        with pytest.raises(UnreadableMotion, match=reason):
            read_take(tmp_path / "a.bvh")


def test_a_compressed_bomb_is_refused(tmp_path: Path) -> None:
    (tmp_path / "a.bvh").write_bytes(gzip.compress(b"0 " * FREE))
    with pytest.raises(UnreadableMotion, match="larger than"):
        read_take(tmp_path / "a.bvh")
