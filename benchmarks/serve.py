"""How many searches a second the server answers, from another process.

    python -m benchmarks.serve --around LIBRARY [--clips 100000] [--rate 200] [--minutes 10] [--while-indexing FOLDER]

The library is simulated: every clip is a real one of LIBRARY, its vectors moved a little, so that the windows a clip
has, and how alike they are, are real. Sentences are drawn by Zipf's law, as people ask: few of them often, most of them
once, of some four thousand in all; `--before` searches have been asked already. Searches begin at random (Poisson) and
are timed from when they should have begun, so a server that stalls is not spared those that would have come meanwhile.
`--rate 0` asks as fast as answers come.
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
from dataclasses import dataclass, field
from pathlib import Path
from urllib.parse import quote

import numpy as np

from encoders import bundle as bundles
from indexer import schema
from indexer.gallery import CLIPS, WINDOWS
from indexer.library import FILE, Library
from indexer.vectors import Block
from indexer.writer import INDEXED
from search.engine import SearchableLibrary
from search.vocabulary import vocabulary

MANNERS = (
    "", "slowly", "quickly", "carefully", "happily", "angrily", "like an old man", "while looking around", "twice",
    "three times", "to the left", "to the right", "forward", "backwards", "and stops", "and turns around",
    "with the left hand", "with the right hand", "in a circle", "again and again",
)  # fmt: skip
_BATCH = 2000
_CONNECTIONS = 64
_CAPTIONED = 0.3


def simulate(folder: Path, around: Path, count: int, noise: float, seed: int = 0) -> None:
    """Write a library of `count` clips that resemble those of another one, in the library's own format."""
    rng = np.random.default_rng(seed)
    with Library.open(around) as real:
        clips = [(clip, real.windows(clip.id)) for clip in real.clips(real.ids().tolist()).values()]
        rows = real._galleries.current(CLIPS, real.connection).rows
        whole = dict(zip(rows.owners.tolist(), rows.vectors, strict=True))
        model = real._model()
    assert model is not None
    Library.open(folder, create=True).close()
    sentences = all_sentences()
    db = schema.connect(folder / FILE, writable=True)

    def moved(vectors: np.ndarray, by: np.ndarray) -> bytes:
        near = vectors.astype(np.float32) + by + noise / 2 / 16 * rng.standard_normal(vectors.shape, np.float32)
        return (near / np.linalg.norm(near, axis=-1, keepdims=True)).astype(np.float16).tobytes()

    with schema.transaction(db):
        db.execute("INSERT INTO roots(id, path) VALUES (1, '..')")
        db.execute("INSERT INTO models VALUES (1, ?, ?, ?)", (model["fingerprint"], model["name"], model["size"]))
        db.execute("INSERT INTO settings VALUES ('model', 1)")
        db.execute("UPDATE settings SET value = 1 WHERE key = 'generation'")
        db.executemany("INSERT INTO texts(id, text) VALUES (?, ?)", enumerate(sentences, 1))
    for first in range(0, count, _BATCH):
        with schema.transaction(db):
            for i in range(first + 1, min(first + _BATCH, count) + 1):
                clip, windows = clips[rng.integers(len(clips))]
                by = noise / 16 * rng.standard_normal(model["size"], np.float32)
                path = f"take {i // 1000:03}/{clip.name} {i}.bvh"
                db.execute("INSERT INTO files VALUES (?, 1, ?, 0, 0, ?, '', ?, NULL)", (i, path, str(i), INDEXED))
                values = (i, i, path, clip.format, clip.rig, clip.fps, clip.frames, clip.duration, clip.added)
                db.execute("INSERT INTO clips VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?, 1)", values)
                db.execute("INSERT INTO embeddings VALUES (?, 1, ?)", (i, moved(whole[clip.id], by)))
                db.executemany(
                    "INSERT INTO windows VALUES (?, 1, ?, ?, ?)",
                    [(i, w.length, w.starts.tobytes(), moved(w.vectors, by)) for w in windows],
                )
                if rng.random() < _CAPTIONED:
                    text = int(rng.integers(len(sentences))) + 1
                    db.execute("INSERT INTO captions(clip_id, text_id) VALUES (?, ?)", (i, text))
    db.close()


def all_sentences() -> list[str]:
    """Some thousand distinct sentences, shuffled."""
    made = list(dict.fromkeys(f"{sentence} {manner}".strip() for sentence in vocabulary() for manner in MANNERS))
    return [str(sentence) for sentence in np.random.default_rng(1).permutation(made)]


def asked(count: int, seed: int) -> list[str]:
    """Sentences as people ask them: the n-th most frequent with a chance of 1 / n."""
    sentences = all_sentences()
    chance = 1 / np.arange(1, len(sentences) + 1)
    drawn = np.random.default_rng(seed).choice(len(sentences), count, p=chance / chance.sum())
    return [sentences[i] for i in drawn]


@dataclass
class Timed:
    """What became of the searches: seconds from when each should have begun, and what failed."""

    seconds: list[float] = field(default_factory=list)
    failures: list[str] = field(default_factory=list)
    took: float = 0.0


async def load(port: int, sentences: list[str], rate: float) -> Timed:
    """Ask over connections that are kept open, `rate` times a second on average."""
    found, loop = Timed(), asyncio.get_running_loop()
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
                found.failures.append(body[:200].decode(errors="replace"))
            found.seconds.append(loop.time() - should_begin)
        except (OSError, asyncio.IncompleteReadError) as error:
            found.failures.append(repr(error))
        finally:
            free.put_nowait((reader, writer))

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
    found.took = loop.time() - began
    return found


@dataclass(frozen=True)
class Usage:
    """What a process has used: seconds of processor, and MB of memory, its own and of mapped files."""

    cpu: float
    own: float
    mapped: float

    @classmethod
    def of(cls, pid: int) -> Usage:
        fields = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()
        status = dict(line.split(":", 1) for line in Path(f"/proc/{pid}/status").read_text().splitlines())
        own, mapped = (int(status[name].split()[0]) / 1e3 for name in ("RssAnon", "RssFile"))
        return cls((int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK"), own, mapped)


def recall(folder: Path, sentences: list[str], k: int = 10) -> float:
    """Share of the answers an exact search gives that are given."""
    with SearchableLibrary.open(folder) as library:
        given = [{hit.clip_id for hit in library.search(sentence, k)} for sentence in sentences]
        for kind in (CLIPS, WINDOWS):
            index = library._galleries.current(kind, library.connection)
            index.main = Block.of(index.rows)
        exact = [{hit.clip_id for hit in library.search(sentence, k)} for sentence in sentences]
    return float(np.mean([len(a & b) / len(b) for a, b in zip(given, exact, strict=True)]))


def command(*arguments: object) -> subprocess.Popen[bytes]:
    """Run `motionseek` with this process's model."""
    program = f"import encoders.bundle, pathlib; encoders.bundle.DEFAULT = pathlib.Path({str(bundles.DEFAULT)!r}); "
    program += "from search.cli import main; main()"
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


def new_share(sentences: list[str], earlier: list[str]) -> float:
    """Share of the searches whose sentence nobody had asked before."""
    return len(set(sentences) - set(earlier)) / len(sentences)


def report(found: Timed, before: Usage, after: Usage, new: float) -> None:
    """Print the figures."""
    ms = np.array(found.seconds) * 1e3
    answered = len(ms)
    print(
        f"{answered} searches in {found.took:.1f} s: {answered / found.took:.0f} a second, "
        f"{new:.1%} of them sentences that nobody had asked before"
    )
    print(
        "latency ms: " + ", ".join(f"p{p} {np.percentile(ms, p):.1f}" for p in (50, 95, 99)) + f", max {ms.max():.0f}"
    )
    print(f"failures: {len(found.failures)} {found.failures[:2] or ''}")
    print(f"server: {(after.cpu - before.cpu) / answered * 1e3:.2f} ms of processor a search")
    print(f"memory MB: own {before.own:.0f} -> {after.own:.0f}, mapped files {before.mapped:.0f} -> {after.mapped:.0f}")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--around", type=Path, required=True, help="a real library")
    parser.add_argument("--library", type=Path, required=True, help="where the simulated one is kept, or is already")
    parser.add_argument("--clips", type=int, default=100_000)
    parser.add_argument("--noise", type=float, default=0.5, help="how far clips are moved; their vectors have length 1")
    parser.add_argument("--rate", type=float, default=200)
    parser.add_argument("--minutes", type=float, default=1 / 3)
    parser.add_argument("--port", type=int, default=8765)
    parser.add_argument("--while-indexing", type=Path, help="index this folder into the library meanwhile")
    parser.add_argument("--bundle", type=Path, default=bundles.DEFAULT, help="the model of both libraries")
    parser.add_argument("--before", type=int, default=4000, help="searches that were asked before")
    parser.add_argument("--recall", type=int, default=50, help="questions asked of an exact search too")
    given = parser.parse_args()
    bundles.DEFAULT = given.bundle.resolve()
    if not (given.library / FILE).exists():
        began = time.perf_counter()
        simulate(given.library, given.around, given.clips, given.noise)
        print(f"simulated in {time.perf_counter() - began:.0f} s")
    began = time.perf_counter()
    with Library.open(given.library) as library:
        library.prepare()
        stats = library.stats()
    print(f"{stats['clips']} clips, {stats['windows']} windows; indexes ready in {time.perf_counter() - began:.0f} s")
    if given.recall:
        print(f"recall of the exact ten: {recall(given.library, all_sentences()[: given.recall]):.3f}")
    server = serve(given.library, given.port)
    indexing = None
    try:
        earlier = asked(given.before, 5)
        asyncio.run(load(given.port, earlier, 0))
        if given.while_indexing:
            indexing = command("index", given.while_indexing, "--library", given.library, "--jobs", 1)
        sentences = asked(round((given.rate or 300) * 60 * given.minutes), 4)
        before = Usage.of(server.pid)
        found = asyncio.run(load(given.port, sentences, given.rate))
        report(found, before, Usage.of(server.pid), new_share(sentences, earlier))
    finally:
        for process in filter(None, (indexing, server)):
            process.send_signal(signal.SIGINT)
            process.wait(30)


if __name__ == "__main__":
    main()
