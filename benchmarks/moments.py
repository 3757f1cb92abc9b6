"""How fast and how frugal moments are.

python benchmarks/moments.py dense     10 minutes against encoding every window alone in torch (needs torch)
python benchmarks/moments.py memory    2 hours of motion, peak memory of the command
python benchmarks/moments.py library   100 hours of windows, milliseconds a query once its sentence is encoded

Times are those of the processor on one thread, but for the whole command, so that other work beside it does not count.
"""

from __future__ import annotations

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
from encoders.bundle.windows import LENGTHS as STORED
from encoders.bundle.windows import WINDOWS_A_LENGTH, window_starts
from encoders.motion import Motion
from indexer.ingest.load import load_motion
from indexer.vectors.flat import FlatVectors, Found, Rows
from search.moments.localisation import rank_moments
from search.moments.queried_motion import QueriedMotion
from search.moments.window_scores import CURVE_LENGTHS, WindowScores, join, score_windows
from search.query.encoding import encode_queries
from search.query.question import EncodedQuestion
from search.ranking.clip_scores import rank_windows
from search.source import MotionSource
from search.spans import Moment, temporal_iou

DEMO = Path(__file__).resolve().parent.parent / "search" / "demo_data"
SENTENCES = ("a person kicks", "a person sits down", "someone climbs a ladder", "a person jumps", "walking backwards")


def long_take(seconds: float) -> Motion:
    """The demo's clips one after the other, then mirrored, over and over."""
    clips = [load_motion(path) for path in sorted(DEMO.glob("take_*.bvh"))]
    once = np.concatenate([clip.joints for clip in (*clips, *(clip.mirror() for clip in clips))])
    frames = round(seconds * 20)
    return Motion(np.resize(once, (frames, *once.shape[1:])))


def dense(seconds: float = 600.0, alone: int = 200) -> None:
    """Similarity over all of a 10-minute take, and the moments in it, against encoding every window alone in torch."""
    import torch

    from encoders.tmr.model.network import TMR
    from encoders.tmr.training.recipe import default_network

    torch.set_num_threads(1)
    bundle = Bundle.load(threads=1)
    motion = long_take(seconds)
    features = bundle.features(motion)
    queries = encode_queries(bundle, SENTENCES)
    lengths = sorted({round(length * bundle.fps) for length in (*CURVE_LENGTHS, *STORED)})
    windows = [(int(start), size) for size in lengths for start in window_starts(len(features), size)]
    network = TMR(default_network(features.shape[1], 384)).motion_encoder.eval()
    chosen = windows[:: max(1, len(windows) // alone)]
    began = time.process_time()
    with torch.inference_mode():
        for start, size in chosen:
            window = torch.from_numpy(features[None, start : start + size])
            network.mean(window, torch.ones(1, size, dtype=torch.bool))
    plain = (time.process_time() - began) / len(chosen) * len(windows)
    print(f"{motion.duration:.0f} s, {len(windows)} windows of {[s / bundle.fps for s in lengths]} s at every frame")
    print(f"each alone in torch fp32, one thread (timed on {len(chosen)}): {plain:.1f} s")

    began = time.process_time()
    full = [score_windows(bundle, features, window_starts(len(features), s), s, queries) for s in lengths]
    batched = time.process_time() - began
    print(f"all of them in batches: {batched:.2f} s, {plain / batched:.0f} times as fast")
    source = MotionSource.of_motion(motion)
    source.features(bundle)
    dense_answers = [_from_everything(bundle, source, queries, i, full) for i in range(len(SENTENCES))]
    fresh, stored, overlaps = [], [], []
    for i, truth in enumerate(dense_answers):
        new = MotionSource.of_motion(motion)  # its windows are not encoded yet
        new.features(bundle)
        queried = QueriedMotion(bundle, new, EncodedQuestion(queries[i : i + 1]))
        began = time.process_time()
        new.windows(bundle)
        encoded = time.process_time()
        found = next(rank_moments(queried))
        ended = time.process_time()
        fresh.append(ended - began)
        stored.append(ended - encoded)
        overlap = float(temporal_iou([found.start], [found.end], truth.start, truth.end)[0])
        overlaps.append((overlap, found.score - truth.score))
    for name, times in (("a file", fresh), ("an indexed clip", stored)):
        taken = float(np.median(times))
        print(f"moments in {name}: {taken:.3f} s a sentence, {plain / taken:.0f} times as fast")
    print(f"overlap with the answer out of all windows, and score over its score: {np.round(overlaps, 3).tolist()}")


def _from_everything(
    bundle: Bundle, source: MotionSource, queries: NDArray[np.float32], i: int, full: list[WindowScores]
) -> Moment:
    """The answer where every window is a candidate."""
    scored = [WindowScores(s.starts, s.ends, s.scores[i : i + 1]) for s in full]
    return next(rank_moments(QueriedMotion(bundle, source, EncodedQuestion(queries[i : i + 1])), join(scored)))


def memory(seconds: float = 7200.0) -> None:
    """Peak memory of `motionseek moments` on a file of 2 hours."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "two hours.npy"
        np.save(path, long_take(seconds).joints)
        code = "from search.cli.main import main; import sys; main(sys.argv[1:])"
        began = time.perf_counter()
        subprocess.run([sys.executable, "-c", code, "moments", "a person jumps", str(path), "-k", "3"], check=True)
        peak = resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss / 1024
        print(f"{seconds / 3600:g} hours: peak memory {peak:.0f} MB, {time.perf_counter() - began:.1f} s")


class Simulated:
    """As much of a library as a question about windows needs."""

    def __init__(self, hours: float, vectors: NDArray[np.float32], seed: int = 0) -> None:
        rng = np.random.default_rng(seed)
        parts = []
        for length in STORED:
            starts = np.arange(0, hours * 3600 - length, length / WINDOWS_A_LENGTH)
            owners = (starts // 60).astype(np.int64)  # a clip a minute
            noisy = vectors[rng.integers(len(vectors), size=len(starts))]
            noisy = noisy + rng.standard_normal(noisy.shape, dtype=np.float32) * 0.03
            noisy /= np.linalg.norm(noisy, axis=1, keepdims=True)
            spans = np.stack([starts % 60, starts % 60 + length], axis=1).astype(np.float32)
            parts.append(Rows(owners, spans, noisy.astype(np.float16)))
        self.index = FlatVectors.of(1, Rows.join(parts))
        self.count = sum(map(len, parts))

    def __len__(self) -> int:
        return self.count

    def nearest_windows(
        self, queries: NDArray[np.float32], k: int, *, allowed: NDArray[np.int64] | None = None
    ) -> Found:
        """See `indexer.store.stored_library.Library.nearest_windows`."""
        return self.index.search(queries, k, allowed=allowed)


def library(hours: float = 100.0, queries: int = 200) -> None:
    """The best moments over 100 hours, once the sentence is encoded."""
    bundle = Bundle.load()
    features = bundle.features(long_take(300))
    real = bundle.encode_windows(features, window_starts(len(features), 16, 2), 16)
    simulated = Simulated(hours, real)
    asked = encode_queries(bundle, SENTENCES)
    times = []
    for i in range(queries):
        began = time.process_time()
        list(islice(rank_windows(simulated, asked[i % len(asked)]), 10))
        times.append(1000 * (time.process_time() - began))
    middle, late = np.percentile(times, [50, 95])
    print(f"{hours:g} hours, {len(simulated)} windows: median {middle:.1f} ms, p95 {late:.1f} ms a query")


if __name__ == "__main__":
    measures: dict[str, Callable[[], None]] = {"dense": dense, "memory": memory, "library": library}
    measures[sys.argv[1]]()
