"""Files that are larger than any motion or list of captions cost no time and no memory."""

from __future__ import annotations

import json
import time
import tracemalloc
from pathlib import Path

import pytest

from indexer.ingest import indexing
from indexer.store import schema
from indexer.store.library_reader import FILE
from indexer.store.stored_library import StoredLibrary
from tests.indexer.folders import SmallBundle, write


def sparse(path: Path, size: int) -> Path:
    """A file of zeros that takes no disk."""
    with path.open("wb") as file:
        file.truncate(size)
    return path


def index(folder: Path) -> indexing.Summary:
    return indexing.index(folder, bundle=SmallBundle(), jobs=1)


@pytest.mark.parametrize("name", ["captions.csv", "captions.tsv", "captions.jsonl", "walk.txt"])
@pytest.mark.parametrize("size", [400 << 20, 6 << 30])
def test_a_huge_side_file_is_not_opened(tmp_path, name, size):
    write(tmp_path / "walk.npy", 1)
    (tmp_path / name).write_text(
        '{"path": "walk.npy", "text": "a walk"}' if "json" in name else "path,text\nwalk.npy,a"
    )
    index(tmp_path)
    sparse(tmp_path / name, size)
    began = time.monotonic()
    tracemalloc.start()
    found = index(tmp_path)
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert any(f"{name}: larger than 32 MB; its captions are left as they were" in said for said in found.warnings)
    assert found.unchanged == 1
    assert peak < 50e6
    assert time.monotonic() - began < 5


def test_a_motion_larger_than_any_is_refused_without_being_read(tmp_path):
    write(tmp_path / "walk.npy", 1)
    sparse(tmp_path / "long.bvh", 6 << 30)
    began = time.monotonic()
    found = index(tmp_path)
    assert found.indexed == 1
    assert [(Path(path).name, reason) for path, reason in found.failed] == [
        ("long.bvh", "the file is larger than 4 GB; cut it into takes")
    ]
    assert time.monotonic() - began < 10


@pytest.mark.parametrize(
    ("name", "content"),
    [
        ("captions.jsonl", b"[" * 165_000 + b"\n" + json.dumps({"path": "walk.npy", "text": "a walk"}).encode()),
        ("captions.jsonl", b'{"path": ' * 20_000 + b"\n" + json.dumps({"path": "walk.npy", "text": "a walk"}).encode()),
        ("captions.csv", b"path,text\nwalk.npy,a walk\nwalk.npy," + b"a" * (20 << 20)),
        ("captions.csv", b"path,text\nwalk.npy,a walk\n" + b"," * (1 << 20)),
        ("walk.txt", b"a walk\n" + b"a" * (20 << 20)),
        ("walk.txt", b"a walk\n" + b"#" * (5 << 20)),
    ],
    ids=["brackets", "braces", "a long cell", "a million cells", "a long line", "hashes"],
)
def test_a_side_file_that_was_crafted_costs_little_and_the_rest_counts(tmp_path, name, content):
    write(tmp_path / "walk.npy", 1)
    (tmp_path / name).write_bytes(content)
    began = time.monotonic()
    tracemalloc.start()
    assert index(tmp_path).indexed == 1
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    with StoredLibrary.open(tmp_path) as library:
        assert [caption.text for caption in library.captions(1)] == ["a walk"]
    assert peak < 300e6
    assert time.monotonic() - began < 20


def test_moving_many_identical_files_takes_time_in_proportion(tmp_path):
    """How many rows of the database are looked at, which is what grew with the square of the files."""
    looked_at = {}
    for count in (100, 400):
        folder = tmp_path / str(count)
        (folder / "a").mkdir(parents=True)
        write(folder / "a" / "0.npy", 1)
        index(folder)
        copies(folder, count)
        assert index(folder).unchanged == count
        (folder / "a").rename(folder / "b")
        looked_at[count] = steps(folder)
        with StoredLibrary.open(folder / ".motionseek") as library:
            assert sorted(clip.path for clip in library.clips()) == sorted(f"b/{number}.npy" for number in range(count))
    assert looked_at[400] < 5 * looked_at[100]


def copies(folder: Path, count: int) -> None:
    """Copies of the one file, in the folder and in its library."""
    content = (folder / "a" / "0.npy").read_bytes()
    db = schema.connect(folder / ".motionseek" / FILE, writable=True)
    with schema.transaction(db):
        rows = {table: db.execute(f"SELECT * FROM {table}").fetchone() for table in ("files", "clips")}
        names = {table: [row[1] for row in db.execute(f"PRAGMA table_info({table})")] for table in rows}
        for number in range(1, count):
            path = folder / "a" / f"{number}.npy"
            path.write_bytes(content)
            changed = {
                "files": {"id": 1 + number, "path": f"a/{number}.npy", "mtime_ns": path.stat().st_mtime_ns},
                "clips": {"id": 1 + number, "file_id": 1 + number, "clip_path": f"a/{number}.npy"},
            }
            for table, change in changed.items():
                row = dict(zip(names[table], rows[table], strict=True)) | change
                db.execute(f"INSERT INTO {table} VALUES ({', '.join('?' * len(row))})", list(row.values()))
    db.close()


def steps(folder: Path) -> int:
    """Index a folder; hundreds of steps of SQLite's virtual machine that this took."""
    taken = 0

    def step() -> int:
        nonlocal taken
        taken += 1
        return 0

    connect = schema.connect

    def counted(*given, **how):
        db = connect(*given, **how)
        db.set_progress_handler(step, 100)
        return db

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(schema, "connect", counted)
        index(folder)
    return taken
