"""What people said of real clips, understood where it can be: as facts, and told again in the corpus' own words.

Made and real clips are to lie together where they show the same. So a real walk is no negative for "somebody strides
along", which was written for a made one, and is itself described that way, too.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import lru_cache

from numpy.random import Generator

from encoders.corpus.actions.programs import program_of
from encoders.corpus.composition.facts import facts
from encoders.corpus.composition.synthetic_pairs import caption_and_hard_negative
from encoders.corpus.language.parsing import parse
from encoders.corpus.scene import ActionStep, Scene

_MANNER = re.compile(r" (?:with|in an?|at an?|as if|as though|towards?|across|down)\b")
#: What shows that words say more than how somebody acts: further clauses, ways to go, limbs that act.
_ACTS = re.compile(
    r",|\b(?:and|then|while|before|after|left|right|circ\w+|diag\w+|sides?|lines?|back\w*|curv\w+|square|legs?|foot"
    r"|feet|knees?|hands?|both|turns?)\b"
)


@dataclass(frozen=True)
class AugmentedCaptions:
    """What is known of a real clip.

    Attributes
    ----------
    facts : what its captions say that it shows
    meanings : for each caption, and then for each of `captions`, the facts it states; of a caption that was not
        understood itself, the actions that the others name
    captions, hard_negatives : the same in other words; for each a sentence that looks alike but is false, or empty
    """

    facts: frozenset[str]
    meanings: tuple[frozenset[str], ...]
    captions: tuple[str, ...]
    hard_negatives: tuple[str, ...]


def augment_captions(
    captions: Sequence[str], rng: Generator, *, scene: Scene | None = None, count: int = 3
) -> AugmentedCaptions | None:
    """What is said of one clip, and `count` more ways to say it; None where no caption is understood.

    `scene` is what the captions say where that is known without reading them.
    """
    scenes = [understood(caption) for caption in captions]
    known = [scene] if scene else [read for read in scenes if read is not None]
    if not known:
        return None
    shown = frozenset().union(*(facts(_ahead(scene)) for scene in known))
    actions = frozenset(fact for fact in shown if not set(fact) & set(".<+"))
    said, stated, false = zip(
        *(caption_and_hard_negative(known[int(rng.integers(len(known)))], rng) for _ in range(count)), strict=True
    )
    meanings = [actions if read is None else facts(read) for read in scenes]
    return AugmentedCaptions(shown, (*meanings, *stated), said, false)


@lru_cache(maxsize=10_000)
def understood(caption: str) -> Scene | None:
    """The scene of a caption, else of what comes before a mere manner, as "a person runs" of "... with bent arms"."""
    manners = [m for m in _MANNER.finditer(caption) if not _ACTS.search(caption, m.start())]
    words = [caption, *(caption[: m.start()] for m in reversed(manners))]
    if not _ACTS.search(caption):
        words += caption.split("/")[:1]
    return next((scene for part in words if (scene := parse(part)) is not None), None)


def _ahead(scene: Scene) -> Scene:
    """The scene, where who goes without a word of direction goes ahead."""

    def going(step: ActionStep) -> ActionStep:
        goes = program_of(step.action).group == "locomotion" and "forward" in program_of(step.action).directions
        return replace(step, direction=step.direction or ("forward" if goes else ""))

    return Scene(tuple(tuple(going(step) for step in group) for group in scene.steps))
