"""Times to index a folder and to update its index, and query times of the vector indexes.

    python -m benchmarks.library index FOLDER [--jobs N]      first run against second run
    python -m benchmarks.library memory REAL [--clips N]      peak memory of a run over a simulated library
    python -m benchmarks.library new [--clips N ...] [--identical]      memory and time of runs over new files
    python -m benchmarks.library search [--windows 10000 100000 1000000] [--size 256]

Every figure stands beside the plain way, measured in the same run: a numpy scan of float32 vectors. The vectors are
random, the worst case for clusters: `benchmarks.serve` tells the recall for those of a model.
"""

from __future__ import annotations

import argparse
import multiprocessing
import os
import resource
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np

from benchmarks.simulated import simulate
from indexer.ingest import indexing
from indexer.store import schema
from indexer.store.library_reader import FILE, FOLDER
from indexer.store.stored_library import StoredLibrary
from tests.indexer.folders import SmallBundle, write

A_CLIP = 50  # windows


def index(folder: Path, jobs: int | None) -> None:
    """Index a folder twice, the library elsewhere."""
    with tempfile.TemporaryDirectory() as place:
        first = indexing.index(folder, library=place, jobs=jobs)
        second = indexing.index(folder, library=place, jobs=jobs)
        with StoredLibrary.open(place) as library:
            stats = library.stats()
    print(f"{first.indexed} clips, {stats['seconds'] / 3600:.2f} h of motion, {len(first.failed)} files failed")
    print(f"library {stats['bytes'] / 1e6:.1f} MB, {stats['windows']} windows")
    print(f"first run   {first.seconds:8.2f} s   {stats['seconds'] / first.seconds:.0f} times real time")
    print(f"second run  {second.seconds:8.2f} s   1/{first.seconds / second.seconds:.0f} of the first")


def memory(around: Path, clips: int) -> None:
    """Index a folder of unchanged files whose vectors have not been prepared, those of clips like real ones."""
    with tempfile.TemporaryDirectory() as place:
        simulate(Path(place, FOLDER), around, clips, 0.3)
        with StoredLibrary.open(place) as library:
            paths = [Path(place, clip.path) for clip in library.clips()]
            windows = library.stats()["windows"]
        for path in paths:
            path.parent.mkdir(exist_ok=True)
            path.touch()
            os.utime(path, ns=(0, 0))
        print(f"{clips} clips, {windows} windows")
        for command in ("index", "check"):
            began = time.monotonic()
            # A simulated clip has vectors and no poses, which `check` says of each.
            program = [sys.executable, "-m", "motionseek_main", command, place]
            process = subprocess.Popen(program, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
            peak = 0.0
            while process.poll() is None:
                peak = max(peak, _own_memory(process.pid))
                time.sleep(0.02)
            print(f"{command}: {peak:.0f} MB at most, {time.monotonic() - began:.0f} s")


def _own_memory(pid: int) -> float:
    """MB of memory of a process, without that of files it maps, which the system takes back at will; Linux only."""
    status = Path(f"/proc/{pid}/status").read_text()
    return sum(int(line.split()[1]) for line in status.splitlines() if line.startswith("RssAnon")) / 1e3


def new(counts: list[int], identical: bool, jobs: int) -> None:
    """Index folders of new files, then move all of them and index again; the encoder costs next to nothing."""
    print("   clips | first run |   peak | processes that read | after a move |   peak")
    peaks = []
    for count in counts:
        with tempfile.TemporaryDirectory() as place:
            _write_takes(Path(place, "takes"), count, identical)
            first, peak, reading = _apart(_index_new, place, jobs)
            Path(place, "takes").rename(Path(place, "moved"))
            second, after, _ = _apart(_index_new, place, jobs)
        peaks.append(peak)
        times = f"{count:8,} | {first:7.0f} s | {peak:3.0f} MB | {reading:16.0f} MB | {second:10.1f} s"
        print(f"{times} | {after:3.0f} MB", flush=True)
    if len(counts) > 1:
        print(f"{1e3 * np.polyfit(counts, peaks, 1)[0]:.2f} kB a clip")


def _write_takes(folder: Path, count: int, identical: bool) -> None:
    """Takes of four seconds, a thousand in each folder, all different or all the same."""
    for number in range(count):
        write(folder / f"{number // 1000:03}" / f"{number:06}.npy", 0 if identical else number)


def _index_new(place: str, jobs: int) -> tuple[float, float, float]:
    """Index a folder; seconds, and the peaks of memory in MB: of this process, and of the largest that reads."""
    summary = indexing.index(place, bundle=SmallBundle(latent_size=256), jobs=jobs)
    assert not summary.failed
    peaks = [resource.getrusage(who).ru_maxrss / 1e3 for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)]
    return summary.seconds, peaks[0], peaks[1]


def _apart(call: Callable[..., tuple[float, float, float]], *given: object) -> tuple[float, float, float]:
    """The result of a function in a new process."""
    with multiprocessing.get_context("spawn").Pool(1) as pool:
        return pool.apply(call, given)


def search(counts: list[int], size: int) -> None:
    """Search libraries of random windows."""
    print(f"{size} numbers a vector; one query, 10 answers; milliseconds, median (95th percentile)")
    print("   windows | nearest_windows |  of a tenth  | nearest_clips |  numpy scan   | recall@10 | open  | build")
    for count in counts:
        with tempfile.TemporaryDirectory() as place:
            made = _library(Path(place), count, size)
            _row(Path(place), made, count, size)


def _row(place: Path, vectors: np.ndarray, count: int, size: int) -> None:
    rng = np.random.default_rng(1)
    query = rng.standard_normal((1, size), np.float32)
    query /= np.linalg.norm(query)
    with StoredLibrary.open(place) as library:
        build = _once(lambda: library.nearest_windows(query, 10))
    with StoredLibrary.open(place) as library:
        opened = _once(lambda: library.nearest_windows(query, 10))
        allowed = np.sort(rng.choice(library.ids(), len(library) // 10, replace=False))
        windows = _times(lambda: library.nearest_windows(query, 10))
        tenth = _times(lambda: library.nearest_windows(query, 10, allowed=allowed))
        clips = _times(lambda: library.nearest_clips(query, 10))
        _, ids, starts, _ = library.nearest_windows(query, 10)
    scan = _times(lambda: np.argpartition(vectors @ query[0], -10)[-10:])
    exact = np.argsort(-(vectors @ query[0]))[:10]
    found = set(zip(ids[0].tolist(), np.rint(starts[0] / 0.4).astype(int).tolist(), strict=True))
    want = {(int(row) // A_CLIP + 1, int(row) % A_CLIP) for row in exact}
    print(
        f"{count:10,} | {_show(windows):>15} | {_show(tenth):>12} | {_show(clips):>13} | {_show(scan):>13} | "
        f"{len(found & want) / 10:9.2f} | {opened:5.2f} s | {build:5.2f} s"
    )


def _library(folder: Path, count: int, size: int) -> np.ndarray:
    """A library of `count` random windows, 50 a clip; the vectors (count, size)."""
    StoredLibrary.open(folder, create=True).close()
    rng = np.random.default_rng(0)
    vectors = rng.standard_normal((count, size), np.float32)
    vectors /= np.linalg.norm(vectors, axis=1, keepdims=True)
    starts = (np.arange(A_CLIP) * 0.4).astype(np.float32).tobytes()
    connection = schema.connect(folder / FILE, writable=True)
    with schema.transaction(connection):
        connection.execute("INSERT INTO roots(id, path) VALUES (1, '..')")
        connection.execute("INSERT INTO models(id, fingerprint, name, size) VALUES (1, 'none', 'random', ?)", (size,))
        connection.execute("INSERT INTO settings VALUES ('model', 1)")
        connection.execute("UPDATE settings SET value = 1 WHERE key = 'generation'")
        for clip in range(1, count // A_CLIP + 1):
            packed = vectors[(clip - 1) * A_CLIP : clip * A_CLIP].astype(np.float16)
            connection.execute(
                "INSERT INTO files(id, root_id, path, size, mtime_ns, hash, recipe, state, reason) "
                "VALUES (?, 1, ?, 0, 0, ?, '', 'indexed', NULL)",
                (clip, f"{clip}.bvh", str(clip)),
            )
            connection.execute(
                "INSERT INTO clips(id, file_id, name, format, rig, fps, frames, duration, added, generation) "
                "VALUES (?, ?, ?, 'bvh', '', 20, 424, 21.2, '', 1)",
                (clip, clip, str(clip)),
            )
            connection.execute(
                "INSERT INTO embeddings(clip_id, model_id, vector) VALUES (?, 1, ?)", (clip, packed[0].tobytes())
            )
            connection.execute(
                "INSERT INTO windows(clip_id, model_id, length, starts, vectors) VALUES (?, 1, 1.6, ?, ?)",
                (clip, starts, packed.tobytes()),
            )
    connection.close()
    return vectors


def _once(call: Callable[[], object]) -> float:
    began = time.perf_counter()
    call()
    return time.perf_counter() - began


def _times(call: Callable[[], object], times: int = 30) -> np.ndarray:
    call()
    return np.array([_once(call) for _ in range(times)]) * 1e3


def _show(times: np.ndarray) -> str:
    return f"{np.median(times):.2f} ({np.percentile(times, 95):.2f})"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    commands = parser.add_subparsers(dest="command", required=True)
    indexing = commands.add_parser("index")
    indexing.add_argument("folder", type=Path)
    indexing.add_argument("--jobs", type=int)
    searching = commands.add_parser("search")
    searching.add_argument("--windows", type=int, nargs="+", default=[10_000, 100_000, 1_000_000])
    searching.add_argument("--size", type=int, default=256)
    remembering = commands.add_parser("memory")
    remembering.add_argument("around", type=Path, help="an indexed folder of real motions")
    remembering.add_argument("--clips", type=int, default=100_000)
    taking_in = commands.add_parser("new")
    taking_in.add_argument("--clips", type=int, nargs="+", default=[10_000, 30_000, 100_000])
    taking_in.add_argument("--jobs", type=int, default=2)
    taking_in.add_argument("--identical", action="store_true", help="all files hold the same motion")
    given = parser.parse_args()
    if given.command == "index":
        index(given.folder, given.jobs)
    elif given.command == "new":
        new(given.clips, given.identical, given.jobs)
    elif given.command == "memory":
        memory(given.around, given.clips)
    else:
        search(given.windows, given.size)


if __name__ == "__main__":
    main()
