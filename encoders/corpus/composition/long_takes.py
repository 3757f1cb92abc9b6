"""Long takes with exact annotations: synthetic actions in sequence, held-out ones, or real clips concatenated."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.random import Generator
from numpy.typing import NDArray

from encoders.corpus.actions.programs import program_of
from encoders.corpus.composition.concatenation import concatenate_clips
from encoders.corpus.composition.facts import facts
from encoders.corpus.composition.open_scenes import complete_scene
from encoders.corpus.composition.scene_clips import make_clip
from encoders.corpus.heldout.queries import ACTION_QUERIES, STYLE_PHRASES, action_query, with_style
from encoders.corpus.language.caption_generation import describe
from encoders.corpus.language.random_scenes import random_scene
from encoders.corpus.scene import ActionStep, Scene, StepGroup
from encoders.motion import FPS, Motion

_HELD_OUT_ACTIONS = 0.4  # share of the clips of a held-out take; the others have a held-out style


@dataclass(frozen=True)
class Annotation:
    """A sentence and all spans (seconds) of a take that it describes.

    Attributes
    ----------
    meaning : frozenset of str
        The facts that it states; it describes every event with all of them.
    held_out : bool
        Whether it names a held-out action.
    """

    sentence: str
    spans: tuple[tuple[float, float], ...]
    meaning: frozenset[str] = frozenset()
    held_out: bool = False


@dataclass(frozen=True)
class Event:
    """A span (seconds) of a take with its sentence and all its facts."""

    sentence: str
    span: tuple[float, float]
    facts: frozenset[str]


@dataclass(frozen=True)
class AnnotatedTake:
    """A take with its annotations, and its events in order of time."""

    motion: Motion
    annotations: tuple[Annotation, ...]
    events: tuple[Event, ...] = ()

    def spans(self, meaning: frozenset[str]) -> list[tuple[float, float]]:
        """The spans (seconds) of the events with all facts of `meaning`; none for an empty one."""
        return [event.span for event in self.events if meaning and meaning <= event.facts]


def synthetic_take(rng: Generator, *, least: float = 30.0, most: float = 120.0) -> AnnotatedTake:
    """A synthetic take of random actions in sequence; it ends with the first clip past `least` to `most` seconds.

    Each action gets one sentence, annotated with every span that it is known to describe.
    """
    return _take(rng, rng.uniform(least, most), lambda: complete_scene(random_scene(rng), rng), _describe)


def heldout_take(rng: Generator, *, least: float = 30.0, most: float = 120.0) -> AnnotatedTake:
    """As `synthetic_take`, of actions and styles that no training clip shows (`encoders.corpus.heldout`).

    Two clips in five are held-out actions in any style; the others are known actions in held-out styles, which half of
    their sentences name. The seams are held out as well: inside a training clip `joining` carries one movement into
    the next; here clips of different performers are blended by `concatenate_clips`.
    """
    return _take(rng, rng.uniform(least, most), lambda: _heldout_scene(rng), _describe_heldout)


def joined_take(clips: Sequence[tuple[Motion, str]]) -> AnnotatedTake:
    """Real clips concatenated; a sentence that occurs twice is annotated with both spans."""
    joints = [motion.resample(FPS).joints for motion, _ in clips]
    times = np.cumsum([0, *map(len, joints)]) / FPS
    events = [
        Event(sentence, (float(start), float(end)), frozenset({sentence}))
        for (_, sentence), start, end in zip(clips, times[:-1], times[1:], strict=True)
    ]
    return annotated_take(Motion(concatenate_clips(joints), FPS), events)


def annotated_take(motion: Motion, events: Sequence[Event], meanings: Sequence[frozenset[str]] = ()) -> AnnotatedTake:
    """A take annotated with the sentences of its events; without `meanings` each states all facts of its event."""
    whole = AnnotatedTake(motion, (), tuple(events))
    stated = dict(zip((event.sentence for event in events), meanings or [e.facts for e in events], strict=True))
    annotations = [
        Annotation(sentence, tuple(whole.spans(meaning)), meaning, bool(meaning & ACTION_QUERIES.keys()))
        for sentence, meaning in stated.items()
    ]
    return AnnotatedTake(motion, tuple(annotations), whole.events)


def _take(
    rng: Generator,
    seconds: float,
    draw: Callable[[], Scene],
    caption: Callable[[StepGroup, Generator], tuple[str, frozenset[str]]],
) -> AnnotatedTake:
    """Clips of drawn scenes up to that length; `caption` gives a step group's sentence and the facts it states."""
    clips: list[NDArray[np.float32]] = []
    events: list[Event] = []
    meanings: list[frozenset[str]] = []
    at = 0.0
    while at < seconds:
        clip = make_clip(draw(), rng)
        for group, (start, end) in zip(clip.scene.steps, clip.spans, strict=True):
            text, meaning = caption(group, rng)
            events.append(Event(text, (at + start, at + end), facts(Scene((group,)))))
            meanings.append(meaning)
        clips.append(clip.joints)
        at += len(clip.joints) / clip.fps
    return annotated_take(Motion(concatenate_clips(clips), FPS), events, meanings)


def _describe(group: StepGroup, rng: Generator) -> tuple[str, frozenset[str]]:
    caption = describe(Scene((group,)), rng)
    return caption.text, facts(caption.scene)


def _heldout_scene(rng: Generator) -> Scene:
    if rng.random() < _HELD_OUT_ACTIONS:
        return complete_scene(Scene(((ActionStep(str(rng.choice(sorted(ACTION_QUERIES)))),),)), rng)
    scene, style = complete_scene(random_scene(rng), rng), str(rng.choice(sorted(STYLE_PHRASES)))
    return Scene(tuple((_styled(first, style), *others) for first, *others in scene.steps))


def _styled(step: ActionStep, style: str) -> ActionStep:
    return replace(step, style=style if program_of(step.action).styled else "")


def _describe_heldout(group: StepGroup, rng: Generator) -> tuple[str, frozenset[str]]:
    first = group[0]
    if first.action in ACTION_QUERIES:
        return action_query(first.action, rng), frozenset({first.action})
    plain = tuple(replace(step, style="") for step in group)
    text, meaning = _describe(plain, rng)
    if first.style and len(group) == 1 and rng.random() < 0.5:
        return with_style(text, first.style, rng), meaning | {f"{first.action}.style={first.style}"}
    return text, meaning
