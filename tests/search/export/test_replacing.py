"""A file is replaced whole or not at all, also where the disk is full."""

from __future__ import annotations

import errno
import io
import os
from collections.abc import Callable
from pathlib import Path

import pytest

from encoders.errors import MotionSeekError
from search.drawing.film import write_picture
from search.export.cut import WRITERS, write_cut
from search.export.replacing import replacing, write_text
from search.source import MotionSource
from tests.search.conftest import made_motion


class FullDisk(io.RawIOBase):
    """A file that takes some bytes, then no more."""

    def __init__(self, room: int) -> None:
        self.room = room

    def writable(self) -> bool:
        return True

    def write(self, data) -> int:  # type: ignore[override]
        self.room -= len(data)
        if self.room < 0:
            raise OSError(errno.ENOSPC, "No space left on device")
        return len(data)


@pytest.fixture
def full_disk(monkeypatch: pytest.MonkeyPatch) -> None:
    real = os.fdopen

    def opened(handle: int, mode: str) -> io.BufferedIOBase:
        real(handle, mode).close()
        return io.BufferedWriter(FullDisk(300), 64)  # type: ignore[type-var]

    monkeypatch.setattr("search.export.replacing.os.fdopen", opened)


@pytest.mark.parametrize("ending", [*WRITERS, ".png", ".txt"])
def test_a_full_disk_leaves_what_was_there(tmp_path: Path, full_disk: None, ending: str) -> None:
    out = tmp_path / f"x{ending}"
    out.write_bytes(b"as it was")
    motion = made_motion(3, 1)
    write: dict[str, Callable[[], object]] = {
        ".png": lambda: write_picture(motion, out, size=64),
        ".txt": lambda: write_text(out, "long " * 100),
    }
    write |= dict.fromkeys(WRITERS, lambda: write_cut(MotionSource.of_motion(motion), out))
    with pytest.raises(MotionSeekError, match=r"x\..*cannot be written \(No space left on device\).*free some space"):
        write[ending]()
    assert out.read_bytes() == b"as it was"
    assert [path.name for path in tmp_path.iterdir()] == [out.name]


def test_a_file_that_cannot_be_renamed_leaves_what_was_there(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def refused(*_: object) -> None:
        raise OSError(errno.EACCES, "Permission denied")

    (tmp_path / "x").write_text("as it was")
    monkeypatch.setattr("search.export.replacing.os.replace", refused)
    with pytest.raises(MotionSeekError, match=r"x: cannot be written \(Permission denied\)"):
        write_text(tmp_path / "x", "new")
    assert {path.name: path.read_text() for path in tmp_path.iterdir()} == {"x": "as it was"}


def test_an_interrupted_file_is_not_there(tmp_path: Path) -> None:
    def interrupted() -> None:
        with replacing(tmp_path / "x") as file:
            file.write(b"half")
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        interrupted()
    assert list(tmp_path.iterdir()) == []


def test_a_link_stays_one(tmp_path: Path) -> None:
    (tmp_path / "there").mkdir()
    (tmp_path / "there" / "x").write_text("old")
    (tmp_path / "link").symlink_to(tmp_path / "there" / "x")
    write_text(tmp_path / "link", "new")
    assert (tmp_path / "link").is_symlink()
    assert (tmp_path / "there" / "x").read_text() == "new"
