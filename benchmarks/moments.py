"""Speed and memory of moments: speed-ups over encoding every window alone, peak memory, milliseconds a query.

    python -m benchmarks.moments dense     a take of 10 minutes, against every window alone in torch (needs torch)
    python -m benchmarks.moments memory    peak memory of the command on a file of 2 hours
    python -m benchmarks.moments library   the best windows of 100 hours, once the sentence is encoded

Times are processor time on one thread, except for the whole command, so that other programs do not count.
"""

from __future__ import annotations

import argparse
import resource
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from itertools import islice
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from encoders.bundle.bundle import Bundle
from encoders.bundle.windows import LENGTHS as GRID_LENGTHS
from encoders.bundle.windows import WINDOWS_A_LENGTH, window_starts
from encoders.motion import Motion
from indexer.ingest.load import load_motion
from indexer.vectors.blocks import IndexRows, SearchResult
from indexer.vectors.faiss_index import FaissIndex
from search.moments.localisation import rank_moments
from search.moments.queried_motion import QueriedMotion
from search.moments.window_scores import join, score_windows
from search.query.encoding import encode_queries
from search.query.question import EncodedQuestion
from search.ranking.window_ranking import rank_windows
from search.source import MotionSource
from search.spans import temporal_iou

#: Seconds of the windows that are encoded beside those of the grid.
_DENSE_LENGTHS = (2.0, 2.8, 4.0)
DEMO = Path(__file__).resolve().parent.parent / "search" / "demo_data"
SENTENCES = ("a person kicks", "a person sits down", "someone climbs a ladder", "a person jumps", "walking backwards")


def long_take(seconds: float) -> Motion:
    """The demo's clips one after the other, then mirrored, over and over."""
    clips = [load_motion(path) for path in sorted(DEMO.glob("take_*.bvh"))]
    once = np.concatenate([clip.joints for clip in (*clips, *(clip.mirror() for clip in clips))])
    frames = round(seconds * 20)
    return Motion(np.resize(once, (frames, *once.shape[1:])))


def dense(seconds: float = 600.0, alone: int = 200) -> None:
    """Moments of a take against encoding every window of every length at every frame."""
    import torch

    from encoders.tmr.model.network import TMR
    from encoders.tmr.training.recipe import default_network

    torch.set_num_threads(1)
    bundle = Bundle.load(threads=1)
    motion = long_take(seconds)
    features = bundle.features(motion)
    queries = encode_queries(bundle, SENTENCES)
    lengths = sorted({round(length * bundle.fps) for length in (*_DENSE_LENGTHS, *GRID_LENGTHS)})
    starts = {length: window_starts(len(features), length) for length in lengths}
    windows = [(int(start), length) for length in lengths for start in starts[length]]
    network = TMR(default_network(features.shape[1], 384)).motion_encoder.eval()
    chosen = windows[:: max(1, len(windows) // alone)]
    began = time.process_time()
    with torch.inference_mode():
        for start, length in chosen:
            window = torch.from_numpy(features[None, start : start + length])
            network.mean(window, torch.ones(1, length, dtype=torch.bool))
    plain = (time.process_time() - began) / len(chosen) * len(windows)
    print(f"{motion.duration:.0f} s, {len(windows)} windows of {[n / bundle.fps for n in lengths]} s at every frame")
    print(f"each alone in torch fp32, one thread (timed on {len(chosen)}): {plain:.1f} s")

    began = time.process_time()
    scores = join([score_windows(bundle, features, starts[length], length, queries) for length in lengths])
    batched = time.process_time() - began
    print(f"all of them in batches: {batched:.2f} s, {plain / batched:.0f} times as fast")
    fresh, indexed, overlaps = [], [], []
    for i, query in enumerate(queries):
        question = EncodedQuestion(query[None])
        source = MotionSource.of_motion(motion)
        source.features(bundle)
        for times in (fresh, indexed):  # the second time the windows of the grid are there, as in a library
            began = time.process_time()
            found = next(rank_moments(QueriedMotion(bundle, source, question)))
            times.append(time.process_time() - began)
        alone_scores = type(scores)(scores.starts, scores.ends, scores.scores[i : i + 1])
        truth = next(rank_moments(QueriedMotion(bundle, source, question), alone_scores))
        overlap = float(temporal_iou([found.start], [found.end], truth.start, truth.end)[0])
        overlaps.append((overlap, found.score - truth.score))
    for name, times in (("a file", fresh), ("an indexed clip", indexed)):
        taken = float(np.median(times))
        print(f"moments in {name}: {taken:.3f} s a sentence, {plain / taken:.0f} times as fast")
    print(f"overlap with the answer of all windows, and score over its score: {np.round(overlaps, 3).tolist()}")


def memory(seconds: float = 7200.0) -> None:
    """Peak memory of `motionseek moments` on a long file."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "two hours.npy"
        np.save(path, long_take(seconds).joints)
        code = "from search.cli.main import main; import sys; main(sys.argv[1:])"
        began = time.perf_counter()
        subprocess.run([sys.executable, "-c", code, "moments", "a person jumps", str(path), "-k", "3"], check=True)
        peak = resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss / 1024
        print(f"{seconds / 3600:g} hours: peak memory {peak:.0f} MB, {time.perf_counter() - began:.1f} s")


class SimulatedGallery:
    """The windows of a library of `hours` hours, with vectors near the given ones (N, D)."""

    def __init__(self, hours: float, vectors: NDArray[np.float32], seed: int = 0) -> None:
        rng = np.random.default_rng(seed)
        parts = []
        for length in GRID_LENGTHS:
            starts = np.arange(0, hours * 3600 - length, length / WINDOWS_A_LENGTH)
            owners = (starts // 60).astype(np.int64)  # a clip a minute
            noisy = vectors[rng.integers(len(vectors), size=len(starts))]
            noisy = noisy + rng.standard_normal(noisy.shape, dtype=np.float32) * 0.03
            noisy /= np.linalg.norm(noisy, axis=1, keepdims=True)
            spans = np.stack([starts % 60, starts % 60 + length], axis=1).astype(np.float32)
            parts.append(IndexRows(owners, spans, noisy.astype(np.float16)))
        self._index = FaissIndex.of(1, IndexRows.join(parts))
        self._count = sum(map(len, parts))

    def __len__(self) -> int:
        return self._count

    def nearest_windows(
        self, queries: NDArray[np.float32], k: int, *, allowed: NDArray[np.int64] | None = None
    ) -> SearchResult:
        """See `indexer.store.stored_library.StoredLibrary.nearest_windows`."""
        return self._index.search(queries, k, allowed=allowed)


def library(hours: float = 100.0, count: int = 200) -> None:
    """The ten best windows of many hours, of which no two overlap."""
    bundle = Bundle.load()
    features = bundle.features(long_take(300))
    gallery = SimulatedGallery(hours, bundle.encode_windows(features, window_starts(len(features), 16, 2), 16))
    queries = encode_queries(bundle, SENTENCES)
    times = []
    for i in range(count):
        began = time.process_time()
        list(islice(rank_windows(gallery, queries[i % len(queries)]), 10))
        times.append(1000 * (time.process_time() - began))
    median, late = np.percentile(times, [50, 95])
    print(f"{hours:g} hours, {len(gallery)} windows: median {median:.1f} ms, p95 {late:.1f} ms a query")


MEASURES: dict[str, Callable[[], None]] = {"dense": dense, "memory": memory, "library": library}


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("measure", choices=MEASURES)
    MEASURES[parser.parse_args().measure]()


if __name__ == "__main__":
    main()
