"""Arm carriage: where idle hands are held (pockets, hips, clasped, far from the body), depending on the style."""

from __future__ import annotations

import numpy as np
from numpy.random import Generator

from encoders.corpus.engine.curves import Curves

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
