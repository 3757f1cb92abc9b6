"""What people said of real clips, understood where it can be: as facts, and told again in the corpus' own words.

Made and real clips are to lie together where they show the same. So a real walk is no negative for "somebody strides
along", which was written for a made one, and is itself described that way, too.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import lru_cache

from numpy.random import Generator

from encoders.corpus.facts import facts
from encoders.corpus.language import describe, parse
from encoders.corpus.programs import program_of
from encoders.corpus.scene import Scene, Step


@dataclass(frozen=True)
class Retold:
    """What is known of a real clip.

    Attributes
    ----------
    facts : what its captions say that it shows
    meanings : for each caption, and then for each of `captions`, the facts it states; of a caption that was not
        understood itself, the actions that the others name
    captions : the same in other words
    """

    facts: frozenset[str]
    meanings: tuple[frozenset[str], ...]
    captions: tuple[str, ...]


def retell(captions: Sequence[str], rng: Generator, *, count: int = 3) -> Retold | None:
    """What is said of one clip, and `count` more ways to say it; None where no caption is understood."""
    scenes = [_scene(caption) for caption in captions]
    known = [scene for scene in scenes if scene is not None]
    if not known:
        return None
    shown = frozenset().union(*(facts(_ahead(scene)) for scene in known))
    actions = frozenset(fact for fact in shown if not set(fact) & set(".<+"))
    said = [describe(known[int(rng.integers(len(known)))], rng) for _ in range(count)]
    meanings = [actions if scene is None else facts(scene) for scene in scenes]
    return Retold(shown, (*meanings, *(facts(s.scene) for s in said)), tuple(s.text for s in said))


@lru_cache(maxsize=10_000)
def _scene(caption: str) -> Scene | None:
    return parse(caption)


def _ahead(scene: Scene) -> Scene:
    """The scene, where who goes without a word of direction goes ahead."""

    def going(step: Step) -> Step:
        goes = program_of(step.action).group == "locomotion" and "forward" in program_of(step.action).directions
        return replace(step, direction=step.direction or ("forward" if goes else ""))

    return Scene(tuple(tuple(going(step) for step in group) for group in scene.steps))
