"""What passes by itself is tried again; what changes while it is read is read again; one entry stops nothing."""

import errno
import os
import signal
from pathlib import Path

import numpy as np
import pytest

from encoders.errors import LibraryError
from indexer.formats import opening
from indexer.ingest import pool, storing
from indexer.ingest.indexing import index
from indexer.ingest.pool import Read
from indexer.store.stored_library import StoredLibrary
from tests.indexer.folders import SmallBundle, write

READ = "tests.indexer.ingest.test_temporary_failures:read"


@pytest.fixture
def bundle():
    return SmallBundle()


@pytest.fixture
def root(tmp_path):
    folder = tmp_path / "takes"
    for seed, name in enumerate(["a.npy", "b.npy", "day/c.npy"], start=1):
        write(folder / name, seed)
    return folder


def counts(summary):
    return summary.indexed, summary.unchanged, summary.moved, summary.gone, len(summary.failed)


def paths(root):
    with StoredLibrary.open(root) as library:
        return {clip.path: clip.id for clip in library.clips()}


def read(path, **options):
    """Stands in for reading in a worker: what a file called `a` does stands in a file beside the folder."""
    from indexer.ingest.load import read_motions

    how = Path(path).parent.parent / "how"
    if how.exists() and Path(path).stem == "a":
        if how.read_text() == "hang":
            signal.pause()
        if how.read_text() == "kill":
            os.kill(os.getpid(), signal.SIGKILL)
        if how.read_text() == "eio":
            raise OSError(errno.EIO, "Input/output error")
        os.kill(os.getpid(), signal.SIGSEGV)
    return read_motions(path, **options)


@pytest.fixture
def how(root, monkeypatch):
    """What happens to the process that reads `a`."""

    def read_all(requests, jobs):
        return pool.read_all(requests, jobs, patience=1.0, target=READ)

    monkeypatch.setattr(storing, "read_all", read_all)

    def tell(what):
        (root.parent / "how").write_text(what) if what else (root.parent / "how").unlink()

    return tell


@pytest.mark.skipif(os.name == "nt", reason="signals")
@pytest.mark.parametrize(
    ("what", "reason"),
    [("kill", "reading it was killed"), ("hang", "reading took more than 1 s"), ("eio", "Input/output error")],
)
def test_what_does_not_lie_in_the_file_is_tried_again_at_the_next_run(root, bundle, how, what, reason):
    how(what)
    for _ in range(2):
        summary = index(root, bundle=bundle, jobs=1)
        assert len(summary.failed) == 1
        assert reason in summary.failed[0][1]
        assert summary.failed[0][1].endswith("; it is tried again at the next run")
        assert summary.failed_before == 0
    how("")
    assert counts(index(root, bundle=bundle, jobs=1)) == (1, 2, 0, 0, 0)


@pytest.mark.skipif(os.name == "nt", reason="signals")
def test_what_crashes_twice_with_one_content_is_remembered(root, bundle, how):
    index(root, bundle=bundle, jobs=1)
    number = paths(root)["a.npy"]
    write(root / "a.npy", 70)
    how("crash")
    for content in (71, 72):  # another content is tried anew
        write(root / "a.npy", content)
        summary = index(root, bundle=bundle, jobs=1)
        assert summary.failed[0][1] == "reading it crashed (SIGSEGV); it is tried again at the next run"
        assert paths(root)["a.npy"] == number
    assert index(root, bundle=bundle, jobs=1).failed[0][1] == "reading it crashed (SIGSEGV)"
    assert "a.npy" not in paths(root)
    assert index(root, bundle=bundle, jobs=1).failed_before == 1
    assert index(root, bundle=bundle, jobs=1, retry=True).failed[0][1] == "reading it crashed (SIGSEGV)"
    how("")
    assert counts(index(root, bundle=bundle, jobs=1, retry=True)) == (1, 2, 0, 0, 0)


@pytest.mark.skipif(os.name == "nt", reason="signals")
@pytest.mark.parametrize("known", [False, True])
def test_what_crashes_once_is_read_at_the_next_run(root, bundle, how, known):
    if known:
        index(root, bundle=bundle, jobs=1)
    how("crash")
    assert len(index(root, bundle=bundle, jobs=1, fps=30, retry=True).failed) == 1
    how("")
    assert counts(index(root, bundle=bundle, jobs=1)) == (1, 2, 0, 0, 0)
    assert counts(index(root, bundle=bundle, jobs=1)) == (0, 3, 0, 0, 0)
    with StoredLibrary.open(root) as library:
        assert library.failures() == []


@pytest.mark.parametrize("reason", ["too much memory", "no body"])
def test_what_lies_in_the_file_is_remembered(root, bundle, monkeypatch, reason):
    monkeypatch.setattr(storing, "read_all", lambda requests, jobs: ((r.key, Read(reason=reason)) for r in requests))
    assert len(index(root, bundle=bundle, jobs=1).failed) == 3
    assert index(root, bundle=bundle, jobs=1).failed_before == 3


@pytest.mark.parametrize("error", [PermissionError(13, "Permission denied"), OSError(errno.EIO, "Input/output error")])
def test_a_file_that_cannot_be_opened_for_a_while_keeps_its_clip(root, bundle, monkeypatch, error):
    index(root, bundle=bundle, jobs=1)
    before = paths(root)
    os.utime(root / "a.npy", (1, 1))

    def refuse(path):
        if path.name == "a.npy":
            raise error
        return open_file(path)

    open_file = opening.open_file
    monkeypatch.setattr("indexer.store.files.open_file", refuse)
    summary = index(root, bundle=bundle, jobs=1)
    assert counts(summary) == (0, 2, 0, 0, 1)
    assert paths(root) == before
    monkeypatch.undo()
    assert counts(index(root, bundle=bundle, jobs=1)) == (0, 3, 0, 0, 0)


def test_an_unlisted_folder_keeps_its_clips_though_a_copy_lies_elsewhere(root, bundle, monkeypatch):
    index(root, bundle=bundle, jobs=1)
    number = paths(root)["day/c.npy"]
    (root / "copy.npy").write_bytes((root / "day" / "c.npy").read_bytes())
    scandir = os.scandir

    def refuse(path):
        if str(path).endswith("day"):
            raise PermissionError(13, "Permission denied")
        return scandir(path)

    monkeypatch.setattr(os, "scandir", refuse)
    assert counts(index(root, bundle=bundle, jobs=1)) == (1, 2, 0, 0, 1)
    assert paths(root)["day/c.npy"] == number
    monkeypatch.undo()
    assert counts(index(root, bundle=bundle, jobs=1)) == (0, 4, 0, 0, 0)


def test_a_link_that_leads_nowhere_for_a_while_keeps_its_clip(root, bundle):
    (root / ".store").mkdir()
    (root / "a.npy").rename(root / ".store" / "x")
    (root / "a.npy").symlink_to(".store/x")
    assert index(root, bundle=bundle, jobs=1).indexed == 3
    number = paths(root)["a.npy"]
    (root / ".store" / "x").rename(root / "copy.npy")
    summary = index(root, bundle=bundle, jobs=1)
    assert (counts(summary), len(summary.warnings)) == ((1, 2, 0, 0, 0), 1)
    assert paths(root)["a.npy"] == number


@pytest.mark.parametrize("kind", ["missing", "unlistable"])
def test_one_root_that_cannot_be_read_stops_no_other(root, bundle, tmp_path, monkeypatch, kind):
    other = write(tmp_path / "other" / "o.npy", 9).parent
    library = tmp_path / "lib"
    assert index([root, other], library=library, bundle=bundle, jobs=1).indexed == 4
    write(other / "new.npy", 10)
    if kind == "missing":
        root.rename(tmp_path / "away")
    else:
        scandir = os.scandir

        def refuse(path):
            if path == root:
                raise PermissionError(13, "Permission denied")
            return scandir(path)

        monkeypatch.setattr(os, "scandir", refuse)
    summary = index([root, other], library=library, bundle=bundle, jobs=1)
    assert counts(summary) == (1, 1, 0, 0, 1)
    assert summary.failed[0][0] == str(root)
    assert len(paths(library)) == 5
    with pytest.raises(LibraryError):
        index(root, library=library, bundle=bundle, jobs=1)


def test_a_root_that_is_away_loses_no_clip_to_a_copy_in_another(root, bundle, tmp_path):
    other = write(tmp_path / "other" / "o.npy", 9).parent
    library = tmp_path / "lib"
    index([root, other], library=library, bundle=bundle, jobs=1)
    (other / "copy.npy").write_bytes((root / "a.npy").read_bytes())
    root.rename(tmp_path / "away")
    assert counts(index(other, library=library, bundle=bundle, jobs=1)) == (1, 1, 0, 0, 0)
    assert "a.npy" in paths(library)


class Meddling:
    """Reading during which somebody writes the files; `times` says how often."""

    def __init__(self, meddle, times=1):
        self.meddle, self.times, self.read = meddle, times, []

    def __call__(self, requests, jobs):
        for request in requests:
            self.read.append(request.path.name)
            if len(self.read) <= self.times:
                self.meddle(request.path)
            yield from pool.read_all([request], 1)


def replaced_and_put_back(path):
    """Another content for as long as it is read; what is seen of the file afterwards is as before."""
    before, content = path.stat(), path.read_bytes()
    write(path, 77, seconds=4)
    time = before.st_atime_ns, before.st_mtime_ns
    assert path.stat().st_size == before.st_size
    os.utime(path, ns=time)
    path.write_bytes(content)
    os.utime(path, ns=time)


@pytest.mark.parametrize("meddle", [lambda path: write(path, 50, seconds=5), replaced_and_put_back])
def test_what_was_written_while_it_was_read_is_read_again(tmp_path, bundle, monkeypatch, meddle):
    path = write(tmp_path / "takes" / "a.npy", 1)
    reading = Meddling(meddle)
    monkeypatch.setattr(storing, "read_all", reading)
    assert counts(index(path.parent, bundle=bundle, jobs=1)) == (1, 0, 0, 0, 0)
    assert reading.read == ["a.npy", "a.npy"]
    with StoredLibrary.open(path.parent, bundle=bundle) as library:
        assert np.abs(library.motion(1).joints - np.load(path)).max() < 1e-3
    assert counts(index(path.parent, bundle=bundle, jobs=1)) == (0, 1, 0, 0, 0)


def test_what_changes_each_time_is_left_for_the_next_run(tmp_path, bundle, monkeypatch):
    path = write(tmp_path / "takes" / "a.npy", 1)
    write(tmp_path / "takes" / "b.npy", 2)
    reading = Meddling(lambda path: path.name == "a.npy" and write(path, 50 + len(reading.read)), times=99)
    monkeypatch.setattr(storing, "read_all", reading)
    summary = index(path.parent, bundle=bundle, jobs=1)
    assert counts(summary) == (1, 0, 0, 0, 1)
    assert summary.failed[0][1] == "it changes while it is read; it is tried again at the next run"
    assert reading.read.count("a.npy") == 3
    reading.times = 0
    assert counts(index(path.parent, bundle=bundle, jobs=1)) == (1, 1, 0, 0, 0)


def test_a_half_written_file_is_not_remembered_as_broken(tmp_path, bundle, monkeypatch):
    path = write(tmp_path / "takes" / "a.npy", 1)
    whole = path.read_bytes()
    path.write_bytes(whole[:5000])
    finished = Meddling(lambda path: None)

    def first(requests, jobs):
        monkeypatch.setattr(storing, "read_all", finished)
        for request in requests:
            path.write_bytes(whole)
            yield request.key, Read(reason="it is cut short")

    monkeypatch.setattr(storing, "read_all", first)
    assert counts(index(path.parent, bundle=bundle, jobs=1)) == (1, 0, 0, 0, 0)


def test_a_file_that_vanishes_while_it_is_read_is_no_clip(tmp_path, bundle, monkeypatch):
    path = write(tmp_path / "takes" / "a.npy", 1)
    write(tmp_path / "takes" / "b.npy", 2)
    monkeypatch.setattr(storing, "read_all", Meddling(lambda path: path.unlink()))
    assert index(path.parent, bundle=bundle, jobs=1).indexed == 1
    assert set(paths(path.parent)) == {"b.npy"}
    assert counts(index(path.parent, bundle=bundle, jobs=1)) == (0, 1, 0, 0, 0)


def test_a_skeleton_that_changes_while_its_motion_is_read_counts(tmp_path, bundle, monkeypatch):
    root = tmp_path / "takes"
    root.mkdir()
    (root / "s.asf").write_text("skeleton")
    (root / "s_01.amc").write_text("motion")
    seen = []

    def read_all(requests, jobs):
        for request in requests:
            seen.append(request.key.source.hash)
            if len(seen) == 1:
                (root / "s.asf").write_text("another")
            yield request.key, Read(reason="no motion")

    monkeypatch.setattr(storing, "read_all", read_all)
    index(root, bundle=bundle, jobs=1)
    assert len(set(seen)) == len(seen) == 2


def test_a_time_after_2262_is_a_time(root, bundle):
    try:
        os.utime(root / "a.npy", (13_569_465_600, 13_569_465_600))
    except OverflowError:
        pytest.skip("no such time here")
    assert counts(index(root, bundle=bundle, jobs=1)) == (3, 0, 0, 0, 0)
    assert counts(index(root, bundle=bundle, jobs=1)) == (0, 3, 0, 0, 0)
