"""Vector indexes on disk: they come back as they were, and are never believed."""

import os
import shutil

import numpy as np
import pytest

from indexer.vectors.faiss_index import FaissIndex
from indexer.vectors.index_files import load, save
from tests.indexer.vectors.test_faiss_index import SIZE, plainly, queries, rows


def test_a_file_gives_the_index_back(tmp_path):
    index = FaissIndex.of(7, rows(np.arange(1, 50))).update(8, remove=np.array([4]), add=rows([99, 4], seed=5))
    save(index, tmp_path, "clips", "model")
    found = load(tmp_path, "clips", "model", SIZE)
    assert found.generation == 8
    assert len(found) == len(index) == 50
    for got, want in zip(found.search(queries(3), 50), index.search(queries(3), 50), strict=True):
        np.testing.assert_array_equal(got, want)


def test_an_index_read_from_a_file_can_be_updated_and_saved_over(tmp_path):
    save(FaissIndex.of(1, rows(np.arange(100))), tmp_path, "clips", "model")
    index = load(tmp_path, "clips", "model", SIZE)
    changed = index.update(2, remove=np.arange(60), add=rows([500]))
    save(changed, tmp_path, "clips", "model")
    assert len(list(tmp_path.iterdir())) == 1
    assert index.search(queries(1), 100)[1].min() == 0  # still mapped, though its file is gone
    assert set(load(tmp_path, "clips", "model", SIZE).search(queries(1), 41)[1][0]) == {*range(60, 100), 500}


@pytest.mark.parametrize("other", [("clips", "another model", SIZE), ("windows", "model", SIZE), ("clips", "model", 8)])
def test_a_file_of_another_model_name_or_size_is_not_used(tmp_path, other):
    save(FaissIndex.of(1, rows([1])), tmp_path, "clips", "model")
    assert load(tmp_path, *other) is None


def flip(path):
    data = bytearray(path.read_bytes())
    data[len(data) // 2] ^= 1
    path.write_bytes(data)


DAMAGES = {
    "flipped bit": flip,
    "truncated": lambda path: os.truncate(path, path.stat().st_size // 2),
    "emptied": lambda path: path.write_bytes(b""),
    "missing": lambda path: path.unlink(),
    "replaced": lambda path: path.write_bytes(b"\x80\x04garbage" * 99),
}


@pytest.mark.parametrize("part", ["index.faiss", "owners.npy", "spans.npy", "manifest.json"])
@pytest.mark.parametrize("damage", DAMAGES.values(), ids=DAMAGES.keys())
def test_a_damaged_file_is_not_used(tmp_path, part, damage):
    save(FaissIndex.of(1, rows(np.arange(300))), tmp_path, "clips", "model")
    (folder,) = tmp_path.iterdir()
    damage(folder / part)
    found = load(tmp_path, "clips", "model", SIZE)
    assert found is None or part == "manifest.json"
    if found is not None:  # a manifest whose digests still hold is a manifest
        np.testing.assert_array_equal(found.search(queries(1), 5)[1], plainly(rows(np.arange(300)), queries(1), 5)[1])


def test_what_a_crash_leaves_half_written_is_passed_over(tmp_path):
    save(FaissIndex.of(3, rows([1, 2])), tmp_path, "clips", "model")
    (sound,) = tmp_path.iterdir()
    shutil.copytree(sound, tmp_path / ".clips.abcd")
    shutil.copytree(sound, tmp_path / "clips.4.abcd")
    (tmp_path / "clips.4.abcd" / "owners.npy").unlink()
    (tmp_path / "clips.x.abcd").mkdir()
    (tmp_path / "clips.5.efgh").write_text("a file")
    assert load(tmp_path, "clips", "model", SIZE).generation == 3


def test_saving_clears_what_others_left_behind(tmp_path):
    save(FaissIndex.of(50, rows([1])), tmp_path, "clips", "a library that lay here before")
    (tmp_path / ".clips.dead").mkdir()
    os.utime(tmp_path / ".clips.dead", (1, 1))
    (tmp_path / ".clips.alive").mkdir()
    save(FaissIndex.of(3, rows([1])), tmp_path, "clips", "model")
    assert load(tmp_path, "clips", "model", SIZE).generation == 3
    assert {path.name for path in tmp_path.iterdir() if not path.name.startswith("clips.3.")} == {".clips.alive"}
