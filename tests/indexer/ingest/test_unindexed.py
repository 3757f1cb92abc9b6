"""Reading an unindexed file, at the frame rate that its library knows for it."""

import shutil
from unicodedata import normalize

import numpy as np
import pytest

import motionseek
from indexer.ingest.indexing import index
from indexer.ingest.unindexed import known_options, read_unindexed
from indexer.store.stored_library import StoredLibrary
from tests.indexer.folders import SmallBundle, write
from tests.indexer.performances import bvh, performance, together


@pytest.fixture
def root(tmp_path):
    folder = tmp_path / "takes"
    for seed in (1, 2):
        write(folder / f"{seed}.npy", seed)  # four seconds at 20 frames a second
    return folder


def duration(root, path, **given):
    with StoredLibrary.open(root) as library:
        return pytest.approx(read_unindexed(library, path, **given).motion.duration, abs=0.15)


def test_a_copy_is_read_as_the_file_of_its_content_was(root, tmp_path):
    (root / "captions.csv").write_text("path,fps\n1.npy,40\n")
    index(root, bundle=SmallBundle(), jobs=1)
    for name, seconds in (("1.npy", 2), ("2.npy", 4)):
        copy = shutil.copy(root / name, tmp_path / f"copy of {name}")
        assert duration(root, tmp_path / copy) == seconds


def test_a_file_that_is_not_indexed_yet_is_read_as_its_captions_table_says(root):
    (root / "captions.csv").write_text("path,fps\nlater.npy,10\n")
    index(root, bundle=SmallBundle(), jobs=1)
    assert duration(root, write(root / "later.npy", 3)) == 8


def test_a_file_that_names_no_rate_is_read_as_all_others_of_its_skeleton(root, tmp_path):
    index(root, bundle=SmallBundle(), jobs=1, fps=10)
    stranger = write(tmp_path / "stranger.npy", 4)
    assert duration(root, stranger) == 8
    assert duration(root, stranger, fps=40) == 2
    (root / "captions.csv").write_text("path,fps\n1.npy,40\n")
    index(root, bundle=SmallBundle(), jobs=1)
    assert duration(root, stranger) == 4, "where the others differ, they say nothing"


def test_a_rate_that_is_given_takes_precedence(root, tmp_path):
    index(root, bundle=SmallBundle(), jobs=1, fps=10)
    assert duration(root, shutil.copy(root / "1.npy", tmp_path / "copy.npy")) == 8
    assert duration(root, tmp_path / "copy.npy", fps=20) == 4


def test_content_that_was_read_in_two_ways_says_nothing(root, tmp_path):
    shutil.copy(root / "1.npy", root / "twin.npy")
    (root / "captions.csv").write_text("path,fps\n1.npy,40\n")
    index(root, bundle=SmallBundle(), jobs=1)
    with StoredLibrary.open(root) as library:
        assert known_options(library, tmp_path / "nowhere.npy") is None
        assert known_options(library, root / "1.npy").fps == 40
        assert known_options(library, write(tmp_path / "copy.npy", 1)) is None


def test_a_motion_is_known_by_its_content_with_its_skeleton(root, tmp_path, mocap):
    amc = min((mocap / "cmu").rglob("*.amc"), key=lambda file: (file.stat().st_size, file))
    away = tmp_path / "away"
    away.mkdir()
    for folder in (root, away):
        shutil.copy(amc, folder / "walk.amc")
        shutil.copy(next(amc.parent.glob("*.asf")), folder / "walk.asf")
    index(root, bundle=SmallBundle(), jobs=1, fps=30)
    with StoredLibrary.open(root) as library:
        assert known_options(library, away / "walk.amc").fps == 30
        found = library.find("walk").duration
    assert duration(root, away / "walk.amc") == found
    assert duration(root, away / "walk.amc", fps=120) == found / 4


def test_what_was_taken_for_granted_is_said(tmp_path):
    path = tmp_path / "take.bvh"
    path.write_text(bvh(performance()).replace("Frames: 30", "Frames: 40"))
    for read in (motionseek.load, lambda path: motionseek.describe(path, 1)):
        with pytest.warns(motionseek.MotionSeekWarning, match=r"take\.bvh: it announces 40 frames but holds 30"):
            read(path)


@pytest.mark.parametrize(("on_disk", "typed"), [("NFD", "NFC"), ("NFC", "NFD")])
def test_names_are_compared_in_any_form_of_unicode(tmp_path, on_disk, typed):
    folder = tmp_path / normalize(on_disk, "Läufer")
    write(folder / normalize(on_disk, "é.npy"), 1)
    for path in (folder / normalize(typed, "é.npy"), tmp_path / normalize(typed, "Läufer/é.npy")):
        assert motionseek.load(path).duration == pytest.approx(4, abs=0.15)


def test_a_part_that_is_not_there_is_answered_with_those_that_are(tmp_path):
    path = tmp_path / "pair.bvh"
    path.write_text(together(bvh(performance(seed=1)), bvh(performance(seed=2).transformed(np.diag([-1.0, 1, -1])))))
    with pytest.raises(motionseek.UnreadableMotion, match=r"no take '3'; name one of them: pair\.bvh, pair\.bvh#2"):
        motionseek.load(f"{path}#3")
