"""The vector indexes of a library are caught up with it at the cost of what changed."""

import shutil
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest

from encoders.motion import Motion
from indexer.ingest.arrays import NewClip, add, remove
from indexer.store.stored_library import StoredLibrary
from indexer.vectors import faiss_index, library_indexes
from indexer.vectors.clustered import ClusteredBlock
from indexer.vectors.index_files import build
from indexer.vectors.library_indexes import CLIPS, WINDOWS
from tests.indexer.folders import SmallBundle, moving


def clip(seed):
    return NewClip(f"clip {seed}", Motion(moving(seed).astype(np.float32)))


def current(library, kind):
    with library.reading() as connection:
        return library.indexes.current(kind, connection)


@pytest.mark.parametrize("kind", [CLIPS, WINDOWS], ids=lambda kind: kind.name)
def test_only_what_changed_is_read(tmp_path, kind):
    add(tmp_path, [clip(seed) for seed in range(8)], SmallBundle())
    with StoredLibrary.open(tmp_path) as library:
        generation = library.generation
        added = add(tmp_path, [clip(8), clip(0)], SmallBundle())
        remove(tmp_path, ["clip 3"])
        rows = library.indexes.since(kind, library.connection, generation)
        assert sorted(set(rows.owners.tolist())) == sorted(added)
        assert library.indexes.since(kind, library.connection, library.generation).owners.size == 0


@pytest.mark.parametrize("kind", [CLIPS, WINDOWS], ids=lambda kind: kind.name)
def test_an_index_caught_up_holds_what_a_new_one_does(tmp_path, kind):
    add(tmp_path, [clip(seed) for seed in range(8)], SmallBundle())
    with StoredLibrary.open(tmp_path) as caught_up:
        current(caught_up, kind)
        add(tmp_path, [clip(8), clip(0)], SmallBundle())
        remove(tmp_path, ["clip 3"])
        got = current(caught_up, kind).rows
    for path in (tmp_path / "vectors").glob("*/manifest.json"):
        path.unlink()
    with StoredLibrary.open(tmp_path) as fresh:
        want = current(fresh, kind).rows

    def by_row(rows):
        return sorted(zip(rows.owners.tolist(), map(tuple, rows.spans.tolist()), rows.vectors.tolist(), strict=True))

    assert by_row(got) == by_row(want)


@pytest.mark.parametrize("writable", [True, False], ids=["in pieces", "in memory"])
@pytest.mark.parametrize("serving", [False, True])
def test_an_index_of_very_many_is_built_caught_up_and_built_anew(tmp_path, monkeypatch, writable, serving):
    for module in (faiss_index, library_indexes):
        monkeypatch.setattr(module, "CLUSTERED_FROM", 20)
    monkeypatch.setattr(library_indexes, "_PIECE", 7)
    built = []

    def counting(*given, **how):
        if not writable:
            raise OSError(28, "No space left on device")
        built.append(1)
        return build(*given, **how)

    monkeypatch.setattr(library_indexes, "build", counting)
    add(tmp_path, [clip(seed) for seed in range(25)], SmallBundle())
    shutil.rmtree(tmp_path / "vectors", ignore_errors=True)
    with StoredLibrary.open(tmp_path) as library:
        for changed, anew in (([], 1), ([25], 0), ([*range(30, 60)], 1)):
            built.clear()
            if changed:
                add(tmp_path, [clip(seed) for seed in changed], SmallBundle())
            built.clear()
            with library.reading() as connection:
                index = library.indexes.current(WINDOWS, connection, serving=serving)
                want = library.indexes.since(WINDOWS, connection, -1)
            assert isinstance(index.main, ClusteredBlock)
            assert len(built) <= anew * writable
            assert sorted(map(bytes, index.rows.vectors)) == sorted(map(bytes, want.vectors))
            assert sorted(index.rows.owners.tolist()) == sorted(want.owners.tolist())


def test_a_file_that_another_reader_replaces_while_it_is_opened_costs_nothing(tmp_path, monkeypatch):
    numbers = add(tmp_path, [clip(seed) for seed in range(3)], SmallBundle())

    def replaced(*_):
        raise RuntimeError("could not open index.faiss for reading")

    monkeypatch.setattr("faiss.read_index", replaced)
    with StoredLibrary.open(tmp_path) as library:
        assert current(library, CLIPS).rows.owners.tolist() == numbers


def test_an_index_is_of_the_snapshot_that_is_read_not_of_what_another_thread_has_seen_since(tmp_path):
    before = add(tmp_path, [clip(seed) for seed in range(3)], SmallBundle())
    with StoredLibrary.open(tmp_path) as library, library.reading() as connection:
        assert len(library) == 3
        add(tmp_path, [clip(3)], SmallBundle())
        with ThreadPoolExecutor(1) as others:
            assert len(others.submit(current, library, CLIPS).result()) == 4
        assert library.indexes.current(CLIPS, connection).rows.owners.tolist() == before
    with StoredLibrary.open(tmp_path) as library:
        assert len(current(library, CLIPS)) == 4


def test_vectors_of_a_copy_that_went_on_elsewhere_are_not_taken_for_ones_own(tmp_path):
    here, copy = tmp_path / "here", tmp_path / "copy"
    add(here, [clip(0)], SmallBundle())
    shutil.copytree(here, copy)
    (theirs,) = add(copy, [clip(1)], SmallBundle())
    (ours,) = add(here, [clip(2)], SmallBundle())
    assert theirs == ours
    with StoredLibrary.open(copy) as library:
        theirs_vector = current(library, CLIPS).rows.vectors[-1].tolist()
        library.prepare()
    shutil.rmtree(here / "vectors", ignore_errors=True)
    shutil.copytree(copy / "vectors", here / "vectors")
    with StoredLibrary.open(here) as library:
        assert current(library, CLIPS).rows.vectors[-1].tolist() != theirs_vector
