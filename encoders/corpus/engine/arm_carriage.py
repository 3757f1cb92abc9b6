"""Arm carriage: where idle hands are held (pockets, hips, clasped, far from the body), by style or at random."""

from __future__ import annotations

import numpy as np
from numpy.random import Generator

from encoders.corpus.engine.curves import Array, Curves, ease
from encoders.corpus.engine.joining import smooth_noise

#: Carriage -> wrists (outward, upward, forward of the own shoulder in arm lengths; left, right) and elbow swing.
CARRIAGES: dict[str, tuple[tuple[tuple[float, float, float], tuple[float, float, float]], float]] = {
    "pockets": (((0.06, -0.82, 0.14), (0.06, -0.82, 0.14)), 0.4),
    "clasped": (((-0.3, -0.72, 0.3), (-0.3, -0.72, 0.3)), 0.1),
    "behind": (((-0.12, -0.78, -0.25), (-0.12, -0.78, -0.25)), 0.1),
    "hips": (((0.26, -0.62, 0.04), (0.26, -0.62, 0.04)), 0.5),
    "one hip": (((0.13, -0.96, 0.08), (0.26, -0.62, 0.04)), 0.2),
    "chest": (((-0.3, -0.3, 0.36), (-0.3, -0.3, 0.36)), -0.1),
    "folded": (((-0.22, -0.45, 0.34), (-0.3, -0.4, 0.36)), 0.3),
    "fists": (((0.1, -0.5, 0.45), (0.1, -0.5, 0.45)), 0.2),
    "wide": (((0.5, -0.8, 0.05), (0.5, -0.8, 0.05)), 0.5),
    "wings": (((0.55, -0.65, -0.2), (0.55, -0.65, -0.2)), 0.2),
    "limp": (((0.04, -0.95, 0.25), (0.04, -0.95, 0.25)), 0.0),
    "light": (((0.4, -0.72, 0.15), (0.4, -0.72, 0.15)), -0.4),
    "bad back": (((-0.12, -0.7, -0.22), (0.08, -0.88, 0.25)), 0.1),
    "knee": (((0.0, -0.85, 0.35), (0.1, -0.9, 0.2)), 0.1),
}
#: Carriages in which the hands meet, so that both are needed.
_TOGETHER = frozenset({"clasped", "behind", "chest", "folded"})
#: Style -> probability of a carriage, and the carriages.
_CARRIED: dict[str, tuple[float, tuple[str, ...]]] = {
    "tired": (0.4, ("limp", "limp", "hips", "pockets", "knee")),
    "old": (0.5, ("behind", "bad back", "limp", "clasped", "knee")),
    "angry": (0.35, ("fists", "wide", "folded", "hips")),
    "happy": (0.3, ("light", "wide", "chest", "fists")),
    "proud": (0.4, ("hips", "behind", "one hip", "wide", "light")),
    "sad": (0.35, ("limp", "pockets", "clasped", "chest")),
    "drunk": (0.3, ("wide", "limp", "light")),
    "heavy": (0.5, ("wide", "wide", "fists", "limp")),
    "feminine": (0.45, ("light", "one hip", "chest", "hips", "clasped")),
    "masculine": (0.4, ("wide", "wide", "fists", "pockets", "hips")),
    "childlike": (0.35, ("wide", "wings", "behind", "light")),
    "scared": (0.4, ("chest", "fists", "clasped")),
    "shy": (0.55, ("clasped", "chest", "clasped", "behind", "pockets", "folded")),
    "confident": (0.2, ("hips", "pockets", "light")),
    "relaxed": (0.35, ("pockets", "behind", "limp")),
    "cool": (0.4, ("pockets", "pockets", "wide", "one hip")),
    "energetic": (0.25, ("fists", "wide")),
    "elegant": (0.3, ("clasped", "behind", "light")),
    "tough": (0.5, ("pockets", "wide", "wide", "hips", "fists")),
    "musical": (0.35, ("fists", "light", "wide", "hips")),
}


def sample_carriage(style: str, rng: Generator) -> str:
    """A random carriage for a style ("" for none); mostly "", hanging hands."""
    chance, places = _CARRIED.get(style, (0.03, ("pockets", "clasped", "behind", "hips", "folded")))
    return places[int(rng.integers(len(places)))] if rng.random() < chance else ""


def carry_idle_hands(curves: Curves, rng: Generator, carriage: str = "") -> None:
    """Move hanging hands to a carriage, in place; to a random common one by default."""
    where = carriage or ("pockets", "clasped", "behind")[int(rng.integers(3))]
    places, elbow = CARRIAGES[where]
    idle = np.clip((-0.6 - curves.hands[..., 1]) / 0.2, 0.0, 1.0) * (1.0 - curves.reach_weight)
    if carriage:  # only for arms that do nothing but hang and swing
        length = np.linalg.norm(curves.hands, axis=-1).min(axis=0)
        idle *= np.clip((length - 0.8) / 0.08, 0.0, 1.0) * (curves.hands[..., 1].max(axis=0) < -0.5)
    together = where in _TOGETHER
    weight = rng.uniform(0.65, 1.0) * (idle.min(axis=1)[:, None] if together else idle)
    hands = np.array(places if rng.random() < 0.5 else places[::-1])
    curves.hands[:] += (hands - curves.hands) * weight[..., None]
    if carriage:
        curves.elbow[:] += elbow * weight


#: Further places of a wrist under which legs are to be recognised: (outward, upward, forward) in arm lengths.
_HELD: dict[str, tuple[tuple[float, float, float], ...]] = {
    "on guard": ((-0.2, -0.1, 0.35), (-0.15, 0.1, 0.4), (-0.22, -0.35, 0.35)),
    "loaded": ((-0.2, -0.4, 0.48), (-0.1, -0.55, 0.4), (-0.1, 0.12, 0.15), (-0.25, -0.1, 0.45)),
    "bent": ((0.1, -0.55, 0.5), (0.05, -0.6, 0.35), (0.15, -0.45, 0.4)),
    "at the head": ((-0.12, 0.3, 0.12), (-0.2, 0.2, 0.25), (0.0, 0.4, 0.0)),
    "up": ((0.15, 0.85, 0.1), (0.3, 0.6, 0.15), (0.1, 0.45, 0.35), (0.35, 0.35, 0.2)),
    "out": ((0.9, -0.1, 0.1), (0.75, -0.45, 0.15), (0.6, 0.1, 0.3)),
    "ahead": ((-0.1, -0.1, 0.9), (0.0, -0.3, 0.75), (-0.2, 0.15, 0.7)),
    "hanging": ((0.13, -0.96, 0.08), (0.2, -0.9, 0.15), (0.08, -0.95, -0.05)),
}


def hold_arms(curves: Curves, rng: Generator) -> None:
    """Hold one arm or both anywhere instead of as the action has them, in place: legs go under any arms.

    Little or much of the arms' own movement stays; they are held throughout, or taken there or away on the way.
    """
    frames = len(curves)
    named = rng.random() < 0.4
    pair = CARRIAGES[list(CARRIAGES)[int(rng.integers(len(CARRIAGES)))]][0] if named else (_held(rng),) * 2
    if not named and rng.random() < 0.45:  # each arm its own way
        pair = (pair[0], _held(rng))
    arms = [(0, 1), (0, 1), (0, 1), (0,), (1,)][int(rng.integers(5))]
    weight = np.ones(frames)
    if rng.random() < 0.3:
        weight = ease((np.arange(frames) / frames - rng.uniform(0.0, 0.6)) / rng.uniform(0.1, 0.3))
        weight = weight[::-1] if rng.random() < 0.5 else weight
    own, alive = rng.uniform(0.0, 0.7) * float(rng.random() < 0.7), float(rng.gamma(1.0, 0.04))
    moving = alive * smooth_noise(frames, 6, rng, rng.uniform(0.6, 2.5)).reshape(frames, 2, 3)
    place = np.array(pair) + rng.normal(0.0, 0.06, (2, 3))
    target = place + moving + own * (curves.hands - curves.hands.mean(axis=0))
    for arm in arms:
        _blend(curves.hands[:, arm], target[:, arm], weight[:, None])
        _blend(curves.hang[:, arm], np.full(frames, rng.uniform(0.1, 0.6)), weight)
        _blend(curves.elbow[:, arm], np.full(frames, rng.normal(0.15, 0.3)), weight)
        curves.reach_weight[:, arm] *= 1 - weight


def _held(rng: Generator) -> tuple[float, float, float]:
    places = list(_HELD.values())[int(rng.integers(len(_HELD)))]
    return places[int(rng.integers(len(places)))]


def _blend(channel: Array, target: Array, weight: Array) -> None:
    channel += (target - channel) * weight
