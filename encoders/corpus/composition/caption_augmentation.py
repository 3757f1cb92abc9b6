"""Caption augmentation of real clips: their captions parsed into facts and paraphrased in the words of the corpus.

Real and synthetic clips that show the same must be close in the latent space. So a real walk is no negative for
"somebody strides along", a caption of a synthetic walk, and gets such captions itself.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import lru_cache

from numpy.random import Generator

from encoders.corpus.actions.programs import program_of
from encoders.corpus.composition.facts import facts
from encoders.corpus.composition.open_scenes import open_directions
from encoders.corpus.composition.synthetic_pairs import caption_and_hard_negative
from encoders.corpus.language.parsing import parse
from encoders.corpus.scene import ActionStep, Scene

_MANNER_PHRASE = re.compile(r" (?:with|in an?|at an?|as if|as though|towards?|across|down)\b")
#: Words that say more than the manner of an action: further clauses, directions, limbs.
_CONTENT = re.compile(
    r",|\b(?:and|then|while|before|after|left|right|circ\w+|diag\w+|sides?|lines?|back\w*|curv\w+|square|legs?|foot"
    r"|feet|knees?|hands?|both|turns?)\b"
)


@dataclass(frozen=True)
class AugmentedCaptions:
    """The facts of a real clip and paraphrases of its captions.

    Attributes
    ----------
    facts : everything that its captions state
    meanings : the facts that each original caption and then each of `captions` states; for an original caption that
        cannot be parsed, the actions that the others name
    captions : paraphrases
    hard_negatives : for each paraphrase a similar sentence that is false, or ""
    """

    facts: frozenset[str]
    meanings: tuple[frozenset[str], ...]
    captions: tuple[str, ...]
    hard_negatives: tuple[str, ...]


def augment_captions(
    captions: Sequence[str], rng: Generator, *, scene: Scene | None = None, count: int = 3
) -> AugmentedCaptions | None:
    """The facts of one clip's captions and `count` paraphrases; None if no caption can be parsed.

    `scene` is given where it is known, so that it need not be parsed from the captions.
    """
    scenes = [scene_of_caption(caption) for caption in captions]
    known = [scene] if scene else [parsed for parsed in scenes if parsed is not None]
    if not known:
        return None
    shown = frozenset().union(*(facts(_with_default_direction(scene)) for scene in known))
    actions = frozenset(fact for fact in shown if not set(fact) & set(".<+"))
    paraphrases, stated, negatives = zip(
        *(caption_and_hard_negative(known[int(rng.integers(len(known)))], rng) for _ in range(count)), strict=True
    )
    meanings = [actions if parsed is None else facts(parsed) for parsed in scenes]
    return AugmentedCaptions(shown, (*meanings, *stated), paraphrases, negatives)


@lru_cache(maxsize=10_000)
def scene_of_caption(caption: str) -> Scene | None:
    """The scene of a caption, if need be without a phrase of manner: "a person runs" of "... with bent arms"."""
    manners = [m for m in _MANNER_PHRASE.finditer(caption) if not _CONTENT.search(caption, m.start())]
    words = [caption, *(caption[: m.start()] for m in reversed(manners))]
    if not _CONTENT.search(caption):
        words += caption.split("/")[:1]
    return next((scene for part in words if (scene := parse(part)) is not None), None)


def _with_default_direction(scene: Scene) -> Scene:
    """The scene with locomotion of unspecified direction set to forward, unless the action leaves it open."""

    def going(step: ActionStep) -> ActionStep:
        goes = program_of(step.action).group == "locomotion" and open_directions(step.action) == ("forward",)
        return replace(step, direction=step.direction or ("forward" if goes else ""))

    return Scene(tuple(tuple(going(step) for step in group) for group in scene.steps))
