"""Long takes with exact truth: actions made one after the other, or real clips joined end to end."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.random import Generator
from numpy.typing import NDArray

from encoders.corpus.actions.programs import program_of
from encoders.corpus.composition.facts import facts
from encoders.corpus.composition.scene_clips import make_clip
from encoders.corpus.composition.synthetic import settle
from encoders.corpus.heldout.words import ACTIONS, STYLES, in_the_manner, sentence
from encoders.corpus.language import describe, random_scene
from encoders.corpus.scene import ActionStep, Scene
from encoders.motion import FPS, Motion
from encoders.skeleton import INDEX

_BLEND = 6  # frames over which one clip becomes the next
_UNSEEN_ACTIONS = 0.4  # share of clips
_ACROSS = [INDEX[name] for name in ("right_hip", "left_hip", "right_shoulder", "left_shoulder")]


Span = tuple[float, float]
Group = tuple[ActionStep, ...]


@dataclass(frozen=True)
class Marked:
    """A sentence and every span (seconds) of the take of which it is true.

    Attributes
    ----------
    meaning : frozenset of str
        The facts it states; it is true of whatever happens that has them all.
    unseen : bool
        Whether it names an action that training never shows.
    """

    sentence: str
    spans: tuple[Span, ...]
    meaning: frozenset[str] = frozenset()
    unseen: bool = False


@dataclass(frozen=True)
class Event:
    """What happens from when to when (seconds): a sentence for it, and all facts that hold."""

    sentence: str
    span: Span
    facts: frozenset[str]


@dataclass(frozen=True)
class AnnotatedTake:
    """A take, the sentences asked of it, and what happens in it, in order."""

    motion: Motion
    marked: tuple[Marked, ...]
    happens: tuple[Event, ...] = ()

    def spans(self, meaning: frozenset[str]) -> list[Span]:
        """The spans of this take of which a meaning is true."""
        return [h.span for h in self.happens if meaning and meaning <= h.facts]


#: A sentence, and the facts that it states.
Said = tuple[str, frozenset[str]]


def synthetic_take(rng: Generator, *, least: float = 30.0, most: float = 120.0) -> AnnotatedTake:
    """A made take that ends with the first clip after `least` to `most` seconds: one action after another.

    Each action is described once; the sentence is marked wherever something happens of which it is known to be true.
    """
    return _acted(rng, rng.uniform(least, most), lambda: settle(random_scene(rng), rng), _described)


def heldout_take(rng: Generator, *, least: float = 30.0, most: float = 120.0) -> AnnotatedTake:
    """As `synthetic_take`, of what no training clip shows (`encoders.corpus.heldout`).

    Two clips in five are actions held out, in any manner; the others are known actions in manners held out, which half
    of their sentences name. The joins are held out as well: within a training clip `joining` carries one movement into
    the next, here whole clips of different performers are blended end to end by `join`, which training never uses.
    """
    return _acted(rng, rng.uniform(least, most), lambda: _unseen_scene(rng), _described_unseen)


def joined_take(clips: Sequence[tuple[Motion, str]]) -> AnnotatedTake:
    """Real clips end to end; a sentence that occurs twice is right at both places."""
    joints = [motion.resample(FPS).joints for motion, _ in clips]
    times = np.cumsum([0, *map(len, joints)]) / FPS
    happens = [
        Event(sentence, (float(start), float(end)), frozenset({sentence}))
        for (_, sentence), start, end in zip(clips, times[:-1], times[1:], strict=True)
    ]
    return annotated_take(Motion(join(joints), FPS), happens)


def annotated_take(motion: Motion, happens: Sequence[Event], meanings: Sequence[frozenset[str]] = ()) -> AnnotatedTake:
    """A take whose sentences are those of what happens; without `meanings` each says all that it is true of."""
    whole = AnnotatedTake(motion, (), tuple(happens))
    said = dict(zip((h.sentence for h in happens), meanings or [h.facts for h in happens], strict=True))
    marked = [
        Marked(text, tuple(whole.spans(meaning)), meaning, bool(meaning & ACTIONS.keys()))
        for text, meaning in said.items()
    ]
    return AnnotatedTake(motion, tuple(marked), whole.happens)


def _acted(
    rng: Generator, wanted: float, draw: Callable[[], Scene], described: Callable[[Group, Generator], Said]
) -> AnnotatedTake:
    clips: list[NDArray[np.float32]] = []
    happens: list[Event] = []
    meanings: list[frozenset[str]] = []
    at = 0.0
    while at < wanted:
        clip = make_clip(draw(), rng)
        for group, (start, end) in zip(clip.scene.steps, clip.spans, strict=True):
            text, meaning = described(group, rng)
            happens.append(Event(text, (at + start, at + end), facts(Scene((group,)))))
            meanings.append(meaning)
        clips.append(clip.joints)
        at += len(clip.joints) / clip.fps
    return annotated_take(Motion(join(clips), FPS), happens, meanings)


def _described(group: Group, rng: Generator) -> Said:
    caption = describe(Scene((group,)), rng)
    return caption.text, facts(caption.scene)


def _unseen_scene(rng: Generator) -> Scene:
    if rng.random() < _UNSEEN_ACTIONS:
        return settle(Scene(((ActionStep(str(rng.choice(sorted(ACTIONS)))),),)), rng)
    scene, style = settle(random_scene(rng), rng), str(rng.choice(sorted(STYLES)))
    return Scene(tuple((_styled(first, style), *others) for first, *others in scene.steps))


def _styled(step: ActionStep, style: str) -> ActionStep:
    return replace(step, style=style if program_of(step.action).styled else "")


def _described_unseen(group: Group, rng: Generator) -> Said:
    first = group[0]
    if first.action in ACTIONS:
        return sentence(first.action, rng), frozenset({first.action})
    plain = tuple(replace(step, style="") for step in group)
    text, meaning = _described(plain, rng)
    if first.style and len(group) == 1 and rng.random() < 0.5:
        return in_the_manner(text, first.style, rng), meaning | {f"{first.action}.style={first.style}"}
    return text, meaning


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
