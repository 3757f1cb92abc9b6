"""ZIP archives in an indexed folder: their members are clips, read in place."""

import os
import zipfile
from pathlib import Path
from unicodedata import normalize

import numpy as np
import pytest

import motionseek
from encoders.errors import UnreadableMotion
from indexer.formats import zip_archive
from indexer.ingest.indexing import index
from indexer.store.stored_library import Caption, StoredLibrary
from tests.indexer.folders import SmallBundle, moving, write
from tests.indexer.formats.test_zip_archive import pack


@pytest.fixture
def bundle():
    return SmallBundle()


def content(folder, seed):
    return write(folder.parent / "made.npy", seed).read_bytes()


@pytest.fixture
def root(tmp_path):
    folder = tmp_path / "takes"
    write(folder / "a.npy", 1)
    pack(folder / "sub" / "pack.zip", {"walk.npy": content(folder, 2), "day 1/turn.npy": content(folder, 3)})
    return folder


def counts(summary):
    return summary.indexed, summary.unchanged, summary.moved, summary.gone, len(summary.failed)


def clips(root):
    with StoredLibrary.open(root) as library:
        return {clip.path: clip.id for clip in library.clips()}


def test_members_are_clips_under_the_path_of_the_archive(root, bundle, monkeypatch):
    assert counts(index(root, bundle=bundle, jobs=1)) == (3, 0, 0, 0, 0)
    assert set(clips(root)) == {"a.npy", "sub/pack.zip/walk.npy", "sub/pack.zip/day 1/turn.npy"}
    monkeypatch.setattr(zip_archive, "open_member", lambda *_: pytest.fail("opened, though nothing changed"))
    assert counts(index(root, bundle=bundle, jobs=1)) == (0, 3, 0, 0, 0)


def test_a_member_is_loaded_named_and_filtered_by_its_path(root, bundle, monkeypatch):
    index(root, bundle=bundle, jobs=1)
    member = root / "sub" / "pack.zip" / "walk.npy"
    motion = motionseek.load(member)
    assert np.abs(motion.joints - moving(2)).max() < 1e-3
    monkeypatch.chdir(root / "sub")
    with motionseek.open(root, bundle=bundle) as library:
        number = library.find("walk").id
        for ref in (member, "sub/pack.zip/walk.npy", str(member), "pack.zip/walk.npy"):
            assert library.source(ref).clip_id == number
        assert len(list(library.clips(path="sub/pack.zip"))) == 2
        assert [clip.name for clip in library.clips(path="*.zip/day*")] == ["turn"]
        assert library.source(number and "walk").stale() == ""
        library.export("walk", root.parent / "out.npz")


def test_captions_in_an_archive_are_those_of_its_members(root, bundle):
    name = normalize("NFD", "Läufer.npy")
    pack(
        root / "more.zip",
        {
            f"x/{name}": content(root, 4),
            "x/b.npy": content(root, 5),
            "x/b.txt": "a person sits\n",
            "captions.csv": f"path,text\nx/{normalize('NFC', name)},a person runs\n",
        },
    )
    assert index(root, bundle=bundle, jobs=1).warnings == []
    with StoredLibrary.open(root, bundle=bundle) as library:
        assert library.captions(library.find("b").id) == [Caption("a person sits")]
        assert library.captions(library.find(normalize("NFC", "Läufer")).id) == [Caption("a person runs")]


def test_a_motion_keeps_its_number_as_it_moves_into_an_archive_and_out(root, bundle):
    index(root, bundle=bundle, jobs=1)
    number = clips(root)["a.npy"]
    pack(root / "new.zip", {"in/a.npy": (root / "a.npy").read_bytes()})
    (root / "a.npy").unlink()
    assert counts(index(root, bundle=bundle, jobs=1)) == (0, 2, 1, 0, 0)
    assert clips(root)["new.zip/in/a.npy"] == number
    with zipfile.ZipFile(root / "new.zip") as archive:
        archive.extractall(root / "unpacked")
    (root / "new.zip").unlink()
    assert counts(index(root, bundle=bundle, jobs=1)) == (0, 2, 1, 0, 0)
    assert clips(root)["unpacked/in/a.npy"] == number


def test_an_archive_packed_anew_is_unchanged_where_its_members_are(root, bundle):
    index(root, bundle=bundle, jobs=1)
    path = root / "sub" / "pack.zip"
    pack(path, {"walk.npy": content(root, 2), "day 1/turn.npy": content(root, 9)}, zipfile.ZIP_STORED)
    assert counts(index(root, bundle=bundle, jobs=1)) == (1, 2, 0, 0, 0)


def test_a_broken_archive_is_one_failure_that_is_remembered(root, bundle):
    (root / "broken.zip").write_bytes(b"PK\x03\x04" + bytes(500))
    summary = index(root, bundle=bundle, jobs=1)
    assert counts(summary) == (3, 0, 0, 0, 1)
    assert "the archive is damaged or no ZIP" in summary.failed[0][1]
    again = index(root, bundle=bundle, jobs=1)
    assert (counts(again), again.failed_before) == ((0, 3, 0, 0, 0), 1)
    pack(root / "broken.zip", {"b.npy": content(root, 4)})
    assert counts(index(root, bundle=bundle, jobs=1)) == (1, 3, 0, 0, 0)
    with StoredLibrary.open(root) as library:
        assert library.failures() == []


def test_one_member_that_cannot_be_read_costs_itself(root, bundle):
    path = pack(root / "sub" / "pack.zip", {"walk.npy": content(root, 2), "bad.npy": content(root, 3)}, 0)
    data = bytearray(path.read_bytes())
    data[data.rfind(b"\x93NUMPY") + 500] ^= 0xFF
    path.write_bytes(data)
    summary = index(root, bundle=bundle, jobs=1)
    assert counts(summary) == (2, 0, 0, 0, 1)
    assert Path(summary.failed[0][0]) == path / "bad.npy"
    assert "the archive is damaged" in summary.failed[0][1]


def test_what_is_passed_over_is_named_once_with_its_number(root, bundle):
    members = {f"../{i}.npy": b"x" for i in range(5)} | {"inner.zip": b"PK", "inner2.zip": b"PK"}
    pack(root / "odd.zip", members)
    first, second = sorted(index(root, bundle=bundle, jobs=1).warnings)
    assert "odd.zip: archives in it passed over, to be unpacked: 2," in first
    assert "odd.zip: files passed over whose names lead out of the archive or are none: 5," in second
    assert second.endswith("such as ../0.npy")
    assert not (root.parent / "0.npy").exists()


@pytest.mark.skipif(os.name == "nt", reason="permissions")
def test_an_archive_that_cannot_be_opened_now_keeps_its_clips(root, bundle, monkeypatch):
    index(root, bundle=bundle, jobs=1)
    before = clips(root)

    def refuse(*_):
        raise PermissionError(13, "Permission denied")

    monkeypatch.setattr(zip_archive, "_read_archive", refuse)
    summary = index(root, bundle=bundle, jobs=1)
    assert counts(summary) == (0, 1, 0, 0, 1)
    assert clips(root) == before
    monkeypatch.undo()
    assert counts(index(root, bundle=bundle, jobs=1)) == (0, 3, 0, 0, 0)


def test_naming_what_is_not_in_it_says_so(root):
    with pytest.raises(UnreadableMotion, match="no such file in the archive"):
        motionseek.load(root / "sub" / "pack.zip" / "none.npy")


@pytest.mark.skipif(os.name == "nt", reason="symbolic links need a privilege there")
def test_a_clip_is_found_by_the_path_of_the_link_that_it_was_read_from(root, bundle):
    write(root / ".store" / "key.npy", 8)
    (root / "day").symlink_to(".store", target_is_directory=True)
    (root / "linked.npy").symlink_to(write(root.parent / "elsewhere.npy", 9))
    index(root, bundle=bundle, jobs=1)
    with motionseek.open(root, bundle=bundle) as library:
        for name in ("linked.npy", "day/key.npy"):
            assert library.source(root / name).clip_id == library.find(name).id == library.find(root / name).id
            assert library.source(name).stale() == ""
