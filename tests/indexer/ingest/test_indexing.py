"""Ingest: what a run does to a library, and what it does the next time."""

import os
import signal
import sqlite3
import subprocess
import sys
import textwrap
from pathlib import Path

import numpy as np
import pytest

from encoders.errors import ArgumentError, BundleError, BundleMismatch, LibraryError, LibraryLocked
from encoders.motion import Motion
from indexer.ingest import side_files, storing
from indexer.ingest.indexing import index
from indexer.ingest.pool import Read
from indexer.ingest.reencode import reencode
from indexer.read_motion import ReadMotion
from indexer.store import read_options
from indexer.store.library_reader import FILE, FOLDER
from indexer.store.lock import write_lock
from indexer.store.stored_library import Caption, StoredLibrary
from indexer.store.writer import Writer
from tests.indexer.folders import SmallBundle, moving, write

ROOT = Path(__file__).parents[3]


@pytest.fixture
def bundle():
    return SmallBundle()


@pytest.fixture
def read_here(monkeypatch):
    """Reading in this process; the paths that were read."""
    read = []

    def read_all(requests, jobs):
        for request in requests:
            read.append(request.key.source.file.path)
            try:
                fps = request.fps or 20.0
                yield request.key, Read((ReadMotion(Motion(np.load(request.path), fps).resample(20.0), rig="rig"),))
            except Exception as error:
                yield request.key, Read(reason=f"cannot be read: {error}")

    monkeypatch.setattr(storing, "read_all", read_all)
    return read


@pytest.fixture
def root(tmp_path, read_here):
    folder = tmp_path / "takes"
    for seed, name in enumerate(["a.npy", "b.npy", "day 1/c.npy"], start=1):
        write(folder / name, seed)
    return folder


def counts(summary):
    return summary.indexed, summary.unchanged, summary.moved, summary.gone, len(summary.failed)


def paths(root):
    with StoredLibrary.open(root) as library:
        return {clip.path: clip.id for clip in library.clips_by_id(library.ids()).values()}


def test_the_second_run_finds_all_unchanged_and_reads_nothing(root, bundle, read_here):
    assert counts(index(root, bundle=bundle)) == (3, 0, 0, 0, 0)
    read_here.clear()
    assert counts(index(root, bundle=bundle)) == (0, 3, 0, 0, 0)
    assert read_here == []


def test_a_new_file_and_a_changed_one_are_all_that_is_read(root, bundle, read_here):
    index(root, bundle=bundle)
    before = paths(root)
    read_here.clear()
    write(root / "b.npy", 20, seconds=6)
    write(root / "new.npy", 21)
    assert counts(index(root, bundle=bundle)) == (2, 2, 0, 0, 0)
    assert sorted(read_here) == ["b.npy", "new.npy"]
    after = paths(root)
    assert {path: after[path] for path in before} == before  # a changed clip keeps its number
    with StoredLibrary.open(root, bundle=bundle) as library:
        assert library.find("b").duration == 6.0
        assert np.abs(library.motion(before["b.npy"]).joints - moving(20, 6)).max() < 1e-3


def test_a_file_with_a_new_time_and_the_old_content_is_unchanged(root, bundle, read_here):
    index(root, bundle=bundle)
    read_here.clear()
    os.utime(root / "a.npy", (1, 1))
    for _ in range(2):
        assert counts(index(root, bundle=bundle)) == (0, 3, 0, 0, 0)
    assert read_here == []


def test_a_moved_file_keeps_its_number_and_its_captions(root, bundle, read_here):
    (root / "captions.csv").write_text("path,text\na.npy,a person walks\n")
    index(root, bundle=bundle)
    number = paths(root)["a.npy"]
    (root / "far" / "away").mkdir(parents=True)
    (root / "a.npy").rename(root / "far" / "away" / "renamed.npy")
    read_here.clear()
    assert counts(index(root, bundle=bundle)) == (0, 2, 1, 0, 0)
    assert read_here == []
    with StoredLibrary.open(root, bundle=bundle) as library:
        clip = library.find("renamed")
        assert (clip.id, clip.path) == (number, "far/away/renamed.npy")
        assert library.captions(clip.id) == [Caption("a person walks")]


def test_a_folder_renamed_with_its_captions_says_each_once(root, bundle, read_here):
    (root / "day 1" / "captions.csv").write_text("path,text\nc.npy,a person walks\n")
    index(root, bundle=bundle)
    (root / "day 1").rename(root / "day 2")
    assert counts(index(root, bundle=bundle)) == (0, 2, 1, 0, 0)
    with StoredLibrary.open(root, bundle=bundle) as library:
        assert library.captions(library.find("c").id) == [Caption("a person walks")]
        assert library.stats()["captions"] == 1


def test_a_copy_is_a_clip_of_its_own(root, bundle):
    index(root, bundle=bundle)
    (root / "copy.npy").write_bytes((root / "a.npy").read_bytes())
    assert counts(index(root, bundle=bundle)) == (1, 3, 0, 0, 0)


def test_two_files_that_swap_their_names_are_read_again(root, bundle):
    index(root, bundle=bundle)
    (root / "a.npy").rename(root / "x")
    (root / "b.npy").rename(root / "a.npy")
    (root / "x").rename(root / "b.npy")
    os.utime(root / "a.npy", (5, 5))
    os.utime(root / "b.npy", (6, 6))
    index(root, bundle=bundle)
    with StoredLibrary.open(root, bundle=bundle) as library:
        assert np.abs(library.motion(library.find("a").id).joints - moving(2)).max() < 1e-3
        assert np.abs(library.motion(library.find("b").id).joints - moving(1)).max() < 1e-3


def test_a_vanished_file_is_not_found_and_comes_back_as_it_was(root, bundle, read_here):
    (root / "captions.csv").write_text("path,text\na.npy,a person walks\n")
    index(root, bundle=bundle)
    number = paths(root)["a.npy"]
    content = (root / "a.npy").read_bytes()
    (root / "a.npy").unlink()
    assert counts(index(root, bundle=bundle)) == (0, 2, 0, 1, 0)
    with StoredLibrary.open(root, bundle=bundle) as library:
        assert len(library) == 2
        query = bundle.encode_motions([Motion(moving(1).astype(np.float32))])
        assert number not in library.nearest_clips(query, 9)[1]
        assert number not in library.nearest_windows(query, 99)[1]
        assert library.caption_vectors()[0] == []
        with pytest.raises(LibraryError):
            library.clip(number)
    read_here.clear()
    (root / "a.npy").write_bytes(content)
    assert counts(index(root, bundle=bundle)) == (0, 2, 1, 0, 0)
    assert read_here == []
    assert paths(root)["a.npy"] == number
    with StoredLibrary.open(root, bundle=bundle) as library:
        assert number in library.nearest_clips(query, 9)[1]
        assert library.captions(number) == [Caption("a person walks")]


def test_a_missing_root_is_an_error_and_nothing_is_lost(root, bundle, tmp_path):
    index(root, library=tmp_path / "lib", bundle=bundle)
    root.rename(tmp_path / "elsewhere")
    with pytest.raises(LibraryError, match="no such folder, so nothing was changed"):
        index(root, library=tmp_path / "lib", bundle=bundle)
    root.mkdir()
    with pytest.raises(LibraryError, match="is empty, so nothing was changed; is its drive connected"):
        index(root, library=tmp_path / "lib", bundle=bundle)
    assert len(StoredLibrary.open(tmp_path / "lib")) == 3


@pytest.mark.skipif(os.name == "nt" or os.geteuid() == 0, reason="needs a user who cannot list every folder")
def test_a_folder_that_cannot_be_listed_is_left_as_it_was(root, bundle):
    index(root, bundle=bundle)
    (root / "day 1").chmod(0)
    try:
        summary = index(root, bundle=bundle)
    finally:
        (root / "day 1").chmod(0o755)
    assert summary.gone == 0
    assert "cannot be listed" in summary.failed[0][1]


def test_what_an_unlisted_folder_held_is_not_gone(root, bundle, monkeypatch):
    index(root, bundle=bundle)
    scandir = os.scandir

    def refuse(path):
        if str(path).endswith("day 1"):
            raise PermissionError(13, "Permission denied")
        return scandir(path)

    monkeypatch.setattr(os, "scandir", refuse)
    summary = index(root, bundle=bundle)
    assert summary.gone == 0
    assert [(Path(path).name, reason) for path, reason in summary.failed] == [
        ("day 1", "cannot be listed (Permission denied); its clips are left as they were")
    ]
    assert len(paths(root)) == 3


def test_hidden_files_and_other_endings_are_passed_over(root, bundle):
    write(root / ".hidden.npy", 5)
    write(root / ".cache" / "x.npy", 5)
    (root / "picture.png").write_bytes(b"x")
    (root / "readme.txt").write_text("hello")
    summary = index(root, bundle=bundle)
    assert (counts(summary), summary.warnings) == ((3, 0, 0, 0, 0), [])


def test_a_failure_is_recorded_and_tried_again_only_when_the_file_changed(root, bundle, read_here):
    (root / "bad.npy").write_text("no motion")
    (root / "scene.fbx").write_bytes(b"Kaydara FBX Binary")
    first = index(root, bundle=bundle)
    assert [Path(path).name for path, _ in first.failed] == ["bad.npy", "scene.fbx"]
    read_here.clear()
    second = index(root, bundle=bundle)
    assert (counts(second), second.failed_before) == ((0, 3, 0, 0, 0), 2)
    assert read_here == []
    with StoredLibrary.open(root) as library:
        assert [Path(path).name for path, _ in library.failures()] == ["bad.npy", "scene.fbx"]
    assert len(index(root, bundle=bundle, retry=True).failed) == 2
    write(root / "bad.npy", 9)
    assert counts(index(root, bundle=bundle)) == (1, 3, 0, 0, 0)
    with StoredLibrary.open(root) as library:
        assert len(library.failures()) == 1


def test_a_clip_whose_file_breaks_is_gone_and_the_failure_reported(root, bundle):
    index(root, bundle=bundle)
    content = (root / "a.npy").read_bytes()
    (root / "a.npy").write_text("broken")
    assert counts(index(root, bundle=bundle)) == (0, 2, 0, 0, 1)
    assert "a.npy" not in paths(root)
    (root / "a.npy").write_bytes(content)
    assert counts(index(root, bundle=bundle)) == (0, 2, 1, 0, 0)
    assert "a.npy" in paths(root)


def test_a_failed_file_that_is_deleted_is_forgotten(root, bundle):
    (root / "bad.npy").write_text("no motion")
    index(root, bundle=bundle)
    (root / "bad.npy").unlink()
    assert counts(index(root, bundle=bundle)) == (0, 3, 0, 0, 0)
    assert StoredLibrary.open(root).failures() == []


def test_a_skeleton_is_no_clip_but_its_change_is_a_change_of_its_motions(root, bundle, read_here):
    (root / "s.asf").write_text("skeleton")
    (root / "s_01.amc").write_text("motion")
    index(root, bundle=bundle)
    assert "s.asf" not in read_here
    read_here.clear()
    (root / "s.asf").write_text("another skeleton")
    index(root, bundle=bundle)
    assert read_here == ["s_01.amc"]


def test_changed_captions_are_picked_up_without_reading_motions(root, bundle, read_here):
    (root / "a.txt").write_text("a person walks\n")
    index(root, bundle=bundle)
    read_here.clear()
    bundle.sentences.clear()
    (root / "a.txt").write_text("a person walks\nand turns\n")
    (root / "captions.jsonl").write_text('{"path": "b.npy", "text": "sits down", "start": 0.5, "end": 2}\n')
    assert counts(index(root, bundle=bundle)) == (0, 3, 0, 0, 0)
    assert read_here == []
    assert sorted(bundle.sentences) == ["and turns", "sits down"]
    with StoredLibrary.open(root, bundle=bundle) as library:
        assert [c.text for c in library.captions(library.find("a").id)] == ["a person walks", "and turns"]
        assert library.captions(library.find("b").id) == [Caption("sits down", 0.5, 2.0)]


def test_unchanged_side_files_are_not_opened(root, bundle, monkeypatch):
    (root / "a.txt").write_text("a person walks\n")
    index(root, bundle=bundle)
    monkeypatch.setattr(side_files, "read_lines", lambda *_: pytest.fail("opened"))
    index(root, bundle=bundle)


def test_captions_whose_file_is_deleted_are_gone(root, bundle):
    (root / "a.txt").write_text("a person walks\n")
    index(root, bundle=bundle)
    (root / "a.txt").unlink()
    index(root, bundle=bundle)
    with StoredLibrary.open(root, bundle=bundle) as library:
        assert library.captions(library.find("a").id) == []


def test_a_caption_waits_for_a_motion_that_comes_later(root, bundle):
    (root / "captions.csv").write_text("path,text\nlater.npy,a person jumps\n")
    summary = index(root, bundle=bundle)
    assert "a caption is of motions that are not indexed, such as 'later.npy'" in summary.warnings[0]
    write(root / "later.npy", 8)
    assert index(root, bundle=bundle).warnings == []
    with StoredLibrary.open(root, bundle=bundle) as library:
        assert library.captions(library.find("later").id) == [Caption("a person jumps")]
        assert library.caption_vectors()[0] == ["a person jumps"]


def test_the_frame_rate_of_a_table_takes_precedence_over_the_option(root, bundle, read_here):
    (root / "day 1" / "captions.csv").write_text("path,fps\nc.npy,40\n")
    index(root, bundle=bundle, fps=10)
    with StoredLibrary.open(root, bundle=bundle) as library:
        assert library.find("c").duration == pytest.approx(2, abs=0.1)
        assert library.find("a").duration == pytest.approx(8, abs=0.1)
    read_here.clear()
    (root / "day 1" / "captions.csv").write_text("path,fps\nc.npy,20\n")
    index(root, bundle=bundle, fps=10)
    assert read_here == ["day 1/c.npy"]


def test_options_given_for_files_need_not_be_given_again(root, bundle, read_here):
    index(root, bundle=bundle, fps=10, joint_map={"head": "Kopf"})
    read_here.clear()
    (root / "a.npy").rename(root / "moved.npy")
    assert counts(index(root, bundle=bundle)) == (0, 2, 1, 0, 0)
    write(root / "b.npy", 12)
    assert counts(index(root, bundle=bundle)) == (1, 2, 0, 0, 0)
    with StoredLibrary.open(root, bundle=bundle) as library:
        assert library.find("b").duration == pytest.approx(8, abs=0.1)
    assert counts(index(root, bundle=bundle, fps=20)) == (3, 0, 0, 0, 0)
    assert counts(index(root, bundle=bundle, joint_map={})) == (3, 0, 0, 0, 0)
    assert counts(index(root, bundle=bundle)) == (0, 3, 0, 0, 0)


def test_several_folders_share_a_library(root, bundle, tmp_path):
    other = write(tmp_path / "other" / "a.npy", 30).parent
    with pytest.raises(LibraryError, match="2 folders need one library; name its folder"):
        index([root, other], bundle=bundle)
    library_folder = tmp_path / "lib"
    assert index([root, other], library=library_folder, bundle=bundle).indexed == 4
    (other / "a.npy").rename(root / "moved.npy")
    assert counts(index([], library=library_folder, bundle=bundle)) == (0, 3, 1, 0, 0)
    with StoredLibrary.open(library_folder, bundle=bundle) as library:
        assert library.roots == [root, other]
        assert library.find("moved").root == root
        write(other / "a.npy", 31)
        index(other, library=library_folder, bundle=bundle)
        with pytest.raises(LibraryError, match="2 clips are called so"):
            library.find("a.npy")
        assert library.find(other / "a.npy").root == other
    assert not (root / FOLDER).exists()


@pytest.mark.parametrize(
    ("name", "value"),
    [
        *[("fps", value) for value in ("25", float("nan"), float("inf"), -5, 0, 1e9, "x", True, 1e-9, [25], 1j)],
        *[("jobs", value) for value in (-1, 0, "2", True, 1.5, 1000)],
        *[("joint_map", value) for value in (5, "x", {"head": None}, {"head": 3}, {"head": ""}, {"tail": "Tail"})],
        *[("joint_map", value) for value in ({None: "Head"}, ["head"])],
        *[(flag, value) for flag in ("retry", "rebuild") for value in ("yes", 1, None)],
        *[("bundle", value) for value in (5, "x", SmallBundle)],
        *[("library", value) for value in (5, "", b"x")],
        *[("roots", value) for value in (None, 5, b"x", "", [], [None], {"a": 1})],
        ("progress", 5),
    ],
)
def test_what_makes_no_sense_is_refused_before_anything_is_touched(root, bundle, read_here, name, value):
    index(root, bundle=bundle)
    before, generation = paths(root), StoredLibrary.open(root).generation
    read_here.clear()
    with pytest.raises(ArgumentError, match=name):
        index(**{"roots": root, "bundle": bundle, name: value})
    assert (paths(root), StoredLibrary.open(root).generation) == (before, generation)
    assert read_here == []


def test_numbers_of_numpy_are_options(root, bundle):
    given = {"fps": np.float32(10), "jobs": np.int64(1), "retry": np.bool_(False)}
    assert index(root, bundle=bundle, **given).indexed == 3


def test_a_file_is_no_root(root, bundle):
    with pytest.raises(ArgumentError, match=r"roots: .*a.npy is a file; index its folder"):
        index(root / "a.npy", bundle=bundle)
    assert sorted(path.name for path in root.iterdir()) == ["a.npy", "b.npy", "day 1"]


def test_a_model_of_other_than_unit_vectors_is_refused_and_nothing_is_indexed(root):
    for method, what in (("encode_features", "motions"), ("encode_texts", "captions")):
        bad = SmallBundle()
        setattr(bad, method, lambda values: np.zeros((len(values), 16), np.float32))
        with pytest.raises(BundleError, match=f"small: vectors of {what} must be finite and of length 1"):
            index(root, bundle=bad)
    assert index(root, bundle=SmallBundle("another")).indexed == 3


@pytest.mark.parametrize("library", [False, True])
def test_a_folder_that_is_a_library_stays_the_one_library_and_its_own_files_are_no_motions(root, bundle, library):
    StoredLibrary.open(root, create=True).close()
    given = {"library": root} if library else {}
    assert index(root, bundle=bundle, **given).indexed == 3
    (root / "previews").mkdir()
    write(root / "previews" / "p.npy", 7)
    write(root / "vectors" / "v.npy", 8)
    for more in ({}, {"library": root}):
        summary = index(root, bundle=bundle, **more)
        assert (counts(summary), summary.failed_before) == ((0, 3, 0, 0, 0), 0)
    assert not (root / FOLDER).exists()
    with StoredLibrary.open(root) as opened:
        assert (opened.folder, len(opened)) == (root, 3)


def test_a_library_below_a_root_is_no_motions(root, bundle, tmp_path):
    index(root / "day 1", library=root / "lib", bundle=bundle)
    assert list((root / "lib" / "vectors").rglob("*.npy"))
    write(root / "lib" / "take.npy", 9)
    write(root / "vectors" / "d.npy", 10)  # in no library
    assert counts(index(root, library=tmp_path / "all", bundle=bundle)) == (5, 0, 0, 0, 0)
    assert paths(tmp_path / "all").keys() == {"a.npy", "b.npy", "day 1/c.npy", "lib/take.npy", "vectors/d.npy"}


def test_folders_inside_each_other_are_refused(root, bundle, tmp_path):
    index(root, library=tmp_path / "lib", bundle=bundle)
    with pytest.raises(LibraryError, match="lies inside"):
        index(root / "day 1", library=tmp_path / "lib", bundle=bundle)


def test_an_empty_folder_and_odd_names_are_fine(tmp_path, bundle, read_here):
    (tmp_path / "empty").mkdir()
    assert counts(index(tmp_path / "empty", bundle=bundle)) == (0, 0, 0, 0, 0)
    names = ["with space.npy", "über/täke'\"%?.npy", "日本/歩く.npy", "a..b.npy", "[x]*.npy"]
    for seed, name in enumerate(names):
        write(tmp_path / "odd" / name, seed)
    assert index(tmp_path / "odd", bundle=bundle).indexed == 5
    with StoredLibrary.open(tmp_path / "odd") as library:
        assert {library.find(name).path for name in names} == set(names)


def test_progress_counts_up_to_what_there_is_to_do(root, bundle):
    calls = []
    index(root, bundle=bundle, progress=lambda *state: calls.append(state))
    assert [call[:2] for call in calls] == [(0, 3), (1, 3), (2, 3), (3, 3)]


def test_one_writer_at_a_time_and_it_is_named(root, bundle):
    index(root, bundle=bundle)
    with (
        write_lock(root / FOLDER),
        pytest.raises(LibraryLocked, match=rf"being written by process {os.getpid()} on .*; wait until"),
    ):
        index(root, bundle=bundle)
    assert counts(index(root, bundle=bundle)) == (0, 3, 0, 0, 0)


def test_a_library_that_cannot_be_written_says_where_else(tmp_path, bundle, read_here, root):
    (root / FOLDER).write_text("in the way")
    with pytest.raises(LibraryError, match=r"cannot be written .*--library"):
        index(root, bundle=bundle)


def test_readers_see_whole_batches_while_one_is_written(root, bundle, monkeypatch):
    index(root, bundle=bundle)
    write(root / "new.npy", 40)
    seen = []
    add = Writer.add

    def add_and_look(self, *arguments):
        number = add(self, *arguments)
        with StoredLibrary.open(root, bundle=bundle) as library:
            seen.append(len(library))
        return number

    monkeypatch.setattr(Writer, "add", add_and_look)
    index(root, bundle=bundle)
    assert seen == [3]
    assert len(StoredLibrary.open(root)) == 4


def test_ctrl_c_keeps_what_is_done(root, bundle, monkeypatch):
    for seed in range(10):
        write(root / f"more{seed}.npy", seed)
    read = storing.read_all

    def interrupted(requests, jobs):
        for number, item in enumerate(read(requests, jobs)):
            if number == 5:
                raise KeyboardInterrupt
            yield item

    monkeypatch.setattr(storing, "read_all", interrupted)
    summary = index(root, bundle=bundle)
    assert summary.interrupted
    assert summary.indexed == 5
    monkeypatch.setattr(storing, "read_all", read)
    assert counts(index(root, bundle=bundle)) == (8, 5, 0, 0, 0)


def test_another_model_is_refused_before_anything_changes(root, bundle):
    index(root, bundle=bundle)
    (root / "a.npy").unlink()
    with pytest.raises(BundleMismatch, match="rebuild=True"):
        index(root, bundle=SmallBundle("other"))
    assert len(StoredLibrary.open(root)) == 3


def test_a_library_changes_its_model_with_rebuild(root, bundle):
    index(root, bundle=bundle)
    other = SmallBundle("other", latent_size=24)
    assert index(root, bundle=other, rebuild=True).unchanged == 3
    with StoredLibrary.open(root, bundle=other) as library:
        assert library.nearest_clips(np.eye(24, dtype=np.float32)[:1], 3)[1].min() >= 0
    with pytest.raises(BundleMismatch):
        index(root, bundle=bundle)


def test_rebuild_of_a_library_that_is_not_there_makes_it(root, bundle):
    assert index(root, bundle=bundle, rebuild=True).indexed == 3


def test_reencoding_needs_no_source_file(root, bundle, tmp_path):
    (root / "a.txt").write_text("a person walks\n")
    index(root, bundle=bundle)
    (root / "b.npy").unlink()
    index(root, bundle=bundle)
    for path in root.rglob("*.npy"):
        path.rename(path.with_suffix(".away"))
    other = SmallBundle("other", latent_size=24)
    calls = []
    assert reencode(root, other, progress=lambda *state: calls.append(state)) == []
    assert calls[-1][:2] == (3, 3)  # that which has gone, too
    with StoredLibrary.open(root, bundle=other) as library:
        clip = library.find("a")
        scores, ids = library.nearest_clips(other.encode_motions([library.motion(clip.id)]), 5)
        assert ids[0].tolist()[0] == clip.id
        assert scores[0, 0] > 0.998
        assert (ids[0] == -1).sum() == 3
        assert library.caption_vectors()[2].shape == (1, 24)
    with pytest.raises(BundleMismatch):
        StoredLibrary.open(root, bundle=bundle)


def test_reencoding_that_is_cut_off_leaves_the_old_vectors_and_continues(root, bundle, monkeypatch):
    index(root, bundle=bundle)
    monkeypatch.setattr("indexer.ingest.reencode.CLIPS_A_BATCH", 1)
    other, encoded = SmallBundle("other"), []
    features = other.features

    def cut_off(motion):
        if len(encoded) == 3:  # the trial and two clips
            raise KeyboardInterrupt
        encoded.append(motion)
        return features(motion)

    other.features = cut_off
    with pytest.raises(KeyboardInterrupt):
        reencode(root, other)
    with StoredLibrary.open(root, bundle=bundle) as library:
        scores, ids = library.nearest_clips(bundle.encode_motions([library.motion(3)]), 1)
        assert (ids[0, 0], round(float(scores[0, 0]), 2)) == (3, 1)
    encoded.clear()
    reencode(root, other)
    assert len(encoded) == 2  # the trial, and what was left, its features once
    assert len(StoredLibrary.open(root, bundle=other)) == 3


def test_rebuild_with_the_same_model_makes_all_vectors_again(root, bundle):
    index(root, bundle=bundle)
    file = root / FOLDER / FILE
    with sqlite3.connect(file) as connection:
        connection.execute("UPDATE embeddings SET vector = zeroblob(32)")
        connection.execute("UPDATE windows SET vectors = zeroblob(length(vectors))")
    connection.close()
    index(root, bundle=bundle, rebuild=True)
    with StoredLibrary.open(root, bundle=bundle) as library:
        scores, ids = library.nearest_clips(bundle.encode_motions([library.motion(3)]), 1)
        assert (ids[0, 0], round(float(scores[0, 0]), 2)) == (3, 1)
        assert all(window.vectors.any() for id in library.ids() for window in library.windows(id))


def test_a_clip_that_has_gone_comes_back_after_a_rebuild(root, bundle, tmp_path):
    (root / "b.txt").write_text("a person waves\n")
    index(root, bundle=bundle)
    (root / "b.npy").rename(tmp_path / "b.npy")
    index(root, bundle=bundle)
    other = SmallBundle("other", latent_size=24)
    index(root, bundle=other, rebuild=True)
    (tmp_path / "b.npy").rename(root / "b.npy")
    assert index(root, bundle=other).moved == 1
    with StoredLibrary.open(root, bundle=other) as library:
        clip = library.find("b")
        assert [caption.text for caption in library.captions(clip.id)] == ["a person waves"]
        assert clip.id in library.nearest_clips(other.encode_motions([library.motion(clip.id)]), 1)[1]


def test_rebuild_names_a_clip_that_it_cannot_encode_and_goes_on(root, bundle):
    index(root, bundle=bundle)
    with sqlite3.connect(root / FOLDER / FILE) as connection:
        connection.execute("UPDATE poses SET data = zeroblob(9) WHERE clip_id = 2")
    connection.close()
    summary = index(root, bundle=bundle, rebuild=True)
    assert [(path, "check --repair" in reason) for path, reason in summary.failed] == [("b.npy", True)]
    with StoredLibrary.open(root, bundle=bundle) as library:
        assert len(library) == 3
        assert len(library.windows(2)) == len(library.windows(3))  # what was made of it before


def test_files_are_read_again_when_reading_has_changed(root, bundle, read_here, monkeypatch):
    index(root, bundle=bundle)
    before = paths(root)
    monkeypatch.setattr(read_options, "READER_VERSION", 99)
    assert counts(index(root, bundle=bundle)) == (3, 0, 0, 0, 0)
    assert paths(root) == before


KILLED = """
    import sys
    from indexer.ingest import storing, indexing
    from tests.indexer.folders import SmallBundle
    storing._BATCH_FILES = 2
    def report(done, total, path):
        print(done, flush=True)
    indexing.index(sys.argv[1], bundle=SmallBundle(), jobs=1, progress=report)
"""


@pytest.mark.slow
@pytest.mark.skipif(os.name == "nt", reason="kill -9")
def test_a_run_that_is_killed_loses_only_the_batch_in_flight(tmp_path, bundle):
    root = tmp_path / "takes"
    for seed in range(12):
        write(root / f"{seed:02}.npy", seed)
    process = subprocess.Popen(
        [sys.executable, "-c", textwrap.dedent(KILLED), str(root)],
        stdout=subprocess.PIPE,
        cwd=ROOT,
    )
    for line in process.stdout:
        if int(line) >= 6:  # read, of which all but the last two are stored
            process.send_signal(signal.SIGKILL)
            break
    process.wait()
    process.stdout.close()
    with StoredLibrary.open(root, bundle=bundle) as library:
        done = len(library)
        assert 4 <= done < 12
        for clip_id in library.ids():
            assert library.windows(clip_id)
            assert len(library.motion(clip_id)) == 80
    summary = index(root, bundle=bundle, jobs=1)
    assert (summary.indexed, summary.unchanged) == (12 - done, done)
