"""ZIP archives: read in place, and what they state is not trusted."""

import contextlib
import io
import os
import stat
import struct
import zipfile
from unicodedata import normalize

import numpy as np
import pytest

from encoders.errors import UnreadableMotion
from indexer.formats import zip_archive
from indexer.formats.opening import beside, is_file, read_bytes, size, state
from indexer.formats.zip_archive import open_member, read_archive, refusal, split
from indexer.ingest.file_parts import read_take
from tests.indexer.formats.test_amc import AMC, ASF
from tests.indexer.performances import bvh, performance

WALK = bvh(performance(frames=4)).encode()


def pack(path, members, method=zipfile.ZIP_DEFLATED):
    path.parent.mkdir(parents=True, exist_ok=True)
    with zipfile.ZipFile(path, "w", method) as archive:
        for name, content in members.items():
            archive.writestr(name, content)
    return path


def reason(path):
    with pytest.raises(UnreadableMotion) as error:
        read_bytes(path)
    return error.value.reason


@pytest.mark.parametrize("method", [zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED, zipfile.ZIP_BZIP2, zipfile.ZIP_LZMA])
def test_a_member_is_read_like_a_file(tmp_path, method):
    pack(tmp_path / "Pack.ZIP", {"day 1/walk.bvh": WALK}, method)
    member = tmp_path / "Pack.ZIP" / "day 1" / "walk.bvh"
    assert read_bytes(member) == WALK
    assert (is_file(member), size(member)) == (True, len(WALK))
    assert len(read_take(member).positions) == 4
    assert not is_file(tmp_path / "Pack.ZIP" / "other.bvh")


def test_a_motion_finds_its_skeleton_inside(tmp_path):
    pack(tmp_path / "cmu.zip", {"01/01.asf": ASF, "01/01_02.amc": AMC, "02/02.asf": "damaged"})
    inside = tmp_path / "cmu.zip" / "01"
    assert beside(inside / "01_02.amc") == [inside / "01.asf", inside / "01_02.amc"]
    assert len(read_take(inside / "01_02.amc").names) == 4


def test_an_archive_after_other_bytes_is_read(tmp_path):
    packed = pack(tmp_path / "a.zip", {"walk.bvh": WALK}).read_bytes()
    (tmp_path / "a.zip").write_bytes(b"#!/bin/sh\n" * 50 + packed)
    assert read_bytes(tmp_path / "a.zip" / "walk.bvh") == WALK


def test_a_folder_that_is_called_like_an_archive_is_one(tmp_path):
    (tmp_path / "a.zip").mkdir()
    (tmp_path / "a.zip" / "walk.bvh").write_bytes(WALK)
    assert split(tmp_path / "a.zip" / "walk.bvh") is None
    assert read_bytes(tmp_path / "a.zip" / "walk.bvh") == WALK


def test_an_archive_itself_is_no_motion_and_the_error_names_what_is_in_it(tmp_path):
    assert "name a file in it, such as a.zip/walk.bvh" in reason(pack(tmp_path / "a.zip", {"walk.bvh": WALK}))
    with pytest.raises(FileNotFoundError):
        open_member(tmp_path / "a.zip", "none.bvh")
    assert reason(tmp_path / "a.zip" / "none.bvh") == "no such file in the archive"


@pytest.mark.parametrize(
    "name",
    ["../out.bvh", "a/../../out.bvh", "/etc/out.bvh", "a//b.bvh", "./a.bvh", "C:/a.bvh", "a\\b.bvh", "a\nb.bvh"],
)
def test_names_that_lead_out_or_are_none_are_passed_over(tmp_path, name):
    archive = read_archive(pack(tmp_path / "a.zip", {name: WALK, "walk.bvh": WALK}))
    assert list(archive.members) == ["walk.bvh"]
    assert list(archive.remarks.values()) == [[name]]


def test_archives_in_it_links_and_all_but_the_last_of_a_name_are_passed_over(tmp_path):
    link = zipfile.ZipInfo("link.bvh")
    link.external_attr = (stat.S_IFLNK | 0o777) << 16
    with zipfile.ZipFile(tmp_path / "a.zip", "w") as archive:
        archive.writestr("more.zip", b"PK")
        archive.writestr(link, "/etc/passwd")
        archive.writestr("walk.bvh", b"old")
        with pytest.warns(UserWarning, match="Duplicate"):
            archive.writestr("walk.bvh", WALK)
    found = read_archive(tmp_path / "a.zip")
    assert list(found.members) == ["walk.bvh"]
    assert sorted(found.remarks.values()) == [["link.bvh"], ["more.zip"], ["walk.bvh"]]
    assert read_bytes(tmp_path / "a.zip" / "walk.bvh") == WALK


def test_hidden_files_and_what_macos_adds_are_skipped_without_a_word(tmp_path):
    members = {".hidden.bvh": WALK, "__MACOSX/._walk.bvh": b"x", "a/.git/x.bvh": WALK, "a/": b"", "a/walk.bvh": WALK}
    archive = read_archive(pack(tmp_path / "a.zip", members))
    assert (archive.folders, archive.remarks) == ({"a": ["a/walk.bvh"]}, {})


@pytest.mark.parametrize("form", ["NFC", "NFD"])
@pytest.mark.parametrize("is_said", [True, False])
def test_names_in_utf8_are_read_as_such_whether_or_not_that_is_said(tmp_path, form, is_said):
    name = normalize(form, "Läufer_é.bvh")
    path = pack(tmp_path / "a.zip", {name: WALK})
    if not is_said:  # the flag stands in the local header and in the directory
        data = bytearray(path.read_bytes())
        for at in (data.find(b"PK\x03\x04") + 6, data.find(b"PK\x01\x02") + 8):
            data[at : at + 2] = struct.pack("<H", 0)
        path.write_bytes(data)
    assert read_bytes(path / name) == WALK


def test_what_is_encrypted_or_unpacks_to_too_much_is_refused_by_its_directory(tmp_path, monkeypatch):
    zeros = pack(tmp_path / "zeros.zip", {"walk.bvh": bytes(17 << 20)})
    assert "more than 250 times its size" in reason(zeros / "walk.bvh")
    path = pack(tmp_path / "a.zip", {"walk.bvh": WALK})
    data = bytearray(path.read_bytes())
    data[data.find(b"PK\x01\x02") + 8] |= 1
    (tmp_path / "encrypted.zip").write_bytes(data)
    assert "it is encrypted" in reason(tmp_path / "encrypted.zip" / "walk.bvh")
    monkeypatch.setattr(zip_archive, "MAX_MEMBER", 1000)
    assert "it unpacks to more than" in reason(path / "walk.bvh")
    info = zipfile.ZipInfo("a.bvh")
    info.compress_type = 99
    assert "a method that is not known (number 99)" in refusal(info)


def test_no_more_is_unpacked_than_is_announced(tmp_path):
    path = pack(tmp_path / "a.zip", {"walk.bvh": bytes(5_000_000)})
    data = bytearray(path.read_bytes())
    at = data.find(b"PK\x01\x02")
    data[at + 24 : at + 28] = struct.pack("<I", 1000)
    path.write_bytes(data)
    assert "the archive is damaged" in reason(path / "walk.bvh")  # the checksum does not fit 1000 bytes


def test_a_directory_of_too_many_or_overlapping_files_is_refused(tmp_path, monkeypatch):
    path = pack(tmp_path / "a.zip", {f"{i}.bvh": b"HIERARCHY" for i in range(20)})
    monkeypatch.setattr(zip_archive, "MAX_MEMBERS", 10)
    with pytest.raises(UnreadableMotion, match="holds more than 10 files; unpack it"):
        read_archive(path)
    os.utime(path, (1, 1))
    monkeypatch.setattr(zip_archive, "MAX_DIRECTORY", 500)
    with pytest.raises(UnreadableMotion, match="its directory is too long"):
        read_archive(path)
    data = bytearray(pack(tmp_path / "b.zip", {"a.bvh": WALK, "b.bvh": WALK}).read_bytes())
    first = data.find(b"PK\x01\x02")
    data[first + 20 : first + 24] = struct.pack("<I", 1 << 20)
    monkeypatch.undo()
    (tmp_path / "b.zip").write_bytes(data)
    with pytest.raises(UnreadableMotion, match="files that overlap"):
        read_archive(tmp_path / "b.zip")


@pytest.mark.parametrize("seed", range(60))
def test_a_damaged_archive_gives_a_reason_and_nothing_else(tmp_path, seed):
    data = bytearray(pack(tmp_path / "a.zip", {"walk.bvh": WALK, "day/turn.bvh": WALK}).read_bytes())
    rng = np.random.default_rng(seed)
    for at in rng.integers(0, len(data), rng.integers(1, 6)):
        data[at] = rng.integers(256)
    (tmp_path / "a.zip").write_bytes(data[: rng.integers(len(data) // 2, len(data) + 1)])
    try:
        archive = read_archive(tmp_path / "a.zip")
    except UnreadableMotion:
        return
    for name in archive.members:
        with contextlib.suppress(UnreadableMotion):
            assert read_bytes(tmp_path / "a.zip" / name) == WALK


def test_an_archive_that_is_replaced_is_read_anew(tmp_path):
    path = pack(tmp_path / "a.zip", {"walk.bvh": WALK})
    before = state(path / "walk.bvh")
    assert state(path / "walk.bvh") == before
    other = bvh(performance(frames=5)).encode()
    path.unlink()
    pack(path, {"walk.bvh": other})
    assert read_bytes(path / "walk.bvh") == other
    assert state(path / "walk.bvh") != before


def test_a_member_is_read_in_pieces_too(tmp_path):
    path = pack(tmp_path / "a.zip", {"walk.bvh": WALK})
    with open_member(path, "walk.bvh") as file:
        pieces = list(iter(lambda: file.read(100), b""))
    assert b"".join(pieces) == WALK
    assert io.TextIOWrapper(open_member(path, "walk.bvh")).readline() == "HIERARCHY\n"
