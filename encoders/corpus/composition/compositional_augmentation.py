"""New clips out of captioned real ones: two of them joined in a row, or a made gesture on a real walk.

What is joined is aligned and blended as in TEACH (Athanasiou et al. 2022). What is laid over follows the parts, as in
SINC (Athanasiou et al. 2023): arms go along with the trunk they are moved to; legs, heading and place stay together.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.random import Generator
from numpy.typing import NDArray

from encoders.corpus.actions.programs import programs, sample_step
from encoders.corpus.composition.caption_augmentation import understood
from encoders.corpus.composition.captioned_motion import CaptionedTake, mirror_words
from encoders.corpus.composition.concatenation import concatenate_clips
from encoders.corpus.composition.scene_clips import make_clip
from encoders.corpus.composition.synthetic_pairs import caption_and_hard_negative, complete_scene
from encoders.corpus.language.lexicon import entry_of
from encoders.corpus.language.normalisation import drop_auxiliaries, drop_subject, normalise
from encoders.corpus.language.verbs import lemmas
from encoders.corpus.scene import Scene
from encoders.english import gerund
from encoders.motion import FPS, Motion
from encoders.skeleton import INDEX

Array = NDArray[np.float32]

_SHORTEST, _LONGEST = 1.0, 7.0  # seconds of a piece
_WORDS = 14  # of a caption that still can be joined to another
_SPEEDS = (0.85, 1.0, 1.2)
_THEN = (" then {}", ", then {}", " and then {}", " and {}", ", and {}", " before {ing}", ", after that {}")
_WHILE = (" while {ing}", ", {ing} at the same time", " and at the same time {}", ", {ing}")
_ARMS = re.compile(
    r"\b(arms?|hands?|wav\w+|clap\w*|punch\w*|box\w*|throw\w*|point\w*|gestur\w+|carr\w+|hold\w*|elbows?)\b"
)
_GOING = 0.5  # metres a second of the hips
_UNSEEN = 1.25  # a gesture may be longer than the way it is laid over by this factor
_SHOULDERS = [INDEX["left_shoulder"], INDEX["right_shoulder"]]
_ARM = np.array([[INDEX[f"{side}_{joint}"] for joint in ("shoulder", "elbow", "wrist")] for side in ("left", "right")])


@dataclass(frozen=True)
class CaptionedSegment:
    """Joints (T, 22, 3) at 20 frames a second, what people said of them, and the scene where that is understood."""

    joints: Array
    captions: tuple[str, ...]
    scene: Scene | None = None

    @classmethod
    def parsed(cls, joints: Array, captions: tuple[str, ...]) -> CaptionedSegment:
        """A piece with the scene of the first caption that is understood."""
        return cls(joints, captions, next(filter(None, map(understood, captions)), None))

    def varied(self, rng: Generator) -> CaptionedSegment:
        """The piece played at a random speed, perhaps mirrored, its words too."""
        motion = Motion(self.joints, FPS * float(rng.choice(_SPEEDS))).resample(FPS)
        if rng.random() < 0.5:
            return replace(self, joints=motion.joints)
        return CaptionedSegment.parsed(motion.mirror().joints, tuple(map(mirror_words, self.captions)))

    @property
    def speed(self) -> float:
        """How fast the hips travel on average, metres a second."""
        return FPS * float(np.hypot(*np.diff(self.joints[:, 0, [0, 2]], axis=0).T).mean())


@dataclass(frozen=True)
class AugmentedClip:
    """A new motion, sentences that are true of it, for each perhaps one that is not, and the scene where known."""

    motion: Motion
    captions: tuple[str, ...]
    hard_negatives: tuple[str, ...]
    scene: Scene | None


def captioned_segments(takes: Iterable[CaptionedTake]) -> Iterator[CaptionedSegment]:
    """Every captioned part of the takes that is one to seven seconds long and said in few words."""
    for take in takes:
        joints = take.motion.resample(FPS).joints
        for span in take.spans:
            first, last = int(span.start * FPS), int(min(span.end, take.motion.duration) * FPS)
            said = tuple(c.strip(" .") for c in span.captions if len(c.split()) <= _WORDS and "then" not in c)
            if said and _SHORTEST <= (last - first) / FPS <= _LONGEST:
                yield CaptionedSegment.parsed(joints[first:last], said)


def concatenate_segments(first: CaptionedSegment, second: CaptionedSegment, rng: Generator) -> AugmentedClip:
    """One after the other; what is not true has the order hard_negatives."""
    motion = Motion(concatenate_clips([first.joints, second.joints]), FPS)
    chances = rng.integers(2**62, size=2)
    true, false = (
        tuple(_say(a, b, _THEN, np.random.default_rng(chance)) for chance in chances)
        for a, b in ((first, second), (second, first))
    )
    scene = Scene((*first.scene.steps, *second.scene.steps)) if first.scene and second.scene else None
    return AugmentedClip(motion, true, false, scene)


def overlay_arms(carrier: CaptionedSegment, gesture: CaptionedSegment, rng: Generator) -> AugmentedClip:
    """The gesture's arms on the carrier's body, for as long as both last; nothing can be hard_negatives."""
    frames = min(len(carrier.joints), len(gesture.joints))
    motion = Motion(replace_arms(carrier.joints[:frames], gesture.joints[:frames]), FPS)
    scene = None
    if carrier.scene and gesture.scene and len(carrier.scene.steps) == len(gesture.scene.steps) == 1:
        scene = Scene(((*carrier.scene.steps[0], *gesture.scene.steps[0]),))
    return AugmentedClip(motion, tuple(_say(carrier, gesture, _WHILE, rng) for _ in range(2)), (), scene)


def replace_arms(body: Array, other: Array) -> Array:
    """`body` (T, 22, 3) with the arms of `other`, turned as its trunk is and in its own bone lengths."""
    moved: Array = body.copy()
    turn = _chest(body) @ _chest(other).transpose(0, 2, 1)
    for upper, lower in ((0, 1), (1, 2)):
        bone = other[:, _ARM[:, lower]] - other[:, _ARM[:, upper]]
        own = np.linalg.norm(body[:, _ARM[:, lower]] - body[:, _ARM[:, upper]], axis=-1, keepdims=True)
        bone *= own / np.maximum(np.linalg.norm(bone, axis=-1, keepdims=True), 1e-6)
        moved[:, _ARM[:, lower]] = moved[:, _ARM[:, upper]] + np.einsum("tij,tsj->tsi", turn, bone)
    return moved


def _chest(joints: Array) -> Array:
    """Axes (T, 3, 3) of the trunk as columns: to the left, up, forward."""
    left = joints[:, _SHOULDERS[0]] - joints[:, _SHOULDERS[1]]
    up = joints[:, _SHOULDERS].mean(1) - joints[:, INDEX["pelvis"]]
    left /= np.maximum(np.linalg.norm(left, axis=-1, keepdims=True), 1e-6)
    up -= (up * left).sum(-1, keepdims=True) * left
    up /= np.maximum(np.linalg.norm(up, axis=-1, keepdims=True), 1e-6)
    axes: Array = np.stack([left, up, np.cross(left, up)], axis=-1)
    return axes


def synthetic_gesture(rng: Generator) -> CaptionedSegment:
    """A made movement of arms or head alone, and two sentences about it."""
    gestures = [p for p in programs().values() if not p.parts & {"legs", "spine"} and entry_of(p.name) is not None]
    scene = complete_scene(Scene(((sample_step(gestures[int(rng.integers(len(gestures)))], rng),),)), rng)
    return CaptionedSegment(
        make_clip(scene, rng).joints,
        tuple(caption_and_hard_negative(scene, rng)[0].strip(" .") for _ in range(2)),
        scene,
    )


def augmented_clips(
    takes: Iterable[CaptionedTake], count: int, rng: Generator, *, over: float = 0.4
) -> Iterator[AugmentedClip]:
    """`count` new motions with their sentences.

    A share of `over` are gestures laid over a way to go that says nothing of arms, the others are joined pairs. None
    come of takes that have fewer than two captioned pieces.
    """
    found = list(captioned_segments(takes))
    carriers = [p for p in found if p.speed > _GOING and not _ARMS.search(" ".join(p.captions))]
    while count > 0 and len(found) > 1:
        if carriers and rng.random() < over:
            carrier, gesture = carriers[int(rng.integers(len(carriers)))].varied(rng), synthetic_gesture(rng)
            if len(gesture.joints) > _UNSEEN * len(carrier.joints):
                continue
            yield overlay_arms(carrier, gesture, rng)
        else:
            first, second = (found[int(i)].varied(rng) for i in rng.choice(len(found), 2, replace=False))
            yield concatenate_segments(first, second, rng)
        count -= 1


def _say(first: CaptionedSegment, second: CaptionedSegment, ways: Sequence[str], rng: Generator) -> str:
    """A sentence about both, the second without its subject where that can be told."""
    head = first.captions[int(rng.integers(len(first.captions)))]
    tail = second.captions[int(rng.integers(len(second.captions)))]
    bare = drop_subject(normalise(tail))
    verb, space, rest = drop_auxiliaries(bare).partition(" ")
    base = lemmas().get(verb)
    options = [way for way in ways if base or "{ing}" not in way]
    way = options[int(rng.integers(len(options)))]
    plain = bare.removeprefix("is ").removeprefix("are ") or tail
    return head + way.format(plain, ing=f"{gerund(base)}{space}{rest}" if base else plain)
