"""The write lock: held by one process, which it names or not at all."""

import subprocess
import sys
import threading

import pytest

from encoders.errors import LibraryLocked
from indexer.store.lock import write_lock
from indexer.store.stored_library import StoredLibrary
from indexer.store.writer import writing
from tests.conftest import ROOT

HELD = """
import sys
from pathlib import Path
from indexer.store.lock import write_lock
with write_lock(Path(sys.argv[1])):
    print("held", flush=True)
    sys.stdin.readline()
"""


@pytest.fixture
def holder(tmp_path):
    """Another process that holds the lock."""
    process = subprocess.Popen(
        [sys.executable, "-c", HELD, str(tmp_path)], stdin=subprocess.PIPE, stdout=subprocess.PIPE, cwd=ROOT, text=True
    )
    with process:
        assert process.stdout.readline() == "held\n"
        yield process
        process.communicate("\n")


def reason(folder):
    with pytest.raises(LibraryLocked) as caught, write_lock(folder):
        pass
    return str(caught.value)


def test_another_process_is_named(tmp_path, holder):
    assert f"being written by process {holder.pid} on " in reason(tmp_path)


@pytest.mark.parametrize("record", ["", " \n", None, b"\xff"])
def test_a_holder_that_is_not_known_is_another_process(tmp_path, holder, record):
    place = tmp_path / "writer.txt"
    place.unlink()
    if record is not None:
        place.write_bytes(record if isinstance(record, bytes) else record.encode())
    assert "being written by another process; wait until that is done" in reason(tmp_path)


def test_no_one_is_named_once_the_lock_is_free(tmp_path):
    with write_lock(tmp_path):
        assert (tmp_path / "writer.txt").read_text().startswith("process ")
    assert [path.name for path in tmp_path.iterdir()] == ["writer.lock"]


def test_a_second_thread_waits_and_the_same_one_is_refused(tmp_path):
    order = []

    def second():
        with write_lock(tmp_path):
            order.append("second")

    with write_lock(tmp_path):
        thread = threading.Thread(target=second)
        thread.start()
        assert "being written by process" in reason(tmp_path)
        thread.join(0.1)
        order.append("first")
    thread.join()
    assert order == ["first", "second"]


WRITTEN = """
import sys
from pathlib import Path
from indexer.store.writer import writing
folder = Path(sys.argv[1])
with writing(folder) as writer, writer.batch():
    writer.root(folder / "b")
"""


def test_a_writer_whose_lock_was_deleted_gives_way_to_the_next_one(tmp_path):
    with writing(tmp_path) as first:
        with first.batch():
            first.root(tmp_path / "a")
        (tmp_path / "writer.lock").unlink()
        subprocess.run([sys.executable, "-c", WRITTEN, str(tmp_path)], cwd=ROOT, check=True)
        with pytest.raises(LibraryLocked, match=r"writer\.lock was deleted"), first.batch():
            pass
    with StoredLibrary.open(tmp_path) as library:
        assert [root.name for root in library.roots] == ["a", "b"]
