"""A sentence against a large library: time and recall of the search, with filters, exact, and as a whole request.

    python -m benchmarks.scale SIMULATED [--around REAL --clips N] [--queries 40]

SIMULATED is written around REAL where it does not exist yet: see `benchmarks.simulated`. Every time is for one query on
one thread after encoding, by the clock and on the processor, which on a busy machine says more; the plain way is a flat
scan of float32 by NumPy. Recall is the share of the ten best clips, as search ranks them, that an exact search finds.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Callable, Sequence
from itertools import pairwise
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from benchmarks.simulated import all_sentences, simulate
from indexer.store.library_reader import FILE
from indexer.vectors.library_indexes import WINDOWS
from search.library import Library
from search.query.amounts import amounts_of
from search.query.encoding import encode_queries
from search.query.question import EncodedQuestion
from search.ranking.clip_scores import best_clips
from search.ranking.galleries import ExactGallery

_SHARES = (1.0, 0.1, 0.01, 0.001)
_PIECE = 1 << 14


def times(calls: Sequence[Callable[[], object]]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Milliseconds of each call, by the clock and on the processor."""
    marks = [(time.perf_counter(), time.thread_time())]
    for call in calls:
        call()
        marks.append((time.perf_counter(), time.thread_time()))
    wall, cpu = np.array([np.subtract(after, before) for before, after in pairwise(marks)]).T * 1e3
    return wall, cpu


def shown(name: str, measured: tuple[NDArray[np.float64], NDArray[np.float64]], more: str = "") -> None:
    """Print a row: the median and the 95th percentile by the clock, the same on the processor."""
    numbers = [f"{np.percentile(ms, p):10.2f}" for ms in measured for p in (50, 95)]
    print(f"{name:<44}{''.join(numbers)}  {more}", flush=True)


def chosen(ids: NDArray[np.int64], share: float) -> NDArray[np.int64] | None:
    """A random share of the clips; None for all."""
    if share == 1:
        return None
    return np.sort(np.random.default_rng(0).choice(ids, max(round(len(ids) * share), 1), replace=False))


def measure(folder: Path, count: int) -> None:
    """Print every row for one library."""
    with Library.open(folder) as library:
        stats = library.stats()
        print(f"{stats['clips']:,} clips, {stats['windows']:,} windows; {stats['vector_index']}")
        # Counts and degrees are measured on poses, which a simulated library lacks.
        sentences = [sentence for sentence in all_sentences() if not amounts_of(sentence)][:count]
        queries = encode_queries(library.bundle, sentences)
        questions = [EncodedQuestion(query[None], (text,)) for query, text in zip(queries, sentences, strict=True)]
        library.prepare()
        best_clips(library, queries[0], 10)
        print(f"{'milliseconds':<44}{'p50':>10}{'p95':>10}{'CPU p50':>10}{'CPU p95':>10}")
        bare = times([lambda q=q: best_clips(library, q, 10) for q in queries])
        for share in _SHARES:
            allowed = chosen(library.ids(), share)
            found: list[list[int]] = []
            wanted: list[list[int]] = []

            def search(query: NDArray[np.float32], found: list[list[int]] = found, allowed=allowed) -> None:  # type: ignore[no-untyped-def]
                found.append([score.clip_id for score in best_clips(library, query, 10, allowed=allowed)])

            def exactly(query: NDArray[np.float32], wanted: list[list[int]] = wanted, allowed=allowed) -> None:  # type: ignore[no-untyped-def]
                wanted.append(
                    [score.clip_id for score in best_clips(ExactGallery(library), query, 10, allowed=allowed)]
                )

            taken = times([lambda q=q: search(q) for q in queries])
            exact = times([lambda q=q: exactly(q) for q in queries])
            recall = np.mean([len({*f} & {*w}) / max(len(w), 1) for f, w in zip(found, wanted, strict=True)])
            shown(f"bare search, {share:.1%} of the clips", taken, f"recall@10 {recall:.3f}")
            shown("  the same, exact", exact)
        whole = times([lambda q=q: library.search_encoded(q, 10) for q in questions])
        tenth = times([lambda q=q: library.search_encoded(q, 10, path="take 00*") for q in questions])
        shown(
            "whole request, hits with their metadata", whole, f"{np.median(whole[1]) / np.median(bare[1]):.2f} x bare"
        )
        shown("whole request, of the folders take 00*", tenth)
        scan(library, queries)


def scan(library: Library, queries: NDArray[np.float32]) -> None:
    """All windows, at most a million: read once, compared exactly, and by NumPy, in turns."""
    with library.reading() as connection:
        block = library.indexes.current(WINDOWS, connection).main
    pieces, rows = [], 0
    for _, vectors in block.pieces():
        pieces.append(vectors)
        rows += len(vectors)
        if rows >= 1_000_000:
            break
    flat = np.concatenate(pieces)
    from indexer.vectors.blocks import Block, IndexRows

    index = Block.of(IndexRows(np.arange(rows), np.zeros((rows, 2), np.float32), flat))
    words = flat.view(np.uint64)

    def plain(query: NDArray[np.float32]) -> None:
        scores = [flat[i : i + _PIECE].astype(np.float32) @ query for i in range(0, rows, _PIECE)]
        np.argpartition(np.concatenate(scores), -10)

    found = []
    for query in queries[:8]:
        calls = (lambda: words.max(), lambda q=query: index.search(q[None], 10, None), lambda q=query: plain(q))
        found.append(np.stack(times(calls)))
    read, exact, numpy = np.min(found, axis=0)[1]
    print(
        f"{rows:,} windows: read once {read:.0f} ms, exact search {exact:.0f} ms ({exact / read:.2f} x), "
        f"NumPy {numpy:.0f} ms ({numpy / exact:.1f} x exact), on the processor"
    )


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("library", type=Path)
    parser.add_argument("--around", type=Path, help="a real library")
    parser.add_argument("--clips", type=int, default=100_000)
    parser.add_argument("--queries", type=int, default=40)
    given = parser.parse_args()
    if not (given.library / FILE).exists() and given.around is not None:
        simulate(given.library, given.around, given.clips, 0.5)
    measure(given.library, given.queries)


if __name__ == "__main__":
    main()
