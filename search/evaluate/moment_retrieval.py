"""How well moments are found: ours beside the paper's way, on the same takes with the same model.

The answer is right at a threshold if its intersection over union with any true span reaches it. Figures are those of
the literature: accuracy of the first answer at IoU 0.1 to 0.9, recall of the first k, mean IoU, and mean average
precision over IoU 0.1 to 0.7. The ceiling is what the best window of the library's grid could reach.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable, Iterable
from typing import cast

import numpy as np

from encoders.bundle.windows import grid
from encoders.corpus.composition.long_takes import AnnotatedTake
from encoders.protocol import Encoder
from search.evaluate.library_moments import Gallery
from search.evaluate.moment_metrics import Overlaps, Spans, best_overlaps
from search.evaluate.moments_baseline import SIZES, best_of
from search.evaluate.sequence_questions import ask_in_order, draw_steps
from search.evaluate.sequence_questions import figures as in_order
from search.evaluate.window_cache import CachedBundle
from search.moments.boundaries import CURVE_LENGTHS
from search.moments.one_take import find
from search.moments.window_scores import Vectors
from search.query.encoding import encode_queries
from search.query.question import Question
from search.source import MotionSource

_ANSWERS = 10
_ORDERED = 2  # questions in three steps for each take


def evaluate_moments(
    takes: Iterable[AnnotatedTake],
    bundle: Encoder,
    *,
    steps: bool = False,
    progress: Callable[[int], None] | None = None,
) -> dict[str, dict[str, float]]:
    """Every marked sentence of every take is asked of its take, and then of all takes at once.

    Parameters
    ----------
    steps : bool
        Whether to ask for three things that follow one another too, twice a take.
    progress : callable, optional
        Called with the number of takes asked so far.

    Returns
    -------
    dict
        Figures by way: "motionseek", the paper's "window of 20", "40", "60" frames and "best of the three", the
        "ceiling of the grid"; the first and the best of the three also for sentences about unseen actions, where there
        are some; "motionseek, all takes at once", where any take of which a sentence is true counts, "..., its own
        take"; and "three steps in order".
    """
    ways: dict[str, Overlaps] = defaultdict(Overlaps)
    remembering = CachedBundle(bundle)
    encoder = cast(Encoder, remembering)
    gallery, ordered, rng = Gallery(encoder), list[float](), np.random.default_rng(0)
    kept = {round(seconds * bundle.fps) for seconds in CURVE_LENGTHS}
    for number, take in enumerate(takes, start=1):
        source = MotionSource.of_motion(take.motion)
        queries = encode_queries(bundle, [marked.sentence for marked in take.annotations])
        _ask(ways, bundle, encoder, source, take, queries)
        if steps:
            ordered += [ask_in_order(encoder, source, take, run) for run in draw_steps(take, rng, _ORDERED)]
        gallery.add(take, source, queries)
        remembering.forget(but=kept)
        if progress is not None:
            progress(number)
    ways["motionseek, all takes at once"], ways["motionseek, all takes at once, its own take"] = gallery.ask(_ANSWERS)
    figures = {name: overlaps.figures() for name, overlaps in ways.items()}
    return figures | ({"three steps in order": in_order(ordered)} if ordered else {})


def _ask(
    ways: dict[str, Overlaps],
    bundle: Encoder,
    encoder: Encoder,
    source: MotionSource,
    take: AnnotatedTake,
    queries: Vectors,
) -> None:
    """All sentences of one take, in every way."""
    windows = _grid_spans(len(source.features(encoder)), bundle.fps)
    slid = best_of(bundle, take.motion, queries)
    for marked, query, paper in zip(take.annotations, queries, slid, strict=True):
        found = find(encoder, source, Question((marked.sentence,)), query[None], _ANSWERS)
        ours = [(moment.start, moment.end) for moment, _ in found]
        best = [(paper[0].start, paper[0].end)]
        ways["motionseek"].add(ours, marked.spans)
        for size in SIZES:
            ways[f"window of {size}"].add([(paper[size].start, paper[size].end)], marked.spans)
        ways["best of the three"].add(best, marked.spans)
        ways["ceiling of the grid"].rows.append(best_overlaps(windows, marked.spans).max(keepdims=True))
        if marked.held_out:
            ways["motionseek, unseen actions"].add(ours, marked.spans)
            ways["best of the three, unseen actions"].add(best, marked.spans)


def _grid_spans(frames: int, fps: float) -> Spans:
    return [
        (float(start / fps), float((start + size) / fps))
        for starts, size in grid(frames, fps).values()
        for start in starts
    ]
