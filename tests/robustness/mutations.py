"""Files that were changed at random: a motion or a reason, in bounded time and memory."""

from __future__ import annotations

import multiprocessing
import os
import random
import re
import resource
import tempfile
import time
from collections.abc import Callable, Iterator, Sequence
from multiprocessing.connection import Connection
from pathlib import Path

import numpy as np

from encoders.errors import UnreadableMotion
from indexer.ingest import caption_files
from indexer.ingest.load import read_motions
from tests.robustness.example_files import Example, examples, write

#: What a file may take: seconds, and bytes of memory of its process; below that of `worker_limits`.
SECONDS, MEMORY = 10.0, 600 << 20
_LIMIT = 1 << 30
_CAPTIONS = (".csv", ".tsv", ".jsonl", ".txt")
_HUGE = (b"1e308", b"-1e308", b"99999999999", b"-1", b"4294967295", b"9" * 400, b"nan", b"inf", b"0", b"1e-300", b"1e9")

Mutation = Callable[[random.Random, bytearray], None]


def flip_bits(rng: random.Random, data: bytearray) -> None:
    for _ in range(rng.choice((1, 1, 2, 8, 64))):
        data[rng.randrange(len(data))] ^= 1 << rng.randrange(8)


def truncate(rng: random.Random, data: bytearray) -> None:
    del data[rng.randrange(len(data)) :]


def repeat(rng: random.Random, data: bytearray) -> None:
    first = rng.randrange(len(data))
    chunk = data[first : first + rng.choice((4, 40, 400, 4000))]
    data[first:first] = chunk * rng.choice((1, 1, 10, 200))


def cut_out(rng: random.Random, data: bytearray) -> None:
    first = rng.randrange(len(data))
    del data[first : first + rng.choice((1, 4, 40, 400))]


def put_huge_numbers(rng: random.Random, data: bytearray) -> None:
    """Numbers of a text, and four or eight bytes of any file, become huge or none."""
    numbers = [match.span() for match in re.finditer(rb"-?\d+(\.\d+)?", data)]
    for _ in range(rng.choice((1, 1, 3))):
        if numbers and rng.random() < 0.7:
            first, last = rng.choice(numbers[: rng.choice((20, len(numbers)))])
            data[first:last] = rng.choice(_HUGE)
            numbers = [span for span in numbers if span[1] <= first]
        else:
            size = rng.choice((2, 4, 8))
            first = rng.randrange(max(1, rng.choice((64, 512, len(data)))))
            data[first : first + size] = rng.choice((b"\xff", b"\x7f", b"\0")) * size


def delete_tokens(rng: random.Random, data: bytearray) -> None:
    tokens = [match.span() for match in re.finditer(rb"\w+|[{}\[\]()<>:,;]", data)]
    for first, last in sorted(rng.sample(tokens, min(len(tokens), rng.choice((1, 1, 3)))), reverse=True):
        del data[first:last]


def swap(rng: random.Random, data: bytearray) -> None:
    """A piece of the file stands in another place, too."""
    size = rng.choice((1, 8, 64))
    first, other = rng.randrange(len(data)), rng.randrange(len(data))
    data[first : first + size] = data[other : other + size]


MUTATIONS: Sequence[Mutation] = (flip_bits, truncate, repeat, cut_out, put_huge_numbers, delete_tokens, swap)


def mutated(example: Example, seed: int) -> Example:
    """An example one of whose files has been changed once or more often."""
    rng = random.Random(seed)
    name = next(iter(example.files))
    data = bytearray(example.files[name])
    for _ in range(rng.choice((1, 1, 2))):
        if data:
            rng.choice(MUTATIONS)(rng, data)
    return Example(example.read, {**example.files, name: bytes(data)})


def run(seeds: range) -> Iterator[tuple[str, str]]:
    """Trials: the kind of each file, and what was wrong, empty where nothing was.

    They run in a process of limited memory, which is started again where one ends it.
    """
    forking = multiprocessing.get_context("forkserver")
    kinds, left = list(examples()), list(seeds)
    while left:
        end, its = forking.Pipe(duplex=False)
        process = forking.Process(target=_serve, args=(left, its))
        process.start()
        its.close()
        try:
            while left:
                if not end.poll(6 * SECONDS):
                    process.kill()
                    yield kinds[left.pop(0) % len(kinds)], f"takes more than {6 * SECONDS:.0f} s"
                    break
                answer = end.recv()
                yield kinds[left.pop(0) % len(kinds)], answer
        except EOFError:
            process.join()
            yield kinds[left.pop(0) % len(kinds)], f"its process ends with code {process.exitcode}"
        process.join()


def _serve(seeds: list[int], end: Connection) -> None:
    resource.setrlimit(resource.RLIMIT_DATA, (_LIMIT, _LIMIT))
    found = examples()
    kinds = list(found)
    with tempfile.TemporaryDirectory() as scratch:
        for seed in seeds:
            folder = Path(scratch) / str(seed)
            folder.mkdir()
            end.send(_trial(write(mutated(found[kinds[seed % len(kinds)]], seed), folder)))


def _trial(path: Path) -> str:
    Path("/proc/self/clear_refs").write_text("5")  # the peak begins anew
    began = time.monotonic()
    try:
        _read(path)
    except UnreadableMotion as error:
        if not error.reason or "\n" in error.reason or len(error.reason) > 1000:
            return f"no reason in a line: {error.reason[:80]!r}"
    except Exception as error:
        return f"{type(error).__name__}: {str(error)[:200]}"
    seconds, memory = time.monotonic() - began, _peak()
    if seconds > SECONDS:
        return f"takes {seconds:.1f} s"
    return f"takes {memory >> 20} MB" if memory > MEMORY else ""


def _read(path: Path) -> None:
    if path.name == "a.txt":
        caption_files.read_lines(path, lambda warning: None)
    elif path.suffix in _CAPTIONS:
        caption_files.read_table(path, "", lambda warning: None)
    else:
        for clip in read_motions(os.fspath(path)):
            assert np.isfinite(clip.motion.joints).all()
            assert clip.motion.joints.shape[1:] == (22, 3)


def _peak() -> int:
    """Bytes of memory that this process has had at once."""
    status = Path("/proc/self/status").read_text()
    return int(status.split("VmHWM:")[1].split()[0]) << 10
