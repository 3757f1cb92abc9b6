"""Compositional augmentation: captioned real clips concatenated, or a synthetic gesture overlaid on a real walk.

Concatenation aligns and blends clips as in TEACH (Athanasiou et al. 2022). Overlays are by body part as in SINC
(Athanasiou et al. 2023): arms follow the trunk that they are moved to; legs, heading and position stay together.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.random import Generator
from numpy.typing import NDArray

from encoders.corpus.actions.programs import programs, sample_step
from encoders.corpus.composition.caption_augmentation import scene_of_caption
from encoders.corpus.composition.captioned_motion import CaptionedTake, mirror_words
from encoders.corpus.composition.concatenation import concatenate_clips
from encoders.corpus.composition.open_scenes import complete_scene
from encoders.corpus.composition.scene_clips import make_clip
from encoders.corpus.composition.synthetic_pairs import caption_and_hard_negative
from encoders.corpus.language.lexicon import entry_of
from encoders.corpus.language.normalisation import drop_auxiliaries, drop_subject, normalise
from encoders.corpus.language.verbs import lemmas
from encoders.corpus.scene import Scene
from encoders.english import gerund
from encoders.motion import FPS, Motion
from encoders.skeleton import INDEX

Array = NDArray[np.float32]

_SHORTEST, _LONGEST = 1.0, 7.0  # seconds of a segment
_WORDS = 14  # of a caption that can still be combined with another
_SPEEDS = (0.85, 1.0, 1.2)
_SEQUENTIAL = (" then {}", ", then {}", " and then {}", " and {}", ", and {}", " before {ing}", ", after that {}")
_SIMULTANEOUS = (" while {ing}", ", {ing} at the same time", " and at the same time {}", ", {ing}")
_ARMS = re.compile(
    r"\b(arms?|hands?|wav\w+|clap\w*|punch\w*|box\w*|throw\w*|point\w*|gestur\w+|carr\w+|hold\w*|elbows?)\b"
)
_MIN_SPEED = 0.5  # of a carrier's hips, metres per second
_MAX_RATIO = 1.25  # of a gesture's length to its carrier's
_SHOULDERS = [INDEX["left_shoulder"], INDEX["right_shoulder"]]
_ARM = np.array([[INDEX[f"{side}_{joint}"] for joint in ("shoulder", "elbow", "wrist")] for side in ("left", "right")])


@dataclass(frozen=True)
class CaptionedSegment:
    """Joints (T, 22, 3) at 20 frames per second, their captions, and the scene if a caption can be parsed."""

    joints: Array
    captions: tuple[str, ...]
    scene: Scene | None = None

    @classmethod
    def parsed(cls, joints: Array, captions: tuple[str, ...]) -> CaptionedSegment:
        """A segment with the scene of the first caption that can be parsed."""
        return cls(joints, captions, next(filter(None, map(scene_of_caption, captions)), None))

    def varied(self, rng: Generator) -> CaptionedSegment:
        """The segment at a random playback speed, mirrored (captions too) with probability one half."""
        motion = Motion(self.joints, FPS * float(rng.choice(_SPEEDS))).resample(FPS)
        if rng.random() < 0.5:
            return replace(self, joints=motion.joints)
        return CaptionedSegment.parsed(motion.mirror().joints, tuple(map(mirror_words, self.captions)))

    @property
    def speed(self) -> float:
        """Mean horizontal speed of the hips, metres per second."""
        return FPS * float(np.hypot(*np.diff(self.joints[:, 0, [0, 2]], axis=0).T).mean())


@dataclass(frozen=True)
class AugmentedClip:
    """A composed motion with its captions, a hard negative for each (or none at all), and its scene if known."""

    motion: Motion
    captions: tuple[str, ...]
    hard_negatives: tuple[str, ...]
    scene: Scene | None


def captioned_segments(takes: Iterable[CaptionedTake]) -> Iterator[CaptionedSegment]:
    """Every captioned span of the takes that lasts one to seven seconds and has a short caption."""
    for take in takes:
        joints = take.motion.resample(FPS).joints
        for span in take.spans:
            first, last = int(span.start * FPS), int(min(span.end, take.motion.duration) * FPS)
            captions = tuple(c.strip(" .") for c in span.captions if len(c.split()) <= _WORDS and "then" not in c)
            if captions and _SHORTEST <= (last - first) / FPS <= _LONGEST:
                yield CaptionedSegment.parsed(joints[first:last], captions)


def concatenate_segments(first: CaptionedSegment, second: CaptionedSegment, rng: Generator) -> AugmentedClip:
    """One segment after the other; the hard negatives swap their order."""
    motion = Motion(concatenate_clips([first.joints, second.joints]), FPS)
    seeds = rng.integers(2**62, size=2)
    captions, negatives = (
        tuple(_combine_captions(a, b, _SEQUENTIAL, np.random.default_rng(seed)) for seed in seeds)
        for a, b in ((first, second), (second, first))
    )
    scene = Scene((*first.scene.steps, *second.scene.steps)) if first.scene and second.scene else None
    return AugmentedClip(motion, captions, negatives, scene)


def overlay_arms(carrier: CaptionedSegment, gesture: CaptionedSegment, rng: Generator) -> AugmentedClip:
    """The gesture's arms on the carrier's body, as long as the shorter of both; without hard negatives."""
    frames = min(len(carrier.joints), len(gesture.joints))
    motion = Motion(replace_arms(carrier.joints[:frames], gesture.joints[:frames]), FPS)
    scene = None
    if carrier.scene and gesture.scene and len(carrier.scene.steps) == len(gesture.scene.steps) == 1:
        scene = Scene(((*carrier.scene.steps[0], *gesture.scene.steps[0]),))
    return AugmentedClip(
        motion, tuple(_combine_captions(carrier, gesture, _SIMULTANEOUS, rng) for _ in range(2)), (), scene
    )


def replace_arms(body: Array, other: Array) -> Array:
    """`body` (T, 22, 3) with the arms of `other`, rotated with its trunk and scaled to its bone lengths."""
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


def upright_hands(joints: Array) -> Array:
    """Wrists (T, 2, 3) outward, upward and forward of their own shoulders, in arm lengths, in the trunk's axes."""
    upper, lower = (np.linalg.norm(joints[:, _ARM[:, i]] - joints[:, _ARM[:, i - 1]], axis=-1) for i in (1, 2))
    local = np.einsum("tij,tsi->tsj", _chest(joints), joints[:, _ARM[:, 2]] - joints[:, _ARM[:, 0]])
    hands: Array = local * np.array([[1, 1, 1], [-1, 1, 1]], np.float32) / (upper + lower)[..., None]
    return hands


def synthetic_gesture(rng: Generator) -> CaptionedSegment:
    """A synthetic gesture of arms or head alone, with two captions."""
    gestures = [p for p in programs().values() if not p.parts & {"legs", "spine"} and entry_of(p.name) is not None]
    scene = complete_scene(Scene(((sample_step(gestures[int(rng.integers(len(gestures)))], rng),),)), rng)
    return CaptionedSegment(
        make_clip(scene, rng).joints,
        tuple(caption_and_hard_negative(scene, rng)[0].strip(" .") for _ in range(2)),
        scene,
    )


def augmented_clips(
    takes: Iterable[CaptionedTake], count: int, rng: Generator, *, overlay_share: float = 0.4
) -> Iterator[AugmentedClip]:
    """`count` composed clips with captions.

    A share of `overlay_share` are gestures overlaid on locomotion whose captions do not mention arms; the others are
    concatenated pairs. Takes with fewer than two captioned segments yield none.
    """
    found = list(captioned_segments(takes))
    carriers = [p for p in found if p.speed > _MIN_SPEED and not _ARMS.search(" ".join(p.captions))]
    while count > 0 and len(found) > 1:
        if carriers and rng.random() < overlay_share:
            carrier, gesture = carriers[int(rng.integers(len(carriers)))].varied(rng), synthetic_gesture(rng)
            if len(gesture.joints) > _MAX_RATIO * len(carrier.joints):
                continue
            yield overlay_arms(carrier, gesture, rng)
        else:
            first, second = (found[int(i)].varied(rng) for i in rng.choice(len(found), 2, replace=False))
            yield concatenate_segments(first, second, rng)
        count -= 1


def _combine_captions(
    first: CaptionedSegment, second: CaptionedSegment, templates: Sequence[str], rng: Generator
) -> str:
    """A caption of both segments, the second without its subject where one is recognised."""
    head = first.captions[int(rng.integers(len(first.captions)))]
    tail = second.captions[int(rng.integers(len(second.captions)))]
    bare = drop_subject(normalise(tail))
    verb, space, rest = drop_auxiliaries(bare).partition(" ")
    base = lemmas().get(verb)
    options = [template for template in templates if base or "{ing}" not in template]
    template = options[int(rng.integers(len(options)))]
    plain = bare.removeprefix("is ").removeprefix("are ") or tail
    return head + template.format(plain, ing=f"{gerund(base)}{space}{rest}" if base else plain)
