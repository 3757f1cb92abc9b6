"""Eight processes on one library while it is written: no error, and no answer that mixes two generations.

Every clip has the number of the batch that wrote it as its caption, and the captions of all change in one batch: the
captions of an answer's hits are all of one number.
"""

from __future__ import annotations

import multiprocessing
import os
import sys
import time
import traceback
from collections.abc import Callable
from multiprocessing.connection import Connection
from pathlib import Path
from typing import Any

from encoders.bundle.bundle import Bundle
from indexer.ingest import indexing
from indexer.maintenance.check import check
from indexer.store.library_reader import FOLDER
from search.library import Library
from tests.conftest import ROOT
from tests.indexer.folders import write

CLIPS = 6
_BUNDLE = ROOT / "tests" / "data" / "tiny_bundle"


def batch(folder: Path, number: int) -> None:
    """What is to be indexed as a batch: a new take, one fewer, one changed, and new captions of all."""
    for seed in range(number, number + CLIPS):
        if not (folder / f"take {seed}.npy").exists():
            write(folder / f"take {seed}.npy", seed)
    (folder / f"take {number - 1}.npy").unlink(missing_ok=True)
    write(folder / "always.npy", number)
    names = ["always", *(f"take {seed}" for seed in range(number, number + CLIPS))]
    rows = "".join(f"{name}.npy,batch {number}\n" for name in names)
    fresh = folder / ".captions.csv"
    fresh.write_text(f"path,text\n{rows}")
    os.replace(fresh, folder / "captions.csv")


def _bundle() -> Bundle:
    return Bundle.load(_BUNDLE, threads=1)


def _write(folder: Path) -> Callable[[], None]:
    bundle, number = _bundle(), 1

    def step() -> None:
        nonlocal number
        number += 1
        batch(folder, number)
        indexing.index(folder, bundle=bundle, jobs=1)

    return step


def _asking(ask: Callable[[Library], Any]) -> Callable[[Path], Callable[[], None]]:
    """Asks a library that stays open; the answer's captions must be of one batch."""

    def begin(folder: Path) -> Callable[[], None]:
        library = Library.open(folder, bundle=_bundle())

        def step() -> None:
            captions = {hit.caption for hit in ask(library)} - {""}
            if len(captions) > 1:
                raise AssertionError(f"an answer of {sorted(captions)}")

        return step

    return begin


def _read(folder: Path) -> Callable[[], None]:
    """All captions and poses, in one snapshot."""
    library = Library.open(folder, bundle=_bundle())

    def step() -> None:
        with library.reading():
            clips = list(library.clips())
            texts = {caption.text for clip in clips for caption in library.captions(clip.id)}
            for clip in clips:
                library.motion(clip.id)
        if len(texts) != 1:
            raise AssertionError(f"a snapshot of {sorted(texts)}")

    return step


def _describe(folder: Path) -> Callable[[], None]:
    library = Library.open(folder, bundle=_bundle())
    return lambda: library.describe("always.npy") and None


def _check(folder: Path) -> Callable[[], None]:
    def step() -> None:
        if faults := check(folder / FOLDER).faults:
            raise AssertionError(f"check finds {faults[0]}")

    return step


def _serve(folder: Path) -> Callable[[], None]:
    from starlette.testclient import TestClient

    from search.server.app import create_app
    from search.server.snapshot_library import SnapshotLibrary

    client = TestClient(create_app(SnapshotLibrary.open(folder, bundle=_bundle())), base_url="http://127.0.0.1:8420")
    client.__enter__()

    def step() -> None:
        for url in ("/api/search?q=walks", "/api/motions", "/healthz"):
            answer = client.get(url)
            if answer.status_code != 200:
                raise AssertionError(f"{url}: {answer.status_code} {answer.text[:200]}")

    return step


PROCESSES: dict[str, Callable[[Path], Callable[[], None]]] = {
    "index": _write,
    "search": _asking(lambda library: library.search("walks", 20)),
    "moments": _asking(lambda library: library.moments("walks", k=20)),
    "similar": _asking(lambda library: library.similar("always.npy", 20)),
    "describe": _describe,
    "read": _read,
    "serve": _serve,
    "check": _check,
}


def run(scratch: Path, seconds: float) -> dict[str, tuple[int, str]]:
    """Run all processes at once: for each how many steps it has done, and the error that ended it, if one did."""
    folder = scratch / "takes"
    batch(folder, 1)
    indexing.index(folder, bundle=_bundle(), jobs=1)
    context = multiprocessing.get_context("spawn")
    ends, processes = {}, []
    for name in PROCESSES:
        ends[name], its = context.Pipe(duplex=False)
        processes.append(context.Process(target=_run, args=(name, folder, seconds, its)))
        processes[-1].start()
        its.close()
    found = {}
    for name, end in ends.items():
        try:
            found[name] = end.recv() if end.poll(seconds + 120) else (0, "it hangs")
        except EOFError:
            found[name] = (0, "its process has ended")
    for process in processes:
        process.kill()
        process.join()
    return found


def _run(name: str, folder: Path, seconds: float, end: Connection) -> None:
    steps, error = 0, ""
    try:
        step = PROCESSES[name](folder)
        until = time.monotonic() + seconds
        while time.monotonic() < until:
            step()
            steps += 1
    except BaseException as raised:
        error = f"{type(raised).__name__}: {raised}"
        traceback.print_exc(file=sys.stderr)
    end.send((steps, error))
