"""SIGKILL at a random instant of what writes a library, while another process reads it: nothing is lost or wrong."""

from __future__ import annotations

import multiprocessing
import os
import random
import shutil
import signal
import time
from collections.abc import Callable
from contextlib import suppress
from multiprocessing.connection import Connection
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from encoders.errors import LibraryDamaged, LibraryNotFound
from indexer.ingest import indexing, reencode, storing
from indexer.maintenance.check import check
from indexer.maintenance.repair import repair
from indexer.store import schema
from indexer.store.library_reader import FILE, FOLDER
from indexer.store.stored_library import StoredLibrary
from tests.indexer.folders import SmallBundle
from tests.robustness.content import change, content, differences, make

#: Processes are forked from one that has imported everything and done nothing: fast, and free of threads.
FORKING = multiprocessing.get_context("forkserver")
OLD, NEW = SmallBundle("small"), SmallBundle("other")


def index(folder: Path) -> None:
    storing._BATCH_FILES = 2  # many commits, many instants between them
    indexing.index(folder, bundle=OLD, jobs=2)


def rebuild(folder: Path) -> None:
    reencode.CLIPS_A_BATCH = 2
    indexing.index(folder, bundle=NEW, jobs=2, rebuild=True)


def mend(folder: Path) -> None:
    repair(folder / FOLDER, OLD)


def read(folder: Path) -> None:
    """Ask until the end. What others commit may not disturb it."""
    queries = np.random.default_rng(0).standard_normal((2, 16)).astype(np.float32)
    while True:
        try:
            with StoredLibrary.open(folder) as library:
                for _ in range(5):
                    with library.reading():
                        ids = library.nearest_windows(queries, 5)[1]
                        assert set(ids[ids >= 0].tolist()) <= set(library.ids().tolist())
        except LibraryNotFound:
            continue
        except LibraryDamaged as error:
            if "not finished" not in str(error):
                raise


def damage_rows(folder: Path) -> None:
    connection = schema.connect(folder / FOLDER / FILE, writable=True)
    for statement in (
        "UPDATE poses SET data = zeroblob(50) WHERE clip_id = 4",
        "UPDATE embeddings SET vector = zeroblob(32) WHERE clip_id = 2",
        "DELETE FROM windows WHERE clip_id = 3",
        "UPDATE texts SET text = 'a person talks' WHERE text = 'a person walks'",
    ):
        connection.execute(statement)
    connection.close()


def damage_pages(folder: Path) -> None:
    file = folder / FOLDER / FILE
    data = bytearray(file.read_bytes())
    first, last = (int(len(data) * part) // 4096 * 4096 for part in (0.4, 0.6))
    data[first:last] = bytes(last - first)
    file.write_bytes(data)


def forget_library(folder: Path) -> None:
    shutil.rmtree(folder / FOLDER)


class Work(NamedTuple):
    """What is killed: how the folder is brought to where it begins, what is done, and the model it ends with."""

    prepare: Callable[[Path], None]
    task: Callable[[Path], None]
    bundle: SmallBundle = OLD


WORKS = {
    "first index": Work(forget_library, index),
    "index": Work(change, index),
    "rebuild": Work(lambda folder: None, rebuild, NEW),
    "repair of rows": Work(damage_rows, mend),
    "repair of pages": Work(damage_pages, mend),
}


class Trials:
    """Trials in a scratch folder; each begins from a copy of the same library."""

    def __init__(self, scratch: Path) -> None:
        self.scratch = scratch
        self.made = make(scratch / "made")
        self.expected: dict[str, dict[str, Any]] = {}
        self.seconds: dict[str, float] = {}
        FORKING.set_forkserver_preload([__name__])
        for name, work in WORKS.items():
            folder = self._copy(work, "undisturbed")
            _Process(work.task, folder).end()
            folder = self._copy(work, "undisturbed")
            began = time.monotonic()
            _Process(work.task, folder).end()
            self.seconds[name] = time.monotonic() - began
            self.expected[name] = content(folder, work.bundle)

    def run(self, name: str, seed: int) -> str:
        """One trial: up to three kills, each of the process alone or of its group, then an undisturbed run.

        What is wrong is said in a line, and nothing if nothing is.
        """
        rng, work = random.Random(seed), WORKS[name]
        folder = self._copy(work, "killed")
        reader = _Process(read, folder) if rng.random() < 0.4 and name != "repair of pages" else None
        for _ in range(rng.choice((1, 1, 1, 2, 3))):
            process = _Process(work.task, folder)
            time.sleep(rng.uniform(0, 1.1 * self.seconds[name]))
            process.kill(group=rng.random() < 0.5)
            if left := process.left():
                return f"{left} processes outlive the one that was killed"
            if "repair" not in name and (wrong := fault(folder)):
                return f"after a kill: {wrong}"
        if reader is not None:
            if reader.failed():
                return f"the reader fails: {reader.error()}"
            reader.kill(group=True)
        last = _Process(work.task, folder)
        if error := last.end():
            return f"the next run fails: {error}"
        if found := check(folder / FOLDER).faults:
            return f"check finds {found[0]}"
        return "; ".join(differences(self.expected[name], content(folder, work.bundle))[:5])

    def _copy(self, work: Work, name: str) -> Path:
        shutil.rmtree(self.scratch / name, ignore_errors=True)
        folder = Path(shutil.copytree(self.made, self.scratch / name))
        work.prepare(folder)
        return folder


def fault(folder: Path) -> str:
    """What is wrong with a library between two runs; it may not be there yet, or only begun."""
    try:
        faults = check(folder / FOLDER).faults
        if not faults:
            with StoredLibrary.open(folder) as library, library.reading():
                for clip in library.clips():
                    library.motion(clip.id)
        return str(faults[0]) if faults and "not finished" not in faults[0].problem else ""
    except LibraryNotFound:
        return ""
    except LibraryDamaged as error:
        return "" if "not finished" in str(error) else str(error)


class _Process:
    """A process that is the first of its group."""

    def __init__(self, task: Callable[[Path], None], folder: Path) -> None:
        self._end, its = FORKING.Pipe(duplex=False)
        self._process = FORKING.Process(target=_run, args=(task, folder, its))
        self._process.start()
        its.close()
        self._end.recv()  # it has begun
        self._group = self._process.pid or 0

    def kill(self, *, group: bool) -> None:
        with suppress(ProcessLookupError):
            (os.killpg if group else os.kill)(self._group, signal.SIGKILL)
        self._process.join()

    def left(self) -> int:
        """How many processes of the group are still there after a while."""
        for _ in range(100):
            count = sum(_group_of(entry) == self._group for entry in os.listdir("/proc") if entry.isdecimal())
            if not count:
                return 0
            time.sleep(0.05)
        return count

    def failed(self) -> bool:
        return self._end.poll()

    def error(self) -> str:
        return str(self._end.recv())

    def end(self) -> str:
        """Wait until it is done; the error, if there was one."""
        error = self.error() if self._end.poll(120) else "it takes more than two minutes"
        self._process.join(5)
        return error


def _run(task: Callable[[Path], None], folder: Path, end: Connection) -> None:
    os.setsid()
    end.send("begun")
    try:
        task(folder)
        end.send("")
    except Exception as error:
        end.send(f"{type(error).__name__}: {error}")


def _group_of(process: str) -> int:
    """The group of a process; 0 if it has ended."""
    try:
        fields = Path(f"/proc/{process}/stat").read_text().rsplit(")", 1)[1].split()
    except OSError:
        return 0
    return 0 if fields[0] == "Z" else int(fields[2])
