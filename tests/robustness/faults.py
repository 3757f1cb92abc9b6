"""A disk that fails once, at every write, sync, rename and truncation: old files are unharmed, and the next run ends.

    python -m tests.robustness.faults SCRATCH EVERY FIRST LAST

It runs with `failing_disk.c` loaded before the C library (`LD_PRELOAD`), tries every so many steps, of these the trials
from FIRST to before LAST, and prints a line of JSON for each: task, step, error, where it struck, and what was wrong.
Each trial is a process of its own. Motions are read in it, as the processes that do so otherwise write no file and take
most of the time.
"""

from __future__ import annotations

import ctypes
import errno
import json
import os
import pickle
import shutil
import subprocess
import sys
import traceback
from collections.abc import Callable, Iterable, Iterator
from pathlib import Path
from typing import Any, NamedTuple

from encoders.errors import LibraryError, MotionSeekError
from indexer.ingest import indexing, storing
from indexer.ingest.load import read_motions
from indexer.ingest.pool import Read, Request
from indexer.maintenance.check import check
from indexer.store.library_reader import FOLDER
from indexer.store.stored_library import StoredLibrary
from search.library import Library
from tests.conftest import ROOT
from tests.robustness import kills
from tests.robustness.content import content, differences, make

ERRORS = {"ENOSPC": errno.ENOSPC, "EIO": errno.EIO}
_OUT = ".out"  # not to be indexed


def search(folder: Path) -> None:
    with StoredLibrary.open(folder, bundle=kills.OLD) as library:
        library.nearest_windows(kills.OLD.encode_texts(["a person walks"]), 3)


def export(folder: Path) -> None:
    with Library.open(folder, bundle=kills.OLD) as library:
        for ending in ("bvh", "glb", "npz"):
            library.export("take 1.npy", folder / _OUT / f"cut.{ending}", overwrite=True)


def plot(folder: Path) -> None:
    with Library.open(folder, bundle=kills.OLD) as library:
        library.render("take 1.npy", folder / _OUT / "strip.png", size=64, overwrite=True)


def _without_vectors(folder: Path) -> None:
    shutil.rmtree(folder / FOLDER / "vectors")


def _with_old_files(folder: Path) -> None:
    (folder / _OUT).mkdir()
    for name in ("cut.bvh", "cut.glb", "cut.npz", "strip.png"):
        (folder / _OUT / name).write_bytes(b"old")


TASKS = {
    **kills.WORKS,
    "search": kills.Work(_without_vectors, search),
    "export": kills.Work(_with_old_files, export),
    "plot": kills.Work(_with_old_files, plot),
}


class Outcome(NamedTuple):
    """What came of a task: the steps it took, where the disk failed, and the error."""

    steps: int
    where: str
    error: Exception | None
    trace: str


def compiled(scratch: Path) -> Path:
    """The failing disk as a library; `CalledProcessError` or `FileNotFoundError` where there is no C compiler."""
    out = scratch / "failing_disk.so"
    source = Path(__file__).with_name("failing_disk.c")
    subprocess.run(["cc", "-shared", "-fPIC", "-O1", "-o", out, source, "-ldl"], check=True, capture_output=True)
    return out


def run(scratch: Path, every: int = 1, trials: range = range(sys.maxsize)) -> Iterator[dict[str, Any]]:
    """Trials of those there are, in a process that has the failing disk."""
    environment = {
        **os.environ, "LD_PRELOAD": str(compiled(scratch)), "PYTHONPATH": str(ROOT),
        "OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1",
    }  # fmt: skip
    command = [sys.executable, "-m", "tests.robustness.faults", *map(str, (scratch, every, trials.start, trials.stop))]
    with subprocess.Popen(command, env=environment, stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout is not None
        yield from map(json.loads, process.stdout)
    if process.returncode:
        raise RuntimeError(f"the trials end with code {process.returncode}")


def _main(scratch: Path, every: int, trials: range) -> None:
    storing.read_all = _read_here  # type: ignore[assignment]
    made = scratch / "made"
    _forked(lambda: make(made))
    ended = 0
    for name, task in TASKS.items():
        folder = _copy(made, task, scratch / "counted")
        counted = _forked(lambda task=task, folder=folder: _struck(task, folder, 0, 0))
        expected = _forked(lambda task=task, folder=folder: content(folder, task.bundle))
        steps = [(step, error) for step in range(1, counted.steps + 1, every) for error in ERRORS]
        for number, (step, error) in enumerate(steps, start=ended):
            if number in trials:
                print(json.dumps(_trial(made, scratch / "struck", name, step, error, expected)), flush=True)
        ended += len(steps)


def _trial(made: Path, place: Path, name: str, step: int, error: str, expected: dict[str, Any]) -> dict[str, Any]:
    """A task on a copy of a library, with a disk that fails at a step."""
    task = TASKS[name]
    folder = _copy(made, task, place)
    outcome = _forked(lambda: _struck(task, folder, step, ERRORS[error]))
    wrong = _said(outcome, folder) or _forked(lambda: _harm(name, task, folder, outcome, expected))
    where, said = outcome.where.replace(str(folder), ""), str(outcome.error or "")
    return {"task": name, "step": step, "error": error, "where": where, "said": said, "wrong": wrong}


def _read_here(requests: Iterable[Request[Any]], jobs: int) -> Iterator[tuple[Any, Read]]:
    """`pool.read_all` without other processes."""
    for request in requests:
        yield request.key, Read(tuple(read_motions(str(request.path), request.fps, request.joint_map, request.up)))


def _struck(task: kills.Work, folder: Path, step: int, number: int) -> Outcome:
    """Do a task while the disk fails at a step."""
    disk = ctypes.CDLL(os.environ["LD_PRELOAD"])
    disk.fault_where.restype = ctypes.c_char_p
    error, trace = None, ""
    disk.fault_arm(str(folder).encode(), step, number)
    try:
        task.task(folder)
    except Exception as raised:
        error, trace = raised, traceback.format_exc()[-600:]
    return Outcome(disk.fault_count(), disk.fault_where().decode(), error, trace)


def _said(outcome: Outcome, folder: Path) -> str:
    """What is wrong with the error."""
    error = outcome.error
    if error is None:
        return ""
    if not isinstance(error, (MotionSeekError, OSError)):
        return f"{type(error).__name__}: {error} {outcome.trace}"
    text = str(error)
    return "" if "\n" not in text and str(folder) in text else f"names no file: {text} {outcome.trace}"


def _harm(name: str, task: kills.Work, folder: Path, outcome: Outcome, expected: dict[str, Any]) -> str:
    """What is wrong with the files after the disk has failed, and after the next, undisturbed run."""
    if fault := kills.fault(folder) if "repair" not in name else "":
        return f"after it: {fault}"
    for path in (folder / _OUT).glob("*"):
        if path.name.startswith(".") or (path.stat().st_size < 20 and path.read_bytes() != b"old"):
            return f"{path.name} is half written"
    try:
        task.task(folder)
        if "index" not in name and "repair" not in name and name != "rebuild":
            indexing.index(folder, bundle=task.bundle, jobs=1)
    except Exception as error:
        return f"the next run fails: {type(error).__name__}: {error}"
    if found := check(folder / FOLDER).faults:
        return f"check finds {found[0]}"
    return "; ".join(differences(expected, content(folder, task.bundle))[:3])


def _copy(made: Path, task: kills.Work, folder: Path) -> Path:
    shutil.rmtree(folder, ignore_errors=True)
    shutil.copytree(made, folder)
    _forked(lambda: task.prepare(folder))
    return folder


def _forked(task: Callable[[], Any]) -> Any:
    """The result of a function in a process of its own."""
    out, into = os.pipe()
    if child := os.fork():
        os.close(into)
        with os.fdopen(out, "rb") as stream:
            data = stream.read()
        os.waitpid(child, 0)
        if not data:
            raise LibraryError("a trial has ended its process")
        return pickle.loads(data)
    try:
        data = pickle.dumps(task())
        with os.fdopen(into, "wb") as stream:
            stream.write(data)
    except BaseException:
        traceback.print_exc()
    finally:
        os._exit(0)


if __name__ == "__main__":
    every, first, last = map(int, sys.argv[2:])
    _main(Path(sys.argv[1]).resolve(), every, range(first, last))
