"""Long takes with exact truth: actions made one after the other, or real clips joined end to end."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.random import Generator
from numpy.typing import NDArray

from encoders.corpus.compose import make_clip
from encoders.corpus.facts import facts
from encoders.corpus.language import describe, random_scene
from encoders.corpus.made import settle
from encoders.corpus.scene import Scene
from encoders.motion import FPS, Motion
from encoders.skeleton import INDEX

_BLEND = 6  # frames over which one clip becomes the next
_ACROSS = [INDEX[name] for name in ("right_hip", "left_hip", "right_shoulder", "left_shoulder")]


@dataclass(frozen=True)
class Marked:
    """A sentence and every span (seconds) of the take of which it is true."""

    sentence: str
    spans: tuple[tuple[float, float], ...]


@dataclass(frozen=True)
class MarkedTake:
    """A take and what happens in it, in order."""

    motion: Motion
    marked: tuple[Marked, ...]


def made_take(rng: Generator, *, least: float = 30.0, most: float = 120.0) -> MarkedTake:
    """A made take that ends with the first clip after `least` to `most` seconds: one action after another.

    Each action is described once; the sentence is marked wherever something happens of which it is known to be true.
    """
    wanted = rng.uniform(least, most)
    clips: list[NDArray[np.float32]] = []
    happens: list[tuple[frozenset[str], tuple[float, float]]] = []
    said: list[tuple[str, frozenset[str]]] = []
    at = 0.0
    while at < wanted:
        scene = settle(random_scene(rng), rng)
        clip = make_clip(scene, rng)
        for group, (start, end) in zip(scene.steps, clip.spans, strict=True):
            alone = Scene((group,))
            caption = describe(alone, rng)
            happens.append((facts(alone), (at + start, at + end)))
            said.append((caption.text, facts(caption.scene)))
        clips.append(clip.joints)
        at += len(clip.joints) / clip.fps
    marked = {text: Marked(text, tuple(span for true, span in happens if meaning <= true)) for text, meaning in said}
    return MarkedTake(Motion(join(clips), FPS), tuple(marked.values()))


def joined_take(clips: Sequence[tuple[Motion, str]]) -> MarkedTake:
    """Real clips end to end; a sentence that occurs twice is right at both places."""
    joints = [motion.resample(FPS).joints for motion, _ in clips]
    times = np.cumsum([0, *map(len, joints)]) / FPS
    same: dict[str, list[tuple[float, float]]] = {}
    for (_, sentence), start, end in zip(clips, times[:-1], times[1:], strict=True):
        same.setdefault(sentence, []).append((float(start), float(end)))
    return MarkedTake(Motion(join(joints), FPS), tuple(Marked(text, tuple(spans)) for text, spans in same.items()))


def join(clips: Sequence[NDArray[np.float32]]) -> NDArray[np.float32]:
    """Joints (T, 22, 3) of clips one after the other: each begins where and facing as the one before ended.

    As TEACH joins actions (Athanasiou et al., 3DV 2022): place and heading are aligned, then a few frames blended.
    """
    whole = [np.asarray(clips[0], np.float32)]
    for clip in clips[1:]:
        last = whole[-1][-1]
        moved = _face(np.asarray(clip, np.float32), _heading(last))
        moved = moved + np.array([last[0, 0] - moved[0, 0, 0], 0, last[0, 2] - moved[0, 0, 2]], np.float32)
        frames = min(_BLEND, len(moved))
        weight = np.linspace(1, 0, frames + 2, dtype=np.float32)[1:-1, None, None]
        moved[:frames] += weight * (last - moved[0])
        whole.append(moved)
    return np.concatenate(whole)


def _heading(pose: NDArray[np.float32]) -> float:
    """Angle about Y of the direction a pose (22, 3) faces."""
    right_hip, left_hip, right_shoulder, left_shoulder = pose[_ACROSS]
    across = (left_hip - right_hip) + (left_shoulder - right_shoulder)
    return float(np.arctan2(-across[2], across[0]))


def _face(joints: NDArray[np.float32], heading: float) -> NDArray[np.float32]:
    """The clip turned about Y so that its first frame has this heading."""
    turn = heading - _heading(joints[0])
    c, s = np.cos(turn), np.sin(turn)
    return joints @ np.array([[c, 0, -s], [0, 1, 0], [s, 0, c]], np.float32)
