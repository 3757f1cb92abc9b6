"""What is damaged is named, and mended where it can be made again."""

import random
import shutil
import sqlite3
from contextlib import closing
from pathlib import Path

import numpy as np
import pytest

from indexer.ingest import indexing
from indexer.ingest.arrays import NewClip, add
from indexer.ingest.load import load_motion
from indexer.maintenance.check import check
from indexer.maintenance.repair import repair
from indexer.maintenance.salvage import DAMAGED
from indexer.store import schema
from indexer.store.library_reader import FILE, FOLDER
from indexer.store.stored_library import StoredLibrary
from tests.indexer.folders import SmallBundle, moving, write


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    """An indexed folder of eight clips with captions."""
    folder = tmp_path_factory.mktemp("made") / "takes"
    for seed in range(8):
        write(folder / f"take {seed}.npy", seed, seconds=12.0 if seed == 3 else 4.0)
    (folder / "take 1.txt").write_text("a person walks\n")
    (folder / "captions.csv").write_text("path,text\ntake 2.npy,someone runs\ntake 3.npy,a person walks\n")
    indexing.index(folder, bundle=SmallBundle(), jobs=2)
    return folder


@pytest.fixture
def folder(made, tmp_path):
    return Path(shutil.copytree(made, tmp_path / "takes"))


def change(folder, statement, *values):
    with sqlite3.connect(folder / FOLDER / FILE) as connection:
        count = connection.execute(statement, values).rowcount
    connection.close()
    return count


def answers(folder):
    """What a user sees: the clips found for some vectors, how near the best windows are, captions and poses."""
    rng = np.random.default_rng(1)
    queries = rng.standard_normal((3, 16)).astype(np.float32)
    queries /= np.linalg.norm(queries, axis=1, keepdims=True)
    with StoredLibrary.open(folder) as library:
        clips = {clip.id: clip for clip in library.clips()}
        nearest = [clips[row[0]].path for row in library.nearest_clips(queries, 1)[1].tolist()]
        best = library.nearest_windows(queries, 5)[0].round(2).tolist()  # of windows alike, any may come first
        content = [(c.path, library.captions(c.id), library.motion(c.id).joints.tobytes()) for c in clips.values()]
        return nearest, best, sorted(content, key=str)


def test_a_sound_library_has_no_faults(folder):
    found = check(folder / FOLDER, sources=True)
    assert (found.faults, found.unchecked) == ([], 0)


DAMAGES = {
    "vectors": ("UPDATE embeddings SET vector = zeroblob(32) WHERE clip_id = 2", "its vectors"),
    "windows": ("UPDATE windows SET starts = vectors WHERE clip_id = 2", "its vectors"),
    "missing windows": ("DELETE FROM windows WHERE clip_id = 2", "its vectors"),
    "poses": ("UPDATE poses SET data = zeroblob(50) WHERE clip_id = 4 AND chunk = 0", "its stored poses"),
    "missing poses": ("DELETE FROM poses WHERE clip_id = 4 AND chunk = 1", "its stored poses"),
    "a clip": ("UPDATE clips SET frames = frames - 1, duration = 1 WHERE id = 2", "its stored poses"),
    "a missing clip": ("DELETE FROM clips WHERE id = 4", "belongs to a row of clips that is not there"),
    "a path": ("UPDATE files SET path = 'take X.npy' WHERE id = 2", "files"),
    "a text": ("UPDATE texts SET text = 'a person talks' WHERE text = 'a person walks'", "texts"),
    "a text's vector": ("UPDATE text_embeddings SET vector = zeroblob(32)", "text_embeddings"),
    "a caption": ("UPDATE captions SET text_id = 2 WHERE text_id = 1", "captions"),
    "a side file": ("UPDATE side_files SET hash = 'f00'", "side_files"),
    "the model": ("UPDATE models SET fingerprint = 'f00'", "models"),
}


@pytest.mark.parametrize(("statement", "named"), DAMAGES.values(), ids=DAMAGES.keys())
def test_what_was_not_written_is_named_and_made_again(folder, statement, named):
    expected = answers(folder)
    assert change(folder, statement)
    faults = check(folder / FOLDER).faults
    assert any(named in fault.problem for fault in faults), faults
    assert repair(folder / FOLDER, SmallBundle()) == []
    assert answers(folder) == expected


def test_a_trigger_of_other_text_is_named_and_made_again(folder):
    expected = answers(folder)
    with sqlite3.connect(folder / FOLDER / FILE) as connection:
        connection.execute("PRAGMA writable_schema = ON")
        texts = ("'delete'", "'dulete'")
        connection.execute("UPDATE sqlite_master SET sql = replace(sql, ?, ?) WHERE name = 'clips_au'", texts)
    connection.close()
    assert any("triggers" in fault.problem for fault in check(folder / FOLDER).faults)
    assert repair(folder / FOLDER, SmallBundle()) == []
    assert answers(folder) == expected
    write(folder / "take 1.npy", 55)
    assert indexing.index(folder, bundle=SmallBundle(), jobs=1).indexed == 1


def test_a_clip_whose_poses_cannot_be_read_again_is_named(folder):
    with StoredLibrary.open(folder) as library:
        clip = library.find("take 5.npy").id
    change(folder, "UPDATE poses SET data = zeroblob(9) WHERE clip_id = ?", clip)
    add(folder / FOLDER, [NewClip("an array", moving(90).astype(np.float32))], SmallBundle())
    change(folder, "UPDATE poses SET data = zeroblob(9) WHERE clip_id = (SELECT max(id) FROM clips)")
    left = repair(folder / FOLDER, SmallBundle())
    assert [fault.what for fault in left] == ["an array"]
    with StoredLibrary.open(folder) as library:
        assert library.find("take 5.npy").id == clip
        np.testing.assert_allclose(library.motion(clip).joints, load_motion(folder / "take 5.npy").joints, atol=2e-4)


def test_vector_files_of_other_content_are_made_again(folder):
    with StoredLibrary.open(folder) as library:
        library.prepare()
    change(folder, "UPDATE embeddings SET vector = (SELECT vector FROM embeddings WHERE clip_id = 1)")
    found = check(folder / FOLDER)
    assert found.indexes
    assert repair(folder / FOLDER, SmallBundle()) == []


def test_sources_that_changed_or_went_are_named(folder):
    write(folder / "take 1.npy", 77)
    (folder / "take 2.npy").unlink()
    problems = dict(check(folder / FOLDER, sources=True).faults)
    assert problems == {"take 1.npy": "has changed since it was indexed", "take 2.npy": "is gone"}
    assert check(folder / FOLDER).faults == []


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(30))
def test_a_flipped_byte_anywhere_is_harmless_or_named_and_mended(folder, seed):
    rng = random.Random(seed)
    expected = answers(folder)
    files = sorted(path for path in (folder / FOLDER).rglob("*") if path.is_file() and path.stat().st_size)
    path = rng.choice([file for file in files if file.name == FILE] * 3 + files)
    data = bytearray(path.read_bytes())
    for _ in range(rng.choice((1, 1, 4))):
        data[rng.randrange(len(data))] ^= 1 << rng.randrange(8)
    path.write_bytes(data)
    if not check(folder / FOLDER).faults:
        assert answers(folder) == expected
    else:
        assert repair(folder / FOLDER, SmallBundle()) == []
        assert answers(folder) == expected


@pytest.mark.parametrize("share", [(0.0, 0.02), (0.3, 0.6), (0.9, 1.0)])
def test_a_database_that_cannot_be_read_to_its_end_is_replaced(folder, share):
    expected = answers(folder)
    file = folder / FOLDER / FILE
    data = bytearray(file.read_bytes())
    first, last = (int(len(data) * part) // 4096 * 4096 for part in share)
    data[first:last] = bytes(last - first)
    file.write_bytes(data)
    assert check(folder / FOLDER).database
    assert repair(folder / FOLDER, SmallBundle()) == []
    assert answers(folder) == expected
    assert (folder / FOLDER / DAMAGED).read_bytes() == bytes(data)


@pytest.mark.parametrize("damage", ["a caption", "pages"])
def test_a_repair_that_was_cut_off_is_named_and_finished_by_the_next(folder, monkeypatch, damage):
    expected = answers(folder)
    if damage == "pages":
        (folder / FOLDER / FILE).write_bytes(b"nothing that is left" * 1000)
    else:
        change(folder, DAMAGES[damage][0])
    monkeypatch.setattr(indexing, "index", lambda *_, **__: (_ for _ in ()).throw(KeyboardInterrupt))
    with pytest.raises(KeyboardInterrupt):
        repair(folder / FOLDER, SmallBundle())
    monkeypatch.undo()
    assert any("cut off" in fault.problem for fault in check(folder / FOLDER).faults)
    assert repair(folder / FOLDER, SmallBundle()) == []
    assert answers(folder) == expected


@pytest.mark.parametrize("version", range(1, len(schema.MIGRATIONS)))
def test_a_library_of_an_earlier_version_is_not_damaged(tmp_path, monkeypatch, version):
    with monkeypatch.context() as earlier, closing(sqlite3.connect(tmp_path / FILE, isolation_level=None)) as database:
        earlier.setattr(schema, "MIGRATIONS", schema.MIGRATIONS[:version])
        schema.migrate(database)
    assert check(tmp_path).faults == []
