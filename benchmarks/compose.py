"""Composing: how joined motions compare with the clips they are made of, and with cuts that are put end to end.

    python -m benchmarks.compose FOLDER TIMELINES [--count N]

FOLDER is indexed; TIMELINES is a file of time lines, such as the 500 multi-track ones of STMC (evaluation only). Rows:
the motions composed; the same cuts without any joining; the same with a straight line over each transition (SINC with
lerp); and the best clip of each sentence on its own, unstitched. The evaluator is the library's own model.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

import motionseek
from encoders.metrics import ranks
from encoders.motion import FPS, Motion
from motionseek import Composition, Library, Timeline
from search.compose.assembling import assembled
from search.compose.candidates import candidates
from search.compose.timeline import read_timelines
from search.judging.metrics.ground import foot_sliding
from search.judging.metrics.seams import transition_distances
from search.query.encoding import encode_queries

Array = NDArray[np.float64]

#: Frames over which the straight line of a transition goes: STMC's overlap.
_OVERLAP = 10
#: Frames around a join in which speeds are those of the join.
_AROUND = 6


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder")
    parser.add_argument("timelines", type=Path)
    parser.add_argument("--count", type=int, help="only the first so many time lines")
    arguments = parser.parse_args()
    library = motionseek.open(arguments.folder)
    lines = read_timelines(arguments.timelines)[: arguments.count]
    began = time.perf_counter()
    made = [library.compose(line)[0] for line in lines]
    seconds = (time.perf_counter() - began) / len(lines)
    print(f"{len(lines)} time lines, {len(library)} clips, {seconds:.2f} s each")
    rows = {
        "composed": [one.motion for one in made],
        "cuts, unjoined": [_unjoined(one) for one in made],
        "cuts, straight lines": [_straight(_unjoined(one), one.timeline) for one in made],
    }
    texts = sorted({one.text for line in lines for one in line.intervals})
    print(f"{'':22} R@1   R@3   TMR-score  transition cm  sliding %")
    for name, motions in rows.items():
        crops = [m.crop(i.start, i.end) for m, line in zip(motions, lines, strict=True) for i in line.intervals]
        distances = np.concatenate([_transitions(m, line) for m, line in zip(motions, lines, strict=True)])
        sliding = np.mean([foot_sliding(m.joints, FPS)[1] for m in motions])
        print(f"{name:22} {_fit(library, crops, lines, texts)} {distances.mean():10.2f} {sliding:12.1f}")
    best = _best_clips(library, lines)
    sliding = np.mean([foot_sliding(motion.joints, FPS)[1] for motion in best if len(motion) > 1])
    print(f"{'best clips, alone':22} {_fit(library, best, lines, texts)} {'-':>10} {sliding:12.1f}")
    joins, inside = _speeds(made)
    print(
        f"joint speed, 99th percentile: at joins {joins:.2f} m/s, in the clips {inside:.2f}, ratio {joins / inside:.2f}"
    )


def _unjoined(made: Composition) -> Motion:
    """The same cuts put end to end, parts laid over each other at once."""
    return assembled(made.timeline, [one.candidate for one in made.chosen], None, 0.0).motion


def _straight(motion: Motion, line: Timeline) -> Motion:
    """With a straight line over each transition, from its first frame to its last."""
    joints = motion.joints.copy()
    for frame in _boundaries(motion, line):
        first, last = max(frame - _OVERLAP // 2, 0), min(frame + _OVERLAP // 2, len(joints) - 1)
        share = np.linspace(0, 1, last - first + 1, dtype=np.float32)[:, None, None]
        joints[first : last + 1] = joints[first] + share * (joints[last] - joints[first])
    return Motion(joints, motion.fps)


def _boundaries(motion: Motion, line: Timeline) -> list[int]:
    frames = {round(FPS * edge) for one in line.intervals for edge in (one.start, one.end)}
    return sorted(frame for frame in frames if 0 < frame < len(motion))


def _transitions(motion: Motion, line: Timeline) -> Array:
    return transition_distances(motion.joints, _boundaries(motion, line))


def _fit(library: Library, crops: Sequence[Motion], lines: Sequence[Timeline], texts: Sequence[str]) -> str:
    """R@1, R@3 and TMR-score of crops with their own texts, among all texts."""
    own = np.array([texts.index(one.text) for line in lines for one in line.intervals])
    scores = library.bundle.encode_motions(list(crops)) @ library.bundle.encode_texts(list(texts)).T
    rank = ranks(scores, np.arange(len(texts)) == own[:, None])
    score = (scores[np.arange(len(own)), own].mean() + 1) / 2
    return f"{100 * np.mean(rank < 1):4.1f}  {100 * np.mean(rank < 3):4.1f} {score:9.3f}"


def _best_clips(library: Library, lines: Sequence[Timeline]) -> list[Motion]:
    """The best cut of each sentence, whatever comes before and after."""
    found: dict[tuple[str, float], Motion] = {}
    for one in (one for line in lines for one in line.intervals):
        key = one.text, round(one.duration, 1)
        if key not in found:
            best = candidates(library, one, encode_queries(library.bundle, [one.text])[0], 24, None)[0]
            found[key] = best.source.read(best.start, best.end)
    return [found[one.text, round(one.duration, 1)] for line in lines for one in line.intervals]


def _speeds(made: Sequence[Composition]) -> tuple[float, float]:
    """99th percentiles of joint speeds in metres a second: near joins, and in the cuts that were used."""
    near, inside = [], []
    for one in made:
        speed = np.linalg.norm(np.diff(one.motion.joints, axis=0), axis=-1) * FPS
        for frame in _boundaries(one.motion, one.timeline):
            near.append(speed[max(frame - _AROUND, 0) : frame + _AROUND].ravel())
        for chosen in one.chosen:
            cut = chosen.candidate.source.read(chosen.candidate.start, chosen.candidate.end).joints
            inside.append(np.linalg.norm(np.diff(cut, axis=0), axis=-1).ravel() * FPS * chosen.candidate.rate)
    return float(np.percentile(np.concatenate(near), 99)), float(np.percentile(np.concatenate(inside), 99))


if __name__ == "__main__":
    main()
