"""Baseline for moments, as in the TMR paper: a window of one size slides over the take, the most similar one wins.

Petrovich, Black and Varol, "TMR: Text-to-Motion Retrieval Using Contrastive 3D Human Motion Synthesis" (ICCV 2023),
section 4.5: windows of 20, 40 and 60 frames at 20 frames a second, one at every frame, without refinement.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from encoders.bundle.windows import window_starts
from encoders.motion import FPS, Motion
from encoders.protocol import Encoder
from search.moments.window_scores import Vectors, WindowScores, join, score_windows
from search.spans import Moment

SIZES = (20, 40, 60)


def slide(encoder: Encoder, motion: Motion, queries: Vectors, size: int) -> WindowScores:
    """Scores of windows of `size` frames at 20 frames a second, one at every frame, for queries (Q, D).

    For a model with fewer feature frames a second the take is encoded once for each phase between two of its frames.
    """
    motion = motion.resample(FPS)
    length = max(round(size / FPS * encoder.fps), 1)
    parts = []
    for phase in range(min(max(round(FPS / encoder.fps), 1), len(motion))):
        features = encoder.features(Motion(motion.joints[phase:], FPS))
        if phase and len(features) < length:
            break
        fitting = min(length, len(features))
        found = score_windows(encoder, features, window_starts(len(features), fitting), fitting, queries)
        parts.append(WindowScores(found.starts + phase / FPS, found.ends + phase / FPS, found.scores))
    windows = join(parts)
    order = np.argsort(windows.starts, kind="stable")
    return WindowScores(windows.starts[order], windows.ends[order], windows.scores[:, order])


def best_place(windows: WindowScores, query: int = 0) -> Moment:
    """The window most similar to a query, by the query's number."""
    i = int(np.argmax(windows.scores[query]))
    return Moment(float(windows.starts[i]), float(windows.ends[i]), float(windows.scores[query, i]))


def best_of(
    encoder: Encoder, motion: Motion, queries: Vectors, sizes: Sequence[int] = SIZES
) -> list[dict[int, Moment]]:
    """For each query (Q, D), the best window by size in frames, and under 0 the best of all sizes."""
    slid = {size: slide(encoder, motion, queries, size) for size in sizes}
    answers = []
    for query in range(len(queries)):
        found = {size: best_place(windows, query) for size, windows in slid.items()}
        answers.append(found | {0: max(found.values(), key=lambda moment: moment.score)})
    return answers
