"""Latency percentiles, failures, processor and memory of the server under load, by stretches of time.

    taskset -c 0,1 python -m benchmarks.serve --around REAL --library SIMULATED --seconds 600 \\
        --while-indexing FOLDER FOLDER

SIMULATED is written from REAL where it does not exist yet: see `benchmarks.simulated`. Sentences are drawn by Zipf's
law, as people search: few of them often, most of them once, of some four thousand in all; `--before` searches warm the
caches. Searches arrive at random (a Poisson process) and are timed from when they should have begun, so that a server
that stalls is charged for those that would have arrived meanwhile. `--rate 0` searches as fast as answers come. The
folders are indexed into the simulated library, one after another, during the searches; the last column of a row says
whether they still were. Server, indexing and this client share the cores this is started on.
"""

from __future__ import annotations

import argparse
import asyncio
import json
import os
import signal
import subprocess
import sys
import time
import urllib.request
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from itertools import pairwise
from pathlib import Path
from urllib.parse import quote

import numpy as np

from benchmarks.simulated import all_sentences, asked, simulate
from encoders.bundle import bundle as bundles
from indexer.store.library_reader import FILE
from indexer.store.stored_library import StoredLibrary
from indexer.vectors.blocks import Block
from indexer.vectors.faiss_index import FaissIndex
from indexer.vectors.library_indexes import CLIPS, WINDOWS, LibraryIndexes
from search.library import Library
from search.query.encoding import encode_queries

_CONNECTIONS = 64


@dataclass(frozen=True)
class Usage:
    """Resources that a process has used: CPU seconds, and MB of memory, its own and of mapped files."""

    cpu: float
    own: float
    mapped: float

    @classmethod
    def of(cls, pid: int) -> Usage:
        fields = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()
        status = dict(line.split(":", 1) for line in Path(f"/proc/{pid}/status").read_text().splitlines())
        own, mapped = (int(status[name].split()[0]) / 1e3 for name in ("RssAnon", "RssFile"))
        return cls((int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK"), own, mapped)


@dataclass
class LoadResult:
    """Timings of searches, in seconds from the start.

    Attributes
    ----------
    sentences, due, seconds : list of str, list of float, list of float
        Of each search: its sentence, when it should have begun, and how long after that it was answered.
    failures : list of (float, str)
        When the search should have begun, and the start of the answer.
    samples : list of (float, Usage, bool)
        Time, resources that the server had used by then, and whether indexing was running.
    """

    sentences: list[str] = field(default_factory=list)
    due: list[float] = field(default_factory=list)
    seconds: list[float] = field(default_factory=list)
    failures: list[tuple[float, str]] = field(default_factory=list)
    samples: list[tuple[float, Usage, bool]] = field(default_factory=list)


async def load(
    port: int, sentences: list[str], rate: float, *, sample: Callable[[], tuple[Usage, bool]], every: float
) -> LoadResult:
    """Search over open connections, `rate` times a second on average; sample the server every `every` seconds."""
    found, loop = LoadResult(), asyncio.get_running_loop()
    free: asyncio.Queue[tuple[asyncio.StreamReader, asyncio.StreamWriter]] = asyncio.Queue()
    for _ in range(_CONNECTIONS):
        free.put_nowait(await asyncio.open_connection("127.0.0.1", port))
    pauses = np.random.default_rng(2).exponential(1 / rate, len(sentences)) if rate else np.zeros(len(sentences))
    began = loop.time()
    due = began + np.cumsum(pauses)

    async def one(sentence: str, should_begin: float) -> None:
        reader, writer = await free.get()
        try:
            writer.write(f"GET /api/search?q={quote(sentence)} HTTP/1.1\r\nHost: 127.0.0.1\r\n\r\n".encode())
            head = await reader.readuntil(b"\r\n\r\n")
            body = await reader.readexactly(int(head.lower().split(b"content-length:")[1].split(b"\r\n")[0]))
            if not head.startswith(b"HTTP/1.1 200") or len(json.loads(body)["hits"]) != 10:
                found.failures.append((should_begin - began, body[:200].decode(errors="replace")))
            found.sentences.append(sentence)
            found.due.append(should_begin - began)
            found.seconds.append(loop.time() - should_begin)
        except (OSError, asyncio.IncompleteReadError) as error:
            found.failures.append((should_begin - began, repr(error)))
        finally:
            free.put_nowait((reader, writer))

    async def watch() -> None:
        while True:
            found.samples.append((loop.time() - began, *sample()))
            await asyncio.sleep(every)

    watching = asyncio.create_task(watch())
    tasks: set[asyncio.Task[None]] = set()
    for sentence, at in zip(sentences, due, strict=True):
        if rate:
            await asyncio.sleep(max(at - loop.time(), 0))
        else:
            while free.empty():
                await asyncio.wait(tasks, return_when=asyncio.FIRST_COMPLETED)
            await asyncio.sleep(0)
        task = asyncio.create_task(one(sentence, at if rate else loop.time()))
        tasks.add(task)
        task.add_done_callback(tasks.discard)
    if tasks:
        await asyncio.wait(tasks)
    watching.cancel()
    found.samples.append((loop.time() - began, *sample()))
    return found


def recall(folder: Path, sentences: list[str]) -> dict[str, float]:
    """Recall by the name of an index: share of the rows of an exact search that the index returns."""
    found = {}
    with Library.open(folder) as library:
        queries, galleries = encode_queries(library.bundle, sentences), LibraryIndexes(library.folder / "vectors")
        for kind, k in ((CLIPS, 10), (WINDOWS, 160)):
            index = galleries.current(kind, library.connection)
            exact = FaissIndex(index.generation, Block.of(index.rows))
            given, wanted = (np.stack(of.search(queries, k)[1:], axis=-1).tolist() for of in (index, exact))
            shares = [len({*map(tuple, g)} & {*map(tuple, w)}) / k for g, w in zip(given, wanted, strict=True)]
            found[f"{kind.name}, the best {k}"] = float(np.mean(shares))
    return found


def command(*arguments: object) -> subprocess.Popen[bytes]:
    """Run `motionseek` with this process's model."""
    program = "import pathlib; from encoders.bundle import bundle; "
    program += f"bundle.DEFAULT = pathlib.Path({str(bundles.DEFAULT)!r}); "
    program += "from search.cli.main import main; main()"
    return subprocess.Popen([sys.executable, "-c", program, *map(str, arguments)], stdout=subprocess.DEVNULL)


def serve(folder: Path, port: int) -> subprocess.Popen[bytes]:
    """Start a server and wait until it answers."""
    process = command("serve", folder, "--port", port)
    while process.poll() is None:
        try:
            urllib.request.urlopen(f"http://127.0.0.1:{port}/healthz", timeout=5).close()
            return process
        except OSError:
            time.sleep(0.2)
    raise SystemExit("the server did not start")


@contextmanager
def ended(process: subprocess.Popen[bytes]) -> Iterator[subprocess.Popen[bytes]]:
    """Interrupt a process at the end and wait for it."""
    try:
        yield process
    finally:
        process.send_signal(signal.SIGINT)
        process.wait(30)


class Indexing:
    """Folders indexed into a library, one after another."""

    def __init__(self, folders: list[Path], library: Path) -> None:
        self._folders, self._library = list(folders), library
        self._running: subprocess.Popen[bytes] | None = None

    def is_running(self) -> bool:
        """Whether indexing is running; begins with the next folder when one is done."""
        if (self._running is None or self._running.poll() is not None) and self._folders:
            self._running = command("index", self._folders.pop(0), "--library", self._library, "--jobs", 1)
        return self._running is not None and self._running.poll() is None

    def end(self) -> None:
        """Stop; clips indexed so far stay."""
        if self._running is not None and self._running.poll() is None:
            self._running.terminate()
            self._running.wait(60)


def first_occurrences(sentences: list[str], earlier: list[str]) -> list[bool]:
    """Whether each sentence occurs for the first time."""
    known = set(earlier)
    first = []
    for sentence in sentences:
        first.append(sentence not in known)
        known.add(sentence)
    return first


def report(found: LoadResult, earlier: list[str]) -> None:
    """Print a row for each stretch between two samples, and one for all; then the latency of new sentences."""
    due, ms = np.array(found.due), np.array(found.seconds) * 1e3
    failed = np.array([at for at, _ in found.failures])
    print("\n| seconds | searches | p50 ms | p95 | p99 | worst | failed | cores | own MB | mapped MB | indexing |")
    print("|---|---|---|---|---|---|---|---|---|---|---|")
    samples = found.samples
    for (begin, before, _), (end, after, indexing) in [*pairwise(samples), (samples[0], samples[-1])]:
        here = ms[(due >= begin) & (due < end)]
        if not len(here):
            continue
        p50, p95, p99 = np.percentile(here, (50, 95, 99))
        lost, cores = int(((failed >= begin) & (failed < end)).sum()), (after.cpu - before.cpu) / (end - begin)
        numbers = f"{len(here)} | {p50:.1f} | {p95:.1f} | {p99:.1f} | {here.max():.0f} | {lost} | {cores:.2f}"
        running = "yes" if indexing else "no"
        print(f"| {begin:.0f}–{end:.0f} | {numbers} | {after.own:.0f} | {after.mapped:.0f} | {running} |")
    first, last = samples[0], samples[-1]
    new = np.array(first_occurrences(found.sentences, earlier))
    p50, p95 = np.percentile(ms[new], (50, 95)) if new.any() else (0.0, 0.0)
    print(
        f"\n{len(ms) / last[0]:.0f} searches a second, {new.mean():.1%} of them with a sentence that is new "
        f"(p50 {p50:.1f} ms, p95 {p95:.1f}); "
        f"{(last[1].cpu - first[1].cpu) / len(ms) * 1e3:.2f} CPU ms each; "
        f"own memory {first[1].own:.0f} -> {last[1].own:.0f} MB; failed {len(found.failures)} "
        f"{[answer for _, answer in found.failures[:2]] or ''}"
    )


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--around", type=Path, required=True, help="a real library")
    parser.add_argument(
        "--library", type=Path, required=True, help="the simulated library, written if it does not exist"
    )
    parser.add_argument("--clips", type=int, default=100_000)
    parser.add_argument("--noise", type=float, default=0.5, help="distance of simulated from real unit vectors")
    parser.add_argument("--rate", type=float, default=200)
    parser.add_argument("--seconds", type=float, default=20)
    parser.add_argument("--every", type=float, help="seconds of a row; a tenth of all by default")
    parser.add_argument("--port", type=int, default=8765)
    parser.add_argument("--while-indexing", type=Path, nargs="+", default=[], help="index these folders meanwhile")
    parser.add_argument("--bundle", type=Path, default=bundles.DEFAULT, help="the model of both libraries")
    parser.add_argument("--before", type=int, default=4000, help="searches that warm the caches")
    parser.add_argument("--recall", type=int, default=50, help="queries compared with an exact search; 0: none")
    given = parser.parse_args()
    bundles.DEFAULT = given.bundle.resolve()
    if not (given.library / FILE).exists():
        began = time.perf_counter()
        simulate(given.library, given.around, given.clips, given.noise)
        print(f"simulated in {time.perf_counter() - began:.0f} s")
    began = time.perf_counter()
    with StoredLibrary.open(given.library) as library:
        library.prepare()
        stats = library.stats()
    print(f"{stats['clips']} clips, {stats['windows']} windows; indexes ready in {time.perf_counter() - began:.0f} s")
    if given.recall:
        for name, share in recall(given.library, all_sentences()[: given.recall]).items():
            print(f"recall of {name}: {share:.3f}")
    indexing = Indexing(given.while_indexing, given.library)
    with ended(serve(given.library, given.port)) as server:

        def sample() -> tuple[Usage, bool]:
            return Usage.of(server.pid), indexing.is_running()

        earlier = asked(given.before, 5)
        asyncio.run(load(given.port, earlier, 0, sample=lambda: (Usage.of(server.pid), False), every=1e6))
        sentences = asked(round((given.rate or 300) * given.seconds), 4)
        print(f"searching for {given.seconds:g} s at {given.rate:g} a second on {len(os.sched_getaffinity(0))} cores")
        try:
            found = asyncio.run(
                load(given.port, sentences, given.rate, sample=sample, every=given.every or given.seconds / 10)
            )
            report(found, earlier)
        finally:
            indexing.end()


if __name__ == "__main__":
    main()
