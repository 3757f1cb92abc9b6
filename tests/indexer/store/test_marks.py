"""Stars, tags and collections stay with their clips, whatever becomes of files and database."""

import json
import shutil
import sqlite3
from pathlib import Path

import pytest

from indexer.ingest import indexing
from indexer.ingest.arrays import NewClip, add, remove
from indexer.maintenance.check import check
from indexer.maintenance.forget import forget
from indexer.maintenance.repair import repair
from indexer.store.library_reader import FILE, FOLDER
from indexer.store.marks import marks_file, marks_table
from indexer.store.marks.marks_table import COLLECTION, STAR, TAG, Marks
from indexer.store.stored_library import StoredLibrary
from indexer.store.writer import writing
from tests.indexer.folders import SmallBundle, moving, write

FIGHT = Marks(True, ("fast", "fight"), ("reel",))


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    """Three takes, of which the first is starred, tagged and collected, and the second tagged."""
    folder = tmp_path_factory.mktemp("made") / "takes"
    for seed in range(3):
        write(folder / f"take {seed}.npy", seed)
    indexing.index(folder, bundle=SmallBundle(), jobs=1)
    with writing(folder / FOLDER) as writer, writer.batch():
        for kind, name in ((STAR, ""), (TAG, "fight"), (TAG, "fast"), (COLLECTION, "reel")):
            marks_table.add(writer.connection, [1], kind, name)
        marks_table.add(writer.connection, [2], TAG, "Fight")
    return folder


@pytest.fixture
def folder(made, tmp_path):
    return Path(shutil.copytree(made, tmp_path / "takes"))


def again(folder, **options):
    indexing.index(folder, bundle=SmallBundle(), jobs=1, **options)


def marks(folder):
    """The marks of each clip that has some, by its path."""
    with StoredLibrary.open(folder) as library:
        found = {clip.path: library.marks(clip.id) for clip in library.clips()}
    return {path: of_clip for path, of_clip in found.items() if of_clip != Marks()}


def change(folder, statement, *values):
    with sqlite3.connect(folder / FOLDER / FILE) as connection:
        assert connection.execute(statement, values).rowcount
    connection.close()


def test_a_name_in_other_case_is_the_one_that_is_there(folder):
    assert marks(folder) == {"take 0.npy": FIGHT, "take 1.npy": Marks(tags=("fight",))}
    with writing(folder / FOLDER) as writer, writer.batch():
        marks_table.remove(writer.connection, [2], TAG, "FIGHT")
    assert marks(folder) == {"take 0.npy": FIGHT}


def moved(folder):
    (folder / "deep").mkdir()
    (folder / "take 0.npy").rename(folder / "deep" / "other name.npy")
    again(folder)
    return "deep/other name.npy"


def vanished_and_back(folder):
    (folder / "take 0.npy").rename(folder.parent / "away.npy")
    again(folder)
    assert "take 0.npy" not in marks(folder)
    shutil.move(folder.parent / "away.npy", folder / "take 0.npy")
    again(folder)


def unreadable_for_a_while(folder):
    content = (folder / "take 0.npy").read_bytes()
    (folder / "take 0.npy").write_bytes(b"nothing")
    again(folder)
    (folder / "take 0.npy").write_bytes(content + b"\0")  # not the old content, else the old clip is back
    again(folder)


def damaged_rows(folder):
    change(folder, "UPDATE marks SET name = 'fright' WHERE name = 'fight'")
    change(folder, "DELETE FROM marks WHERE kind = 'star'")
    assert any("marks" in fault.problem for fault in check(folder / FOLDER).faults)
    assert repair(folder / FOLDER, SmallBundle()) == []


def lost_clip(folder):
    change(folder, "DELETE FROM clips WHERE id = 1")
    assert check(folder / FOLDER).database
    assert repair(folder / FOLDER, SmallBundle()) == []


def lost_database(folder):
    (folder / FOLDER / FILE).write_bytes(b"nothing that is left" * 1000)
    assert repair(folder / FOLDER, SmallBundle()) == []


def deleted_database(folder):
    for path in (folder / FOLDER).glob(f"{FILE}*"):
        path.unlink()
    again(folder)


def damaged_file(folder):
    content = (folder / FOLDER / marks_file.FILE).read_bytes()
    (folder / FOLDER / marks_file.FILE).write_bytes(content.replace(b"fast", b"last"))
    assert [fault.what for fault in check(folder / FOLDER).faults] == [marks_file.FILE]
    assert repair(folder / FOLDER, SmallBundle()) == []
    assert (folder / FOLDER / marks_file.FILE).read_bytes() == content


def killed_before_the_file_was_written(folder):
    (folder / FOLDER / marks_file.FILE).unlink()
    assert check(folder / FOLDER).faults == []
    again(folder)
    assert (folder / FOLDER / marks_file.FILE).exists()


EVENTS = [
    moved, vanished_and_back, unreadable_for_a_while, damaged_rows, lost_clip, lost_database, deleted_database,
    damaged_file, killed_before_the_file_was_written, lambda folder: again(folder, rebuild=True),
]  # fmt: skip


@pytest.mark.parametrize("event", EVENTS, ids=lambda event: event.__name__)
def test_marks_outlive(folder, event):
    path = event(folder) or "take 0.npy"
    assert marks(folder) == {path: FIGHT, "take 1.npy": Marks(tags=("fight",))}
    assert check(folder / FOLDER).faults == []
    held = [json.loads(line) for line in (folder / FOLDER / marks_file.FILE).read_text().splitlines()[1:]]
    assert {(row[1], row[2]) for row in held} >= {(path, STAR), ("take 1.npy", TAG)}


def test_marks_that_neither_database_nor_file_hold_as_written_are_named(folder):
    change(folder, "UPDATE marks SET name = 'fright' WHERE clip_id = 2")
    (folder / FOLDER / marks_file.FILE).write_bytes(b"{}")
    assert ["lost" in fault.problem for fault in repair(folder / FOLDER, SmallBundle())] == [True]
    assert marks(folder) == {"take 0.npy": FIGHT}


def test_marks_go_with_a_clip_that_is_forgotten_or_removed(folder):
    forget(folder / FOLDER, ["take 0.npy"])
    again(folder)
    assert "take 0.npy" not in marks(folder)
    (number,) = add(folder / FOLDER, [NewClip("an array", moving(9))], SmallBundle())
    for _ in range(2):
        with writing(folder / FOLDER) as writer, writer.batch():
            marks_table.add(writer.connection, [number], STAR)
        assert marks(folder)["an array"].starred
        assert add(folder / FOLDER, [NewClip("an array", moving(8))], SmallBundle()) == [number]
    remove(folder / FOLDER, ["an array"])
    assert add(folder / FOLDER, [NewClip("an array", moving(8))], SmallBundle()) != [number]
    assert "an array" not in marks(folder)
