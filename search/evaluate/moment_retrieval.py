"""Moment retrieval: how well moments are found, beside the sliding windows of the TMR paper with the same model.

An answer is right at a threshold if its intersection over union with any true span reaches it. Figures are those of
the literature: accuracy of the first answer at IoU 0.1 to 0.9, recall of the first k, mean IoU, and mean average
precision over IoU 0.1 to 0.7. The upper bound of the grid is what its best window could reach.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable, Iterable
from itertools import islice

import numpy as np
from numpy.typing import NDArray

from encoders.bundle.windows import grid
from encoders.corpus.composition.long_takes import AnnotatedTake
from encoders.protocol import Encoder
from search.evaluate.library_moments import TakeGallery
from search.evaluate.moment_metrics import Overlaps, Spans, best_overlaps
from search.evaluate.moments_baseline import SIZES, best_of
from search.evaluate.sequence_questions import draw_sequences, search_sequence, sequence_figures
from search.moments.one_motion import find
from search.moments.queried_motion import QueriedMotion
from search.query.encoding import encode_queries
from search.query.question import EncodedQuestion
from search.source import MotionSource
from search.spans import Moment

_ANSWERS = 10
_SEQUENCES = 2  # for each take


def evaluate_moments(
    takes: Iterable[AnnotatedTake],
    encoder: Encoder,
    *,
    sequences: bool = False,
    plain_windows: bool = False,
    progress: Callable[[int], None] | None = None,
) -> dict[str, dict[str, float]]:
    """Query each take, and then all takes at once, with every annotated sentence.

    Parameters
    ----------
    sequences : bool
        Whether to query for three events that follow one another too, twice a take.
    plain_windows : bool
        Whether the paper's windows are compared with the sentences as they are, as the paper does, instead of with the
        mean of their paraphrases, as search does.
    progress : callable, optional
        Called with the number of takes done.

    Returns
    -------
    dict
        Figures by method: "motionseek", the paper's "window of 20", "40", "60" frames and "best of the three", the
        "upper bound of the grid"; the first and the best of the three also for sentences about held-out actions, where
        there are some; "motionseek, all takes at once", where any take of which a sentence is true is right, "..., its
        own take"; and "three steps in order".
    """
    methods: dict[str, Overlaps] = defaultdict(Overlaps)
    gallery, in_order, rng = TakeGallery(encoder), list[float](), np.random.default_rng(0)
    for number, take in enumerate(takes, start=1):
        source = MotionSource.of_motion(take.motion)
        sentences = [annotation.sentence for annotation in take.annotations]
        queries = encode_queries(encoder, sentences)
        baseline = best_of(encoder, take.motion, encoder.encode_texts(sentences) if plain_windows else queries)
        _search_take(methods, encoder, source, take, queries, baseline)
        if sequences:
            in_order += [search_sequence(encoder, source, take, s) for s in draw_sequences(take, rng, _SEQUENCES)]
        gallery.add(take, source, queries)
        if progress is not None:
            progress(number)
    every = "motionseek, all takes at once"
    methods[every], methods[f"{every}, its own take"] = gallery.search(_ANSWERS)
    figures = {name: overlaps.figures() for name, overlaps in methods.items()}
    return figures | ({"three steps in order": sequence_figures(in_order)} if in_order else {})


def _search_take(
    methods: dict[str, Overlaps],
    encoder: Encoder,
    source: MotionSource,
    take: AnnotatedTake,
    queries: NDArray[np.float32],
    baseline: list[dict[int, Moment]],
) -> None:
    """Add the answers of every method to all sentences of one take; `baseline` are those of the paper's windows."""
    windows = _grid_spans(len(source.features(encoder)), encoder.fps)
    for annotation, query, slid in zip(take.annotations, queries, baseline, strict=True):
        found = islice(find(QueriedMotion(encoder, source, EncodedQuestion(query[None]))), _ANSWERS)
        moments = [(answer.moment.start, answer.moment.end) for answer in found]
        best = [(slid[0].start, slid[0].end)]
        methods["motionseek"].add(moments, annotation.spans)
        for size in SIZES:
            methods[f"window of {size}"].add([(slid[size].start, slid[size].end)], annotation.spans)
        methods["best of the three"].add(best, annotation.spans)
        methods["upper bound of the grid"].rows.append(best_overlaps(windows, annotation.spans).max(keepdims=True))
        if annotation.held_out:
            methods["motionseek, held-out actions"].add(moments, annotation.spans)
            methods["best of the three, held-out actions"].add(best, annotation.spans)


def _grid_spans(frames: int, fps: float) -> Spans:
    return [
        (float(start / fps), float((start + size) / fps))
        for starts, size in grid(frames, fps).values()
        for start in starts
    ]
