"""Vector indexes on disk: they come back as they were, and are never believed."""

import os
import shutil
import time

import numpy as np
import pytest

from indexer.vectors import index_files
from indexer.vectors.faiss_index import FaissIndex
from indexer.vectors.index_files import load, save
from tests.indexer.vectors.test_faiss_index import SIZE, plainly, queries, rows


def origin_of(generation):
    return "model"


def test_a_file_gives_the_index_back(tmp_path):
    index = FaissIndex.of(7, rows(np.arange(1, 50))).update(8, remove=np.array([4]), add=rows([99, 4], seed=5))
    save(index, tmp_path, "clips", "model")
    found = load(tmp_path, "clips", origin_of, SIZE)
    assert found.generation == 8
    assert len(found) == len(index) == 50
    for got, want in zip(found.search(queries(3), 50), index.search(queries(3), 50), strict=True):
        np.testing.assert_array_equal(got, want)


def test_an_index_read_from_a_file_can_be_updated_and_saved_over(tmp_path):
    save(FaissIndex.of(1, rows(np.arange(100))), tmp_path, "clips", "model")
    index = load(tmp_path, "clips", origin_of, SIZE)
    changed = index.update(2, remove=np.arange(60), add=rows([500]))
    save(changed, tmp_path, "clips", "model")
    shutil.rmtree(next(tmp_path.glob("clips.1.*")))
    assert index.search(queries(1), 100)[1].min() == 0  # still mapped, though its file is gone
    assert set(load(tmp_path, "clips", origin_of, SIZE).search(queries(1), 41)[1][0]) == {*range(60, 100), 500}


@pytest.mark.parametrize(
    ("name", "origin", "size"), [("clips", "another model", SIZE), ("windows", "model", SIZE), ("clips", "model", 8)]
)
def test_a_file_of_another_origin_name_or_size_is_not_used(tmp_path, name, origin, size):
    save(FaissIndex.of(1, rows([1])), tmp_path, "clips", "model")
    assert load(tmp_path, name, lambda generation: origin, size) is None


def test_a_file_of_a_generation_that_the_library_has_not_been_through_is_not_used(tmp_path):
    for generation, origin in ((1, "of 1"), (2, "of 2"), (3, "of a copy's 3")):
        save(FaissIndex.of(generation, rows([generation])), tmp_path, "clips", origin)
    assert load(tmp_path, "clips", {1: "of 1", 2: "of 2", 3: "of 3"}.get, SIZE).generation == 2


@pytest.mark.parametrize("content", ["[]", "null", "7", '{"format": 2}', '{"format": 2, "checksums": [], "origin": 1}'])
def test_a_manifest_of_another_form_is_not_used(tmp_path, content):
    save(FaissIndex.of(1, rows([1])), tmp_path, "clips", "model")
    next(tmp_path.glob("*/manifest.json")).write_text(content)
    assert load(tmp_path, "clips", origin_of, SIZE) is None


@pytest.mark.parametrize("part", ["index.faiss", "owners.npy"])
def test_two_words_that_changed_places_are_damage(tmp_path, part):
    save(FaissIndex.of(1, rows(np.arange(300))), tmp_path, "clips", "model")
    path = next(tmp_path.glob(f"*/{part}"))
    data = bytearray(path.read_bytes())
    data[1024:1032], data[1032:1040] = data[1032:1040], data[1024:1032]
    path.write_bytes(data)
    assert load(tmp_path, "clips", origin_of, SIZE) is None


def test_a_file_that_vanishes_while_it_is_opened_is_looked_up_again(tmp_path, monkeypatch):
    save(FaissIndex.of(1, rows([1])), tmp_path, "clips", "model")
    (old,) = tmp_path.iterdir()
    real = index_files._load

    def replaced(path, *args, **options):
        if path == old:
            shutil.rmtree(old)
            save(FaissIndex.of(2, rows([2])), tmp_path, "clips", "model")
        return real(path, *args, **options)

    monkeypatch.setattr(index_files, "_load", replaced)
    assert load(tmp_path, "clips", origin_of, SIZE).generation == 2


def test_a_file_that_is_truncated_after_it_was_opened_harms_nobody_who_read_it(tmp_path):
    save(FaissIndex.of(1, rows(np.arange(5000))), tmp_path, "clips", "model")
    index = load(tmp_path, "clips", origin_of, SIZE, mapped=False)
    for path in tmp_path.glob("*/*"):
        os.truncate(path, 0)
    assert index.search(queries(1), 5000)[1].min() == 0


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
    found = load(tmp_path, "clips", origin_of, SIZE)
    assert found is None or part == "manifest.json"
    if found is not None:  # a manifest whose checksums still hold is a manifest
        np.testing.assert_array_equal(found.search(queries(1), 5)[1], plainly(rows(np.arange(300)), queries(1), 5)[1])


def test_what_a_crash_leaves_half_written_is_passed_over(tmp_path):
    save(FaissIndex.of(3, rows([1, 2])), tmp_path, "clips", "model")
    (sound,) = tmp_path.iterdir()
    shutil.copytree(sound, tmp_path / ".clips.abcd")
    shutil.copytree(sound, tmp_path / "clips.4.abcd")
    (tmp_path / "clips.4.abcd" / "owners.npy").unlink()
    (tmp_path / "clips.x.abcd").mkdir()
    (tmp_path / "clips.5.efgh").write_text("a file")
    assert load(tmp_path, "clips", origin_of, SIZE).generation == 3


def age(path, seconds):
    os.utime(path, (time.time() - seconds, time.time() - seconds))


def test_what_has_a_successor_goes_once_nobody_can_be_opening_it(tmp_path):
    for generation in (1, 2, 3):
        save(FaissIndex.of(generation, rows([1])), tmp_path, "clips", "model")
    assert len(list(tmp_path.iterdir())) == 3
    for generation, seconds in ((1, 900), (2, 600), (3, 30)):
        age(next(tmp_path.glob(f"clips.{generation}.*")), seconds)
    save(FaissIndex.of(4, rows([1])), tmp_path, "clips", "model")
    assert sorted(path.name.split(".")[1] for path in tmp_path.iterdir()) == ["2", "3", "4"]


def test_saving_clears_what_others_left_behind(tmp_path):
    save(FaissIndex.of(50, rows([1])), tmp_path, "clips", "a library that lay here before")
    age(next(tmp_path.iterdir()), 900)
    save(FaissIndex.of(3, rows([1])), tmp_path, "clips", "model")
    age(next(tmp_path.glob("clips.3.*")), 600)
    for name, seconds in ((".clips.dead", 90_000), (".clips.alive", 60)):
        (tmp_path / name).mkdir()
        age(tmp_path / name, seconds)
    save(FaissIndex.of(4, rows([1])), tmp_path, "clips", "model")
    assert load(tmp_path, "clips", origin_of, SIZE).generation == 4
    assert {path.name.rsplit(".", 1)[0] for path in tmp_path.iterdir()} == {"clips.4", "clips.3", ".clips"}
    assert not (tmp_path / ".clips.dead").exists()
