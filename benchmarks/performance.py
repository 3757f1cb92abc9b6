"""Every row of docs/performance.md, each beside the plain way in the same run.

    python -m benchmarks.performance                            every row
    python -m benchmarks.performance index encoding start       some of them
    python -m benchmarks.performance --archive data/mocap --clips 100000 --work /somewhere/large

The plain way is one file after another, a parser of lists of lines, features of one clip at a time, torch in single
precision in batches of 32 in file order for clips and every window, and a flat scan. Ratios are of processor time
where both run on one core. What is large is simulated around the archive: see `benchmarks.simulated`. Other programs on
the machine change times by the clock; the load is printed.
"""

from __future__ import annotations

import argparse
import os
import resource
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from benchmarks import simulated
from encoders.bundle.bundle import Bundle
from indexer.formats.bvh import bvh_frames
from indexer.formats.numbers import Numbers
from indexer.ingest.load import read_motions
from indexer.store.library_reader import FILE, FOLDER
from indexer.store.stored_library import StoredLibrary

_SENTENCES, _STARTS = 100, 7


@dataclass(frozen=True)
class Places:
    """An archive of motion files, how many clips are simulated around it, which files are indexed, and a folder."""

    archive: Path
    clips: int
    every: int
    work: Path

    @property
    def library(self) -> Path:
        """A folder with the archive's library, indexed where there is none yet."""
        if not (self.work / "archive" / FILE).exists():
            motionseek("index", self.archive, "--library", self.work / "archive")
        return self.work / "archive"

    @property
    def large(self) -> Path:
        """A folder whose library is simulated around the archive's, and whose files are there but empty."""
        folder = self.work / f"simulated {self.clips}"
        if not (folder / FOLDER / FILE).exists():
            simulated.simulate(folder / FOLDER, self.library, self.clips, 0.5)
            with StoredLibrary.open(folder) as library:
                paths = [folder / clip.path for clip in library.clips()]
            for path in paths:
                path.parent.mkdir(exist_ok=True)
                path.touch()
                os.utime(path, ns=(0, 0))
        return folder


def motionseek(*arguments: object) -> tuple[float, float, float]:
    """Run the command: seconds by the clock, of the processor, and MB of memory of its largest process, at most."""
    before, began = resource.getrusage(resource.RUSAGE_CHILDREN), time.perf_counter()
    command = [sys.executable, "-m", "motionseek_main", *map(str, arguments)]
    done = subprocess.run(command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
    if done.returncode and arguments[0] != "index":  # an archive may hold files that cannot be read
        raise SystemExit(f"{' '.join(command)}: {done.stderr}")
    wall, after = time.perf_counter() - began, resource.getrusage(resource.RUSAGE_CHILDREN)
    return wall, after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime, after.ru_maxrss / 1e3


def benchmark(name: str, *arguments: object) -> None:
    """Run another benchmark, which prints its own figures."""
    subprocess.run([sys.executable, "-m", f"benchmarks.{name}", *map(str, arguments)], check=True)


def index(places: Places) -> None:
    """A whole index of an archive's BVH files, against the plain way."""
    with tempfile.TemporaryDirectory(dir=places.work) as folder:
        chosen = Path(folder, "files")
        chosen.mkdir()
        files = sorted(places.archive.rglob("*.bvh"))[:: places.every]
        for number, file in enumerate(files):
            (chosen / f"{number:05} {file.name}").symlink_to(file.resolve())
        wall, cpu, memory = motionseek("index", chosen, "--library", Path(folder, "library"))
    plain_wall, plain_cpu = plain_index(files)
    size = sum(file.stat().st_size for file in files) / 1e6
    print(f"{len(files)} files, {size:.0f} MB: index {wall:.1f} s ({cpu:.1f} s of CPU, {memory:.0f} MB at most)")
    ratios = f"{plain_wall / wall:.1f} x, {plain_cpu / cpu:.1f} x by CPU"
    print(f"plain way {plain_wall:.1f} s ({plain_cpu:.1f} s of CPU): {ratios}")


def plain_index(files: list[Path]) -> tuple[float, float]:
    """Seconds by the clock and of the processor to read, retarget and encode files in the plain way (needs torch)."""
    import torch

    from benchmarks.encode import plain
    from encoders.bundle.windows import grid
    from encoders.tmr.model.network import TMR
    from encoders.tmr.training.recipe import default_network

    torch.set_num_threads(1)
    bundle = Bundle.load(threads=1)
    encode = plain(TMR(default_network(96, 384)).motion_encoder.eval())
    began, began_cpu = time.perf_counter(), time.process_time()
    with lists_of_lines():
        for file in files:
            try:
                motions = [read.motion for read in read_motions(str(file))]
            except Exception as error:  # what cannot be read is left out here as there
                print(f"left out: {file.name} ({type(error).__name__})", file=sys.stderr)
                continue
            for motion in motions:
                features = bundle.features(motion)
                sizes = grid(len(features), bundle.fps).values()
                windows = [features[start : start + size] for starts, size in sizes for start in starts]
                encode([features[: bundle.max_frames], *windows])
    return time.perf_counter() - began, time.process_time() - began_cpu


@contextmanager
def lists_of_lines() -> Iterator[None]:
    """Read the numbers of BVH as most readers do."""
    ours = bvh_frames.parse_lines

    def parse(text: bytes) -> Numbers:
        lines = [[float(word) for word in line.split()] for line in text.splitlines() if line.strip()]
        return Numbers(np.array([value for line in lines for value in line]), np.cumsum([len(a) for a in lines]), "")

    bvh_frames.parse_lines = parse
    try:
        yield
    finally:
        bvh_frames.parse_lines = ours


def encoding(places: Places) -> None:
    """Clips and windows of the archive, against torch; and whether int8 finds what floating point finds."""
    benchmark("encode", "windows", places.library, "--clips", 100, "--threads", 1, "--rounds", 3)
    benchmark("encode", "recall", "--clips", 600, "--threads", 1)


def reindex(places: Places) -> None:
    """A run over files that are all unchanged, once their vectors are prepared."""
    motionseek("index", places.large)
    wall, cpu, memory = min(motionseek("index", places.large) for _ in range(2))
    print(f"{places.clips:,} unchanged files: {wall:.1f} s ({cpu:.1f} s of CPU), {memory:.0f} MB at most")


def search(places: Places) -> None:
    """A sentence against the simulated library, with filters, exact, and as a whole request."""
    benchmark("scale", places.large / FOLDER)


def sentence(places: Places) -> None:
    """One sentence at a time, none of them seen before."""
    bundle = Bundle.load()
    bundle.encode_texts(["a person walks"])
    found = []
    for text in simulated.all_sentences()[:_SENTENCES]:
        began, began_cpu = time.perf_counter(), time.process_time()
        bundle.encode_texts([text])
        found.append((time.perf_counter() - began, time.process_time() - began_cpu))
    (wall, cpu), late = np.median(found, axis=0) * 1e3, np.percentile(found, 95, axis=0)[0] * 1e3
    print(f"one sentence: {wall:.1f} ms (p95 {late:.1f} ms, median {cpu:.1f} ms of CPU)")


def start(places: Places) -> None:
    """`motionseek search` over the archive's library, from its start to its end; modules are compiled beforehand."""
    os.environ.pop("PYTHONDONTWRITEBYTECODE", None)
    runs = [motionseek("search", "a person kicks", "--library", places.library) for _ in range(_STARTS)]
    wall, cpu, _ = np.min(runs[1:], axis=0)
    print(f"from start to answer: {wall:.2f} s ({cpu:.2f} s of CPU), least of {_STARTS - 1}")


def memory(places: Places) -> None:
    """The first run over unchanged files, which prepares all vectors, and a check."""
    benchmark("library", "memory", places.library, "--clips", places.clips)


def size(places: Places) -> None:
    """Bytes of library a minute of motion."""
    with StoredLibrary.open(places.library) as library:
        minutes = library.stats()["seconds"] / 60
        tables = library.connection.execute(
            "SELECT name, sum(pgsize) FROM dbstat GROUP BY name ORDER BY 2 DESC LIMIT 6"
        ).fetchall()
    files = [path for path in places.library.rglob("*") if path.is_file()]
    database = sum(path.stat().st_size for path in files if path.name.startswith(FILE))
    vectors = sum(path.stat().st_size for path in files) - database
    of_both = f"{database / minutes / 1e3:.1f} kB a minute, and {vectors / minutes / 1e3:.1f} of vectors"
    print(f"{minutes:.0f} minutes: {of_both}")
    print(", ".join(f"{name} {share / minutes / 1e3:.1f}" for name, share in tables))


def moments(places: Places) -> None:
    """Moments in a file of two hours that is not indexed."""
    benchmark("moments", "memory")


def serving(places: Places) -> None:
    """Searches a second over the simulated library, while the archive is indexed into it."""
    folder = places.large / FOLDER
    settings = ("--rate", 500, "--seconds", 60, "--recall", 0, "--while-indexing", places.archive)
    benchmark("serve", "--around", places.library, "--library", folder, *settings)


ROWS: dict[str, Callable[[Places], None]] = {
    row.__name__: row
    for row in (index, encoding, reindex, search, sentence, start, memory, size, moments, serving)
}  # fmt: skip


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("rows", nargs="*", choices=[*ROWS, []], help="all if none is given")
    parser.add_argument("--archive", type=Path, default=Path("data/mocap"), help="motion files")
    parser.add_argument("--clips", type=int, default=100_000, help="of the simulated library")
    parser.add_argument("--every", type=int, default=1, help="of the files, only each so-many-th is indexed")
    parser.add_argument("--work", type=Path, default=Path(tempfile.gettempdir(), "motionseek performance"))
    given = parser.parse_args()
    given.work.mkdir(parents=True, exist_ok=True)
    places = Places(given.archive.resolve(), given.clips, given.every, given.work.resolve())
    for name in given.rows or ROWS:
        print(f"\n{name}: {(ROWS[name].__doc__ or '').strip()} Load {os.getloadavg()[0]:.1f}.", flush=True)
        ROWS[name](places)


if __name__ == "__main__":
    main()
