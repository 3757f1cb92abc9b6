"""Performances of single steps, for tests of actions and of the engine."""

from __future__ import annotations

import numpy as np

from encoders.corpus.actions.programs import programs
from encoders.corpus.composition.scene_clips import make_clip
from encoders.corpus.engine.curves import Curves
from encoders.corpus.engine.style import NEUTRAL
from encoders.corpus.scene import ActionStep, Scene, SceneClip
from encoders.skeleton import INDEX


def plain(*groups: ActionStep | tuple[ActionStep, ...], seed: int = 0) -> SceneClip:
    scene = Scene(tuple(g if isinstance(g, tuple) else (g,) for g in groups))
    return make_clip(scene, np.random.default_rng(seed), variation=0.0)


def perform(step: ActionStep, seed: int = 0, frames: int = 0) -> Curves:
    return programs()[step.action].make(step, NEUTRAL, np.random.default_rng(seed), frames)


def joint(clip: SceneClip, name: str) -> np.ndarray:
    return clip.joints[:, INDEX[name]].astype(np.float64)


def peaks(curve: np.ndarray, level: float) -> int:
    above = curve > level
    return int((above[1:] & ~above[:-1]).sum() + above[0])
