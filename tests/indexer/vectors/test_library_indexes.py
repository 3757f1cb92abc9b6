"""The vector indexes of a library are caught up with it at the cost of what changed."""

import numpy as np
import pytest

from encoders.motion import Motion
from indexer.ingest.arrays import NewClip, add, remove
from indexer.store.stored_library import StoredLibrary
from indexer.vectors.library_indexes import CLIPS, WINDOWS
from tests.indexer.folders import SmallBundle, moving


def clip(seed):
    return NewClip(f"clip {seed}", Motion(moving(seed).astype(np.float32)))


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
        caught_up.indexes.current(kind, caught_up.connection)
        add(tmp_path, [clip(8), clip(0)], SmallBundle())
        remove(tmp_path, ["clip 3"])
        got = caught_up.indexes.current(kind, caught_up.connection).rows
    for path in (tmp_path / "vectors").glob("*/manifest.json"):
        path.unlink()
    with StoredLibrary.open(tmp_path) as fresh:
        want = fresh.indexes.current(kind, fresh.connection).rows

    def by_row(rows):
        return sorted(zip(rows.owners.tolist(), map(tuple, rows.spans.tolist()), rows.vectors.tolist(), strict=True))

    assert by_row(got) == by_row(want)


def test_a_file_that_another_reader_replaces_while_it_is_opened_costs_nothing(tmp_path, monkeypatch):
    numbers = add(tmp_path, [clip(seed) for seed in range(3)], SmallBundle())

    def replaced(*_):
        raise RuntimeError("could not open index.faiss for reading")

    monkeypatch.setattr("faiss.read_index", replaced)
    with StoredLibrary.open(tmp_path) as library:
        assert library.indexes.current(CLIPS, library.connection).rows.owners.tolist() == numbers
