"""Synthetic training pairs: scenes, random or parsed from human sentences, as motion features with captions."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.random import Generator
from numpy.typing import NDArray

from encoders.corpus.composition.facts import entailment, facts
from encoders.corpus.composition.open_scenes import accompanied, complete_scene, unmentioned
from encoders.corpus.composition.scene_clips import make_clip
from encoders.corpus.language.caption_generation import describe
from encoders.corpus.language.hard_negatives import contrasting_scene
from encoders.corpus.language.parsing import parse
from encoders.corpus.language.random_scenes import random_gait, random_scene
from encoders.corpus.scene import ActionStep, Scene
from encoders.features.registry import FeatureKind
from encoders.motion import Motion

#: Share of captions that do not say which hand or foot acts: "raises one hand".
_SIDE_OMITTED = 0.35


@dataclass(frozen=True)
class SyntheticClip:
    """One synthetic clip with its captions.

    Attributes
    ----------
    features : float32 (T, F)
    scene : Scene
    spans : start and end of each step group, seconds
    captions, meanings : sentences, and the facts that each states
    hard_negatives : for each caption a similar sentence that is false, "" where there is none
    """

    features: NDArray[np.float32]
    scene: Scene
    spans: tuple[tuple[float, float], ...]
    captions: tuple[str, ...]
    meanings: tuple[frozenset[str], ...]
    hard_negatives: tuple[str, ...]


def relevance(clips: Sequence[SyntheticClip]) -> NDArray[np.bool_]:
    """Whether the first caption of each clip (rows) is known to describe each clip (columns), its own included."""
    shown = [facts(clip.scene) for clip in clips]
    return entailment([clip.meanings[0] for clip in clips], shown) | np.eye(len(clips), dtype=bool)


def synthetic_clip(
    scene: Scene,
    rng: Generator,
    kind: FeatureKind,
    *,
    captions: Sequence[str] = (),
    count: int = 6,
    held_out: Callable[[str], bool] | None = None,
) -> SyntheticClip:
    """Synthesise a clip of a scene and caption it.

    Parameters
    ----------
    captions : sequence of str
        Sentences that are known to state the scene, kept beside the generated ones.
    count : int
        Captions to generate.
    held_out : callable, optional
        True for sentences that must not be used.
    """
    whole = complete_scene(accompanied(scene, rng), rng)
    clip = make_clip(whole, rng)
    stated = {text: (facts(scene), "") for text in captions}
    for _ in range(count):
        text, meaning, negative = caption_and_hard_negative(whole, rng)
        stated.setdefault(text, (meaning, negative))
    banned = held_out or _none
    texts = [text for text in stated if not banned(text)]
    return SyntheticClip(
        kind.compute(Motion(clip.joints, clip.fps)),
        whole,
        clip.spans,
        tuple(texts),
        tuple(stated[text][0] for text in texts),
        tuple("" if banned(stated[text][1]) else stated[text][1] for text in texts),
    )


def _none(_: str) -> bool:
    return False


def caption_and_hard_negative(scene: Scene, rng: Generator) -> tuple[str, frozenset[str], str]:
    """A caption, the facts that it states, and its hard negative: one attribute or the order is wrong; "" if none.

    Both are generated from the same random state, so that most differ only in the order, side, direction or count.
    """
    shown, seed = facts(scene), int(rng.integers(2**62))
    scene = unmentioned(scene, rng)
    scene = _without_side(scene) if rng.random() < _SIDE_OMITTED else scene
    caption = describe(scene, np.random.default_rng(seed))
    contrast = contrasting_scene(scene, rng)
    if contrast is not None:
        negative = describe(contrast, np.random.default_rng(seed))
        if not facts(negative.scene) <= shown and not facts(caption.scene) <= facts(contrast):
            return caption.text, facts(caption.scene), negative.text
    return caption.text, facts(caption.scene), ""


def _without_side(scene: Scene) -> Scene:
    """The scene with left and right unspecified."""

    def omitted(step: ActionStep) -> ActionStep:
        return replace(step, side="") if step.side in ("left", "right") else step

    return Scene(tuple(tuple(omitted(step) for step in group) for group in scene.steps))


def synthetic_clips(
    seed: int,
    count: int,
    kind: FeatureKind,
    *,
    sentences: Sequence[str] = (),
    human_share: float = 0.4,
    gait_share: float = 0.0,
    longest: float = 12.8,
    held_out: Callable[[str], bool] | None = None,
) -> Iterator[SyntheticClip]:
    """`count` synthetic clips of at most `longest` seconds; deterministic for a seed.

    A share of `gait_share` shows plain locomotion; of the others `human_share` show human sentences that can be parsed.
    """
    rng = np.random.default_rng(seed)
    while count > 0:
        scene: Scene | None = None
        captions: tuple[str, ...] = ()
        if gait_share and rng.random() < gait_share:
            scene = random_gait(rng)
        elif len(sentences) and rng.random() < human_share:
            sentence = sentences[int(rng.integers(len(sentences)))]
            scene = parse(sentence)
            captions = (sentence,)
            if scene is None:
                continue
        clip = synthetic_clip(scene or random_scene(rng), rng, kind, captions=captions, held_out=held_out)
        if clip.captions and len(clip.features) <= longest * kind.fps:
            count -= 1
            yield clip
