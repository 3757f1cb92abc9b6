"""Scanning a folder: links, names, and entries that cannot be looked at."""

import os
from unicodedata import normalize

import pytest

from indexer.ingest.scan import walk
from tests.indexer.folders import write

pytestmark = pytest.mark.skipif(os.name == "nt", reason="symbolic links need a privilege there")


@pytest.fixture
def root(tmp_path):
    write(tmp_path / "takes" / "a.npy", 1)
    write(tmp_path / "takes" / "day" / "b.npy", 2)
    return tmp_path / "takes"


def found(root):
    return [motion.path for folder in walk(root).folders for motion in folder.motions()]


def link(path, target, *, is_folder=False):
    path.parent.mkdir(parents=True, exist_ok=True)
    path.symlink_to(target, target_is_directory=is_folder)


def test_a_link_to_a_hidden_store_is_read_under_its_own_name(root):
    write(root / ".git" / "annex" / "objects" / "SHA256E-s1--ab.npy", 3)
    write(root / ".dvc" / "cache" / "files" / "md5" / "x.npy", 4)
    link(root / "takes" / "walk.npy", "../.git/annex/objects/SHA256E-s1--ab.npy")
    link(root / "linked", ".dvc/cache/files", is_folder=True)
    assert found(root) == ["a.npy", "day/b.npy", "linked/md5/x.npy", "takes/walk.npy"]
    assert walk(root).warnings == []


def test_a_link_may_lead_out_of_the_folder(root, tmp_path):
    write(tmp_path / "elsewhere" / "deep" / "c.npy", 3)
    link(root / "more", tmp_path / "elsewhere", is_folder=True)
    link(root / "one.npy", tmp_path / "elsewhere" / "deep" / "c.npy")
    assert found(root) in (["a.npy", "day/b.npy", "more/deep/c.npy"], ["a.npy", "day/b.npy", "one.npy"])


def test_what_several_paths_lead_to_is_taken_once_under_its_own(root):
    link(root / "a link.npy", "a.npy")
    link(root / "0", "day", is_folder=True)
    link(root / "first.npy", ".store")
    link(root / "second.npy", ".store")
    write(root / ".store.npy", 3).rename(root / ".store")
    assert found(root) == ["a.npy", "first.npy", "day/b.npy"]
    assert walk(root).warnings == [
        f"{root}: symbolic links passed over, to what is indexed under another name: 3, such as 0"
    ]


def test_a_buffer_belongs_to_the_scene_of_its_name(root):
    for name in ("run.gltf", "walk.gltf", "walk.bin", "data.bin"):
        (root / name).write_text("{}")
    scenes = [motion for motion in walk(root).folders[0].motions() if motion.ending == ".gltf"]
    assert [scene.companions for scene in scenes] == [(), ("walk.bin",)]


def test_a_skeleton_or_caption_file_may_be_shared_through_links(root):
    (root / "s.asf").write_text("skeleton")
    (root / "a.txt").write_text("a person walks")
    (root / "day" / "b_01.amc").write_text("motion")
    link(root / "day" / "s.asf", "../s.asf")
    link(root / "day" / "b.txt", "../a.txt")
    folder = walk(root).folders[1]
    motions = folder.motions()
    assert [motion.companions for motion in motions] == [(), ("day/s.asf",)]
    assert [(file.path, about) for file, about in folder.side_files(motions)] == [("day/b.txt", ["day/b.npy"])]


def test_loops_are_named_once_and_passed_over(root, tmp_path):
    link(root / "day" / "up", "..", is_folder=True)
    link(root / "around", tmp_path, is_folder=True)
    link(root / "itself.npy", "itself.npy")
    write(tmp_path / "other" / "c.npy", 3)
    link(tmp_path / "other" / "back", tmp_path / "other", is_folder=True)
    link(tmp_path / "other" / "root", root, is_folder=True)
    link(root / "other", tmp_path / "other", is_folder=True)
    assert found(root) == ["a.npy", "day/b.npy", "other/c.npy"]
    (warning,) = walk(root).warnings
    assert "symbolic links passed over, back to a folder around them: 5, such as around" in warning


def test_links_that_lead_nowhere_are_one_warning_and_what_they_led_to_may_be_there(root):
    for number in range(7):
        link(root / "annex" / f"{number}.npy", "../.git/annex/objects/missing")
    scan = walk(root)
    assert len(scan.warnings) == 1
    assert "symbolic links to nothing that is there, whose clips are left as they were: 7" in scan.warnings[0]
    assert "such as annex/0.npy" in scan.warnings[0]
    assert scan.may_hold("annex/3.npy")
    assert not scan.may_hold("annex/30.npy")


def test_a_folder_that_lists_but_cannot_be_entered_costs_itself_alone(root, monkeypatch):
    stat = os.stat

    def refuse(path, **options):
        if os.fspath(path).endswith(os.path.join("day", ".")):
            raise PermissionError(13, "Permission denied")
        return stat(path, **options)

    monkeypatch.setattr(os, "stat", refuse)
    scan = walk(root)
    assert [folder.path for folder in scan.folders] == [""]
    assert scan.failed == [(str(root / "day"), "cannot be listed (Permission denied); its clips are left as they were")]
    assert scan.may_hold("day/b.npy")
    assert not scan.may_hold("daylight/b.npy")


def test_names_that_are_not_utf8_are_one_warning(root):
    for number in range(3):
        (root / os.fsdecode(b"\xe4%d.npy" % number)).write_bytes(b"x")
    assert found(root) == ["a.npy", "day/b.npy"]
    (warning,) = walk(root).warnings
    assert "entries passed over, to be renamed, whose names are not UTF-8: 3" in warning


@pytest.mark.parametrize("year", [1492, 1969, 2262.5, 2400])
def test_any_time_is_an_integer_that_sqlite_holds(root, year):
    try:
        os.utime(root / "a.npy", ns=(0, int((year - 1970) * 365.25 * 86400) * 10**9))
    except OverflowError:
        pytest.skip("no such time here")
    (motion, *_) = walk(root).folders[0].motions()
    assert -(2**63) <= motion.mtime_ns < 2**63


def test_captions_beside_a_motion_go_by_its_name_however_that_is_encoded(root):
    write(root / normalize("NFD", "Läufer.npy"), 3)
    (root / normalize("NFC", "Läufer.txt")).write_text("a person runs")
    folder = walk(root).folders[0]
    assert [about for _, about in folder.side_files(folder.motions())] == [[normalize("NFD", "Läufer.npy")]]


def test_archives_that_are_not_looked_into_are_counted(tmp_path):
    for name in ("a.tar.gz", "b.7z", "c.RAR", "d.zip.txt"):
        (tmp_path / name).write_bytes(b"x")
    (warning,) = walk(tmp_path).warnings
    assert "packed files not read, to be unpacked, or packed as .zip: 3, such as a.tar.gz" in warning
