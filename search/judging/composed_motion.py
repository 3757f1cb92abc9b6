"""Composed motion: how it compares with the clips that it is made of, and with cuts that are put end to end.

The figures of STMC (Petrovich et al., CVPRW 2024) over time lines. The evaluator is the library's own model, which also
chooses: composing is retrieval, and the row of the best clips alone is chosen by it as well.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from encoders.metrics import ranks
from encoders.motion import FPS, Motion
from encoders.protocol import Encoder
from search.compose.assembling import assembled
from search.compose.composition import Composition
from search.compose.timeline import Interval, Timeline
from search.library import Library
from search.plausibility.ground import foot_sliding
from search.plausibility.seams import transition_distances
from search.query.encoding import encode_queries
from search.ranking.window_ranking import rank_windows
from search.source import MotionSource

Array = NDArray[np.float64]

#: Frames over which the straight line of a transition goes: STMC's overlap.
_OVERLAP = 10
#: Frames around a join in which speeds are those of the join.
_AROUND = 6


@dataclass(frozen=True)
class ComposedFigures:
    """Figures of composed motion.

    Attributes
    ----------
    rows : dict of str to dict of str to float
        For "composed", "cuts unjoined", "cuts with straight lines" and "best clips alone": recall and TMR-score of the
        crops, the distance in cm of two frames at each start and end of a sentence, and percent of frames in which a
        standing foot slides. "R@1 aside" does not count sentences that happen at the same time; the last three are
        the recall of sentences with nothing beside them, with another laid over them, and laid over another.
    speed_at_joins, speed_in_clips : float
        99th percentiles of joint speeds, in metres a second; 0 where nothing is joined.
    seconds : float
        A time line.
    """

    timelines: int
    clips: int
    rows: dict[str, dict[str, float]]
    speed_at_joins: float
    speed_in_clips: float
    seconds: float

    def as_dict(self) -> dict[str, Any]:
        """Plain values, for JSON."""
        return asdict(self)


def evaluate_composed(
    library: Library, lines: Sequence[Timeline], progress: Callable[[int], None] | None = None
) -> ComposedFigures:
    """Compose every time line, and compare what comes out.

    Parameters
    ----------
    progress : callable, optional
        Called with how many are done.
    """
    made, seconds = [], 0.0
    for line in lines:
        began = time.perf_counter()
        made += library.compose(line)
        seconds += time.perf_counter() - began
        if progress is not None:
            progress(len(made))
    unjoined = [_unjoined(one) for one in made]
    straight = [_straight(motion, line) for motion, line in zip(unjoined, lines, strict=True)]
    judge = _Judge(library.bundle, lines)
    rows = {
        "composed": judge.figures([one.motion for one in made]),
        "cuts unjoined": judge.figures(unjoined),
        "cuts with straight lines": judge.figures(straight),
        "best clips alone": judge.figures_of_clips(_best_windows(library, lines)),
    }
    near, inside = _speeds(made)
    return ComposedFigures(len(lines), len(library), rows, near, inside, seconds / max(len(lines), 1))


class _Judge:
    """Ranks crops among the sentences of all time lines."""

    def __init__(self, encoder: Encoder, lines: Sequence[Timeline]) -> None:
        self._encoder, self._lines = encoder, lines
        self._intervals = [(line, one) for line in lines for one in line.intervals]
        self._texts = sorted({one.text for _, one in self._intervals})
        place = {text: i for i, text in enumerate(self._texts)}
        self._own = np.array([place[one.text] for _, one in self._intervals])
        self._aside = np.zeros((len(self._own), len(self._texts)), bool)
        for row, (line, one) in enumerate(self._intervals):
            self._aside[row, [place[other.text] for other in _beside(line, one) if other.text != one.text]] = True
        kinds = [_kind(line, one) for line, one in self._intervals]
        self._kinds = {kind: np.array([k == kind for k in kinds]) for kind in ("free", "under", "over")}

    def figures(self, motions: Sequence[Motion]) -> dict[str, float]:
        """Figures of motions for the time lines."""
        pairs = list(zip(motions, self._lines, strict=True))
        found = self._recall([motion.crop(one.start, one.end) for motion, line in pairs for one in line.intervals])
        distances = np.concatenate([transition_distances(m.joints, _boundaries(m, line)) for m, line in pairs])
        joined = {"transition cm": float(distances.mean())} if len(distances) else {}
        return found | joined | {"sliding %": _sliding(motions)}

    def figures_of_clips(self, crops: Sequence[Motion]) -> dict[str, float]:
        """Figures of one motion for each interval."""
        return self._recall(crops) | {"sliding %": _sliding([crop for crop in crops if len(crop) > 1])}

    def _recall(self, crops: Sequence[Motion]) -> dict[str, float]:
        scores = self._encoder.encode_motions(crops) @ self._encoder.encode_texts(self._texts).T
        own = np.arange(len(self._texts)) == self._own[:, None]
        first = ranks(scores, own) < 1
        aside = ranks(np.where(self._aside, -2, scores), own) < 1
        return {
            "R@1": _percent(first),
            "R@3": _percent(ranks(scores, own) < 3),
            "TMR-score": float((scores[own].mean() + 1) / 2),
            "R@1 aside": _percent(aside),
        } | {f"R@1 {kind}": _percent(first[of]) for kind, of in self._kinds.items() if of.any()}


def _percent(hits: NDArray[np.bool_]) -> float:
    return float(100 * hits.mean())


def _sliding(motions: Sequence[Motion]) -> float:
    return float(np.mean([foot_sliding(motion.joints, FPS)[1] for motion in motions]))


def _beside(line: Timeline, one: Interval) -> list[Interval]:
    """The intervals that share a tenth of a second with one."""

    def shared(other: Interval) -> float:
        return min(one.end, other.end) - max(one.start, other.start)

    return [other for other in line.intervals if other is not one and shared(other) > 0.1]


def _kind(line: Timeline, one: Interval) -> str:
    """Whether an interval has nothing beside it, leads under another, or is only laid over others."""
    if not _beside(line, one):
        return "free"
    return "under" if any(line.intervals[cut.base] is one for cut in line.cuts()) else "over"


def _unjoined(made: Composition) -> Motion:
    """The same cuts put end to end, parts laid over each other at once."""
    return assembled(made.timeline, [one.candidate for one in made.chosen], None, 0.0).motion


def _straight(motion: Motion, line: Timeline) -> Motion:
    """With a straight line over each transition, from its first frame to its last (SINC with lerp)."""
    joints = motion.joints.copy()
    for frame in _boundaries(motion, line):
        first, last = max(frame - _OVERLAP // 2, 0), min(frame + _OVERLAP // 2, len(joints) - 1)
        share = np.linspace(0, 1, last - first + 1, dtype=np.float32)[:, None, None]
        joints[first : last + 1] = joints[first] + share * (joints[last] - joints[first])
    return Motion(joints, motion.fps)


def _boundaries(motion: Motion, line: Timeline) -> list[int]:
    frames = {round(FPS * edge) for one in line.intervals for edge in (one.start, one.end)}
    return sorted(frame for frame in frames if 0 < frame < len(motion))


def _best_windows(library: Library, lines: Sequence[Timeline]) -> list[Motion]:
    """The window of the library nearest to each sentence, as it was performed, however long it is."""
    found: dict[str, Motion] = {}
    for text in {one.text for line in lines for one in line.intervals}:
        best = next(rank_windows(library, encode_queries(library.bundle, [text])[0]))
        source = MotionSource.of_clip(library, library.clip(best.clip_id))
        moment = best.moment(source.duration)
        found[text] = source.read(moment.start, moment.end)
    return [found[one.text] for line in lines for one in line.intervals]


def _speeds(made: Sequence[Composition]) -> tuple[float, float]:
    """99th percentiles of joint speeds in metres a second: near joins, and in the cuts that were used."""
    near, inside = [np.zeros(1)], []
    for one in made:
        speed = np.linalg.norm(np.diff(one.motion.joints, axis=0), axis=-1) * FPS
        near += [speed[max(at - _AROUND, 0) : at + _AROUND].ravel() for at in _boundaries(one.motion, one.timeline)]
        for candidate in (chosen.candidate for chosen in one.chosen):
            cut = candidate.source.read(candidate.start, candidate.end).joints
            inside.append(np.linalg.norm(np.diff(cut, axis=0), axis=-1).ravel() * FPS * candidate.rate)
    return float(np.percentile(np.concatenate(near), 99)), float(np.percentile(np.concatenate(inside), 99))
