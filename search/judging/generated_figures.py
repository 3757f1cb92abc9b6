"""All figures of a set of motions, beside the real motions they are compared with."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np
from numpy.random import Generator
from numpy.typing import NDArray

from encoders.protocol import Encoder
from search.judging.encoded_motions import EncodedMotions, Pieces
from search.judging.metrics import agreement, recognition
from search.judging.metrics.frechet import frechet_distance
from search.judging.metrics.futures import best_of_many, future_diversity
from search.judging.metrics.pose_errors import position_and_variance_errors
from search.judging.metrics.scopes import CROP_SECONDS, WINDOW, random_crops, sliding_windows, transition_windows
from search.judging.metrics.spread import diversity, multimodality
from search.judging.motion_table import JudgedMotion
from search.plausibility.ground import foot_sliding, penetration
from search.plausibility.seams import quarters, transition_distances, world_distances

Array = NDArray[np.float32]
Figures = dict[str, float]
#: Figure -> why it is missing.
Missing = dict[str, str]


@dataclass(frozen=True)
class Comparison:
    """A set of motions and what it is compared with.

    Attributes
    ----------
    motions : EncodedMotions
        The set that is judged.
    real : EncodedMotions or None
    pairs : sequence of N places in `real`, or None
        The reference of each motion.
    labels : sequence of str
        Those that a recogniser chooses from; none: no recognition.
    synonyms : sets of labels that count for one another
    """

    motions: EncodedMotions
    real: EncodedMotions | None
    pairs: Sequence[int] | None
    labels: Sequence[str]
    synonyms: Sequence[frozenset[str]]

    @property
    def is_real(self) -> bool:
        """Whether real motions are judged by themselves."""
        return self.motions is self.real


class Collector:
    """Figures, and the reason for each that cannot be had."""

    def __init__(self) -> None:
        self.figures: Figures = {}
        self.missing: Missing = {}

    def add(self, names: Sequence[str], compute: Callable[[], Sequence[float]]) -> None:
        """Compute some figures at once; what they raise as ValueError is why they are missing."""
        try:
            self.figures.update(zip(names, compute(), strict=True))
        except ValueError as error:
            self.missing.update(dict.fromkeys(names, str(error)))

    def lack(self, names: Sequence[str], reason: str) -> None:
        self.missing.update(dict.fromkeys(names, reason))


def fixed_figures(case: Comparison) -> tuple[Figures, Missing]:
    """The figures in which nothing is drawn at random."""
    found = Collector()
    _of_texts(case, found)
    _of_labels(case, found)
    _of_references(case, found)
    _of_transitions(case, found)
    _of_ground(case.motions.motions, found)
    if not case.is_real:
        _of_sets(case, found, np.random.default_rng())
    return found.figures, found.missing


def drawn_figures(case: Comparison, seed: int) -> tuple[Figures, Missing]:
    """The figures with random draws: batches, pairs, crops, and for real motions the halves that are compared."""
    found, rng, ours = Collector(), np.random.default_rng(seed), case.motions
    if ours.texts:
        names = [f"precision32_{k}" for k in agreement.PLACES]
        own = ours.text_vectors[ours.own_text]
        found.add(names, lambda: list(agreement.batched_precision(ours.vectors, own, seed).values()))
    else:
        found.lack([f"precision32_{k}" for k in agreement.PLACES], "no texts")
    found.add(["diversity"], lambda: [diversity(ours.vectors, rng)])
    for name in ("text", "label"):
        groups = [getattr(one, name) for one in ours.motions]
        if all(groups):
            found.add([f"multimodality_{name}"], partial(_multimodality, ours.vectors, groups, rng))
        else:
            found.lack([f"multimodality_{name}"], f"no {name}s")
    found.add(["sliding_diversity"], lambda: [diversity(_sliding(ours).vectors, rng)])
    found.add(["transition_diversity"], lambda: [diversity(_around_transitions(ours).vectors, rng)])
    if case.real is None:
        found.lack(["frechet_crops"], "no references")
        return found.figures, found.missing
    real = case.real.whole
    found.add(["frechet_crops"], lambda: [_distance(case, _crops(ours, rng), real, rng)])
    if case.is_real:
        _of_sets(case, found, rng)
    return found.figures, found.missing


def _crops(encoded: EncodedMotions, rng: Generator) -> Pieces:
    """Unit vectors of random crops of each motion."""
    return encoded.pieces(lambda one: random_crops(len(one.motion), round(CROP_SECONDS * one.motion.fps), rng))


def _sliding(encoded: EncodedMotions) -> Pieces:
    """Unit vectors of the sliding windows of all motions that are long enough for one."""
    return encoded.pieces(lambda one: sliding_windows(len(one.motion)), "sliding", WINDOW)


def _around_transitions(encoded: EncodedMotions) -> Pieces:
    """Unit vectors of the windows around the transitions of all motions that are long enough for one."""
    return encoded.pieces(
        lambda one: transition_windows(len(one.motion), one.transitions), "transition", WINDOW, "no transitions"
    )


def _of_sets(case: Comparison, found: Collector, rng: Generator) -> None:
    """Frechet distances of whole motions and of windows; `rng` is drawn from for real motions alone."""
    if case.real is None:
        found.lack(["frechet", "sliding_frechet", "transition_frechet"], "no references")
        return
    ours, real = case.motions, case.real
    marked = any(one.transitions for one in real.motions)
    found.add(["frechet"], lambda: [_distance(case, ours.whole, real.whole, rng)])
    found.add(["sliding_frechet"], lambda: [_distance(case, _sliding(ours), _sliding(real), rng)])
    beside = _around_transitions if marked else _sliding
    found.add(["transition_frechet"], lambda: [_distance(case, _around_transitions(ours), beside(real), rng)])


def _distance(case: Comparison, ours: Pieces, real: Pieces, rng: Generator) -> float:
    """Frechet distance to the real set; of real motions by themselves one random half to the other half.

    That is as near as motions of one source come if there are but half as many.
    """
    if not case.is_real:
        return frechet_distance(ours.vectors, real.vectors)
    count = len(case.motions.motions)
    half = np.isin(np.arange(count), rng.permutation(count)[: count // 2])
    return frechet_distance(ours.vectors[half[ours.owners]], real.vectors[~half[real.owners]])


def _multimodality(vectors: Array, groups: Sequence[str], rng: Generator) -> list[float]:
    return [multimodality(vectors, groups, rng)]


def _of_texts(case: Comparison, found: Collector) -> None:
    ours = case.motions
    names = [f"precision_{k}" for k in agreement.PLACES]
    if not ours.texts:
        found.lack(["score_text", "text_distance", *names], "no texts")
        return
    own = ours.text_vectors[ours.own_text]
    found.add(["score_text"], lambda: [float(agreement.tmr_scores(ours.vectors, own).mean())])
    found.add(["text_distance"], lambda: [agreement.multimodal_distance(ours.vectors, own)])
    found.add(
        names, lambda: list(agreement.precision(ours.vectors, ours.text_vectors, ours.own_text.tolist()).values())
    )


def _of_labels(case: Comparison, found: Collector) -> None:
    names = [f"accuracy_{k}" for k in recognition.PLACES]
    asked = [one.label for one in case.motions.motions]
    if not all(asked):
        found.lack(names, "no labels")
        return
    scores = case.motions.vectors @ label_vectors(case.motions.encoder, case.labels).T
    found.add(names, lambda: list(recognition.accuracy(scores, case.labels, asked, case.synonyms).values()))


def label_vectors(encoder: Encoder, labels: Sequence[str]) -> Array:
    """Unit vectors (L, D) of labels, each read as a sentence."""
    return encoder.encode_texts([label.replace("_", " ") for label in labels])


def _of_references(case: Comparison, found: Collector) -> None:
    errors = [f"{kind}_{part}" for kind in ("ape", "ave") for part in ("root", "trajectory", "local", "global")]
    best = ["displacement", "displacement_warped", "futures", "futures_warped"]
    if case.real is None or case.pairs is None:
        reason = "no references" if case.real is None else "no motion has a reference of its name"
        found.lack(["score_motion", *errors, *best], reason)
        return
    real, pairs = case.real, list(case.pairs)
    ours = [one.motion.joints for one in case.motions.motions]
    truth = [one.motion.joints for one in real.motions]
    scores = agreement.tmr_scores(case.motions.vectors, real.vectors[pairs])
    found.add(["score_motion"], lambda: [float(scores.mean())])

    def pose_errors() -> list[float]:
        parts = position_and_variance_errors(ours, [truth[place] for place in pairs])
        return [errors[i] for i in (0, 1) for errors in parts.values()]

    found.add(errors, pose_errors)
    futures: dict[int, list[NDArray[np.float32]]] = {}
    for joints, place in zip(ours, pairs, strict=True):
        futures.setdefault(place, []).append(joints)
    several = {place: group for place, group in futures.items() if len(group) > 1}
    if not several:
        found.lack(best, "no reference has several motions")
        return
    found.add(best[:2], lambda: _mean([best_of_many(group, truth[place]) for place, group in several.items()]))
    found.add(best[2:], lambda: _mean([future_diversity(group) for group in several.values()]))


def _of_transitions(case: Comparison, found: Collector) -> None:
    """At the transitions that are stated; in real motions without any at their quarters, as STMC does."""
    names, motions = ["transition", "transition_world"], case.motions.motions
    if case.is_real and not any(one.transitions for one in motions):
        motions = [replace(one, transitions=tuple(quarters(len(one.motion)))) for one in motions]
    if not any(one.transitions for one in motions):
        found.lack(names, "no transitions")
        return
    for name, distances in zip(names, (transition_distances, world_distances), strict=True):
        steps = [distances(one.motion.joints, one.transitions) for one in motions if one.transitions]
        found.figures[name] = float(np.concatenate(steps).mean())


def _of_ground(motions: Sequence[JudgedMotion], found: Collector) -> None:
    moving = [one.motion for one in motions if len(one.motion) > 1]
    if not moving:
        found.lack(["skate", "skating", "penetration"], "no motion of two frames")
        return
    slides = np.array([foot_sliding(one.joints, one.fps) for one in moving])
    if np.isnan(slides[:, 0]).all():
        found.lack(["skate"], "no foot ever stands")
    else:
        found.figures["skate"] = float(np.nanmean(slides[:, 0]))
    found.figures["skating"] = float(slides[:, 1].mean())
    found.figures["penetration"] = float(np.mean([penetration(one.joints, one.fps) for one in moving]))


def _mean(rows: Sequence[tuple[float, float]]) -> list[float]:
    return [float(value) for value in np.mean(rows, axis=0)]
