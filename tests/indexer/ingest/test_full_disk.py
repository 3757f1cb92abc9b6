"""A full disk: one line that names the file, nothing that was committed is lost, and the next run goes on."""

import errno
import sqlite3

import numpy as np
import pytest

import motionseek
from encoders.errors import LibraryDamaged, LibraryError
from indexer.ingest import storing
from indexer.ingest.indexing import index
from indexer.store import schema
from indexer.store.library_reader import FILE, FOLDER
from indexer.store.stored_library import StoredLibrary
from indexer.vectors import library_indexes
from tests.indexer.folders import SmallBundle, write

FILES = 9


@pytest.fixture
def bundle():
    return SmallBundle()


@pytest.fixture
def root(tmp_path):
    for seed in range(FILES):
        write(tmp_path / "takes" / f"{seed}.npy", seed, seconds=30)
    return tmp_path / "takes"


@pytest.fixture
def room(monkeypatch):
    """How many pages of the library the disk has room for."""
    connect = schema.connect

    def limit(pages):
        def limited(path, *, writable):
            connection = connect(path, writable=writable)
            connection.execute(f"PRAGMA max_page_count={pages}")
            return connection

        monkeypatch.setattr(schema, "connect", limited)

    return limit


@pytest.mark.parametrize("pages", [1, 5, 20, 44, 48, 56, 64, 72])
def test_a_run_that_meets_a_full_disk_names_the_file_and_the_next_one_goes_on(root, bundle, room, monkeypatch, pages):
    monkeypatch.setattr(storing, "_BATCH_FILES", 2)
    room(pages)
    with pytest.raises(LibraryError) as error:
        index(root, bundle=bundle, jobs=1)
    assert str(error.value) == (
        f"{root / FOLDER / FILE}: the disk is full; make room, and run 'motionseek index' again: "
        "what was committed is kept"
    )
    with sqlite3.connect(root / FOLDER / FILE) as db:
        assert db.execute("PRAGMA integrity_check").fetchone() == ("ok",)
    room(10_000)
    summary = index(root, bundle=bundle, jobs=1)
    assert summary.indexed + summary.unchanged == FILES
    assert len(StoredLibrary.open(root, bundle=bundle)) == FILES


def test_search_answers_from_memory_where_vectors_cannot_be_written(root, bundle, monkeypatch):
    def full(*_, **__):
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr(library_indexes, "save", full)
    (warning,) = index(root, bundle=bundle, jobs=1).warnings
    assert "vectors: cannot be written (No space left on device)" in warning
    with motionseek.open(root, bundle=bundle) as library:
        there = library.nearest_clips(bundle.encode_texts(["a person walks"]), FILES)[1].tolist()
    assert not list((root / FOLDER / "vectors").glob("*.*"))
    monkeypatch.undo()
    assert index(root, bundle=bundle, jobs=1).warnings == []
    with motionseek.open(root, bundle=bundle) as library:
        assert library.nearest_clips(bundle.encode_texts(["a person walks"]), FILES)[1].tolist() == there


def test_a_library_that_was_only_begun_says_so_and_the_next_run_finishes_it(root, bundle):
    (root / FOLDER).mkdir()
    (root / FOLDER / FILE).touch()
    for use in (lambda: motionseek.open(root, bundle=bundle), lambda: StoredLibrary.open(root).stats()):
        with pytest.raises(LibraryDamaged, match=r"not finished: .*; run 'motionseek index' again"):
            use()
    assert index(root, bundle=bundle, jobs=1).indexed == FILES
    with StoredLibrary.open(root, bundle=bundle) as library:
        assert np.isfinite(library.motion(1).joints).all()
