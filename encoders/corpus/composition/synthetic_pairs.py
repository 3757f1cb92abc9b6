"""Made training pairs: scenes drawn at random or read out of human sentences, acted out, and described."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.random import Generator
from numpy.typing import NDArray

from encoders.corpus.actions.programs import program_of
from encoders.corpus.composition.facts import entailment, facts
from encoders.corpus.composition.scene_clips import make_clip
from encoders.corpus.language.caption_generation import describe
from encoders.corpus.language.hard_negatives import contrasting_scene
from encoders.corpus.language.parsing import parse
from encoders.corpus.language.random_scenes import random_gait, random_scene
from encoders.corpus.scene import ActionStep, Scene
from encoders.features.registry import FeatureKind
from encoders.motion import Motion

#: Share of captions that leave open which hand or foot acts: "raises one hand".
_EITHER = 0.35


@dataclass(frozen=True)
class SyntheticClip:
    """One made clip with sentences that are true of it, and the facts each of them states.

    Attributes
    ----------
    features : float32 (T, F)
    scene : Scene
    spans : ((start, end) seconds per step group)
    captions, meanings : sentences, and the facts that each states
    hard_negatives : for each caption one that looks alike but is false, empty where there is none
    """

    features: NDArray[np.float32]
    scene: Scene
    spans: tuple[tuple[float, float], ...]
    captions: tuple[str, ...]
    meanings: tuple[frozenset[str], ...]
    hard_negatives: tuple[str, ...]


def relevance(clips: Sequence[SyntheticClip]) -> NDArray[np.bool_]:
    """Whether the first sentence of each clip (rows) is known to be true of each clip (columns); of its own it is."""
    shown = [facts(clip.scene) for clip in clips]
    return entailment([clip.meanings[0] for clip in clips], shown) | np.eye(len(clips), dtype=bool)


def complete_scene(scene: Scene, rng: Generator) -> Scene:
    """Sides and directions that the scene leaves open are decided, so that what is true of the clip is known."""

    def decided(step: ActionStep) -> ActionStep:
        action = program_of(step.action)
        side = step.side or (str(rng.choice(action.sides)) if action.sides else "")
        ahead = "forward" if "forward" in action.directions else ""
        return replace(step, side=side, direction=step.direction or ahead)

    return Scene(tuple(tuple(decided(step) for step in group) for group in scene.steps))


def synthetic_clip(
    scene: Scene,
    rng: Generator,
    kind: FeatureKind,
    *,
    said: Sequence[str] = (),
    count: int = 6,
    held_out: Callable[[str], bool] | None = None,
) -> SyntheticClip:
    """Act a scene out and describe it.

    Parameters
    ----------
    said : sequence of str
        Sentences already known to say what `scene` says.
    count : int
        Captions to write.
    held_out : callable, optional
        Sentences that must not be used.
    """
    whole = complete_scene(scene, rng)
    clip = make_clip(whole, rng)
    stated = {text: (facts(scene), "") for text in said}
    for _ in range(count):
        text, meaning, twin = caption_and_hard_negative(whole, rng)
        stated.setdefault(text, (meaning, twin))
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
    """A caption, the facts it states, and its twin: the same wording, of which one thing is false; empty if none is.

    Both are written with the same chance, so that most differ in nothing but the order, side, direction or count.
    """
    shown, chance = facts(scene), int(rng.integers(2**62))
    scene = _either(scene) if rng.random() < _EITHER else scene
    true = describe(scene, np.random.default_rng(chance))
    wrong = contrasting_scene(scene, rng)
    if wrong is not None:
        false = describe(wrong, np.random.default_rng(chance))
        if not facts(false.scene) <= shown and not facts(true.scene) <= facts(wrong):
            return true.text, facts(true.scene), false.text
    return true.text, facts(true.scene), ""


def _either(scene: Scene) -> Scene:
    """The scene without which hand or foot acts, where it is one."""

    def either(step: ActionStep) -> ActionStep:
        return replace(step, side="") if step.side in ("left", "right") else step

    return Scene(tuple(tuple(either(step) for step in group) for group in scene.steps))


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
    """`count` made clips of at most `longest` seconds; the same seed makes the same clips.

    In `gait_share` of them somebody just goes; of the others `human_share` act out human sentences that can be read
    surely.
    """
    rng = np.random.default_rng(seed)
    while count > 0:
        scene: Scene | None = None
        said: tuple[str, ...] = ()
        if gait_share and rng.random() < gait_share:
            scene = random_gait(rng)
        elif len(sentences) and rng.random() < human_share:
            sentence = sentences[int(rng.integers(len(sentences)))]
            scene = parse(sentence)
            said = (sentence,)
            if scene is None:
                continue
        made = synthetic_clip(scene or random_scene(rng), rng, kind, said=said, held_out=held_out)
        if made.captions and len(made.features) <= longest * kind.fps:
            count -= 1
            yield made
