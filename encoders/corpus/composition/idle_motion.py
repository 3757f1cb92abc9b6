"""Real motion of people who stand and wait, as clips of its own and before, after and under other actions.

Nobody described these takes. What the hands do is read from the motion; the sentences are the corpus' own.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np
from numpy.random import Generator

from encoders.corpus.actions.programs import programs, sample_step
from encoders.corpus.composition.compositional_augmentation import (
    Array,
    AugmentedClip,
    CaptionedSegment,
    overlay_arms,
    replace_arms,
    synthetic_gesture,
    upright_hands,
)
from encoders.corpus.composition.concatenation import concatenate_clips
from encoders.corpus.composition.open_scenes import complete_scene
from encoders.corpus.composition.scene_clips import make_clip
from encoders.corpus.composition.synthetic_pairs import caption_and_hard_negative
from encoders.corpus.language.lexicon import entry_of
from encoders.corpus.scene import ActionStep, Scene
from encoders.motion import FPS, Motion

_SHORTEST, _LONGEST = 2.0, 7.0  # seconds of a piece
_STILL = 0.05  # metres per second of the hands, on average, below which somebody hardly moves
_WAIT = ActionStep("wait")
_SUBJECTS = ("a person ", "someone ", "the person ", "a man ", "a woman ", "somebody ", "a figure ", "")
_WAITS = (
    "stands and waits", "stands around", "is just standing there", "waits for something to happen", "stands idle",
    "waits in place", "stands about doing nothing", "stands relaxed", "hangs around", "is waiting for someone",
    "passes the time on the spot", "loiters", "stands in a queue", "waits for the bus", "stands there listening",
    "kills time standing", "lingers without doing anything in particular", "idles", "remains where they are",
)  # fmt: skip
_STILLS = (
    "stands still", "stands without moving", "hardly moves while standing", "stays in one spot, quiet",
    "stands motionless", "stands calmly", "keeps standing in the same spot", "does not move from the spot",
)  # fmt: skip
_FIDGETS = (
    "fidgets while standing", "shifts from foot to foot while waiting", "stands restlessly", "waits impatiently",
    "cannot quite stand still", "stands and moves a little", "shuffles about in place while waiting",
    "waits and looks around now and then",
)  # fmt: skip
#: What the hands do -> what is said of it, and the action that it is, if it is one.
_HANDS: dict[str, tuple[tuple[str, ...], str]] = {
    "folded": (
        ("stands with folded arms", "waits with arms crossed over the chest", "stands with arms crossed",
         "keeps the arms folded and waits", "stands there, arms folded"),
        "cross arms",
    ),
    "clasped": (
        ("stands with hands clasped in front", "holds both hands together before the belly", "waits with hands folded",
         "stands with one hand in the other", "keeps the hands joined at the waist"),
        "",
    ),
    "behind": (
        ("stands with hands behind the back", "waits, hands clasped behind the back", "keeps both hands at the back"),
        "hands behind back",
    ),
    "hanging": (
        ("stands with arms hanging", "stands with hands at the sides", "lets the arms hang and waits",
         "stands upright, arms by the sides"),
        "",
    ),
}  # fmt: skip


def _hands(joints: Array) -> str:
    """What the hands of a piece (T, 22, 3) do, a key of `_HANDS`, or ""."""
    left, right = (hand.mean(axis=0) for hand in upright_hands(joints).swapaxes(0, 1))
    across, up, ahead = (left + right) / 2
    if across < -0.25 and up > -0.7 and ahead > 0.1:
        return "folded"
    if across < -0.12 and ahead > 0.2 and up < -0.6:
        return "clasped"
    if across < 0.0 and ahead < 0.02 and up < -0.7:
        return "behind"
    return "hanging" if min(-left[1], -right[1]) > 0.9 else ""


def idle_segments(motions: Sequence[Motion], rng: Generator) -> list[CaptionedSegment]:
    """Pieces of two to seven seconds of all takes, with sentences and scenes."""
    found = []
    for motion in motions:
        joints, at = motion.resample(FPS).joints, int(rng.integers(0, 20))
        while at + int(_SHORTEST * FPS) < len(joints):
            frames = int(rng.uniform(_SHORTEST, _LONGEST) * FPS)
            found.append(_captioned(joints[at : at + frames], rng))
            at += frames
    return found


def _captioned(joints: Array, rng: Generator) -> CaptionedSegment:
    hands = _hands(joints)
    pace = FPS * float(np.linalg.norm(np.diff(joints[:, 20:22], axis=0), axis=-1).mean())
    said, action = _HANDS.get(hands, ((), ""))
    pools = (_WAITS, _STILLS if pace < _STILL else _FIDGETS, said or _WAITS)
    captions = tuple(str(rng.choice(_SUBJECTS)) + pool[int(rng.integers(len(pool)))] for pool in (*pools, _WAITS))
    return CaptionedSegment(joints, captions, Scene((((_WAIT, ActionStep(action)) if action else (_WAIT,)),)))


def idle_clips(
    motions: Sequence[Motion], others: Sequence[CaptionedSegment], count: int, rng: Generator
) -> Iterator[AugmentedClip]:
    """`count` clips with idle motion: alone, before and after real or synthetic actions, or under or over them.

    `others` are captioned segments of real actions.
    """
    idle = idle_segments(motions, rng)
    makers = (_alone, _alone, _around, _around, _under, _arms_of)
    while count > 0 and idle:
        piece = idle[int(rng.integers(len(idle)))].varied(rng)
        piece = replace(piece, scene=piece.scene or Scene(((_WAIT,),)))
        clip = makers[int(rng.integers(len(makers)))](piece, idle, others, rng)
        if clip is not None:
            yield clip
            count -= 1


def _alone(
    piece: CaptionedSegment, idle: Sequence[CaptionedSegment], others: Sequence[CaptionedSegment], rng: Generator
) -> AugmentedClip | None:
    return AugmentedClip(Motion(piece.joints, FPS), piece.captions, (), piece.scene)


def _around(
    piece: CaptionedSegment, idle: Sequence[CaptionedSegment], others: Sequence[CaptionedSegment], rng: Generator
) -> AugmentedClip | None:
    """Waiting before an action, after it, or both; the captions are those of the action."""
    real = len(others) > 0 and rng.random() < 0.6
    action = others[int(rng.integers(len(others)))].varied(rng) if real else _synthetic(rng, legs=False)
    if action is None:
        return None
    before, after = (piece.joints[: int(rng.uniform(0.4, 2.5) * FPS)] for _ in range(2))
    kind = rng.random()
    parts = [action.joints] if kind < 0.35 else [before, action.joints]
    if kind < 0.35 or kind > 0.7:
        parts.append(after[::-1])
    return AugmentedClip(Motion(concatenate_clips(parts), FPS), action.captions, (), action.scene)


def _under(
    piece: CaptionedSegment, idle: Sequence[CaptionedSegment], others: Sequence[CaptionedSegment], rng: Generator
) -> AugmentedClip | None:
    """A synthetic gesture of arms and head with the trunk and the legs of somebody who waits."""
    gesture = synthetic_gesture(rng)
    if len(gesture.joints) > len(piece.joints):
        return None
    joints = overlay_arms(piece, gesture, rng).motion.joints
    return AugmentedClip(Motion(joints, FPS), gesture.captions, (), gesture.scene)


def _arms_of(
    piece: CaptionedSegment, idle: Sequence[CaptionedSegment], others: Sequence[CaptionedSegment], rng: Generator
) -> AugmentedClip | None:
    """A synthetic action of the legs with the arms of somebody who waits."""
    action = _synthetic(rng, legs=True)
    if action is None:
        return None
    arms = piece.joints[np.minimum(np.arange(len(action.joints)), len(piece.joints) - 1)]
    return AugmentedClip(Motion(replace_arms(action.joints, arms), FPS), action.captions, (), action.scene)


def _synthetic(rng: Generator, *, legs: bool) -> CaptionedSegment | None:
    """A synthetic action that begins and ends standing, with two captions; one of the legs alone, if so wanted."""
    fitting = [
        p
        for p in programs().values()
        if entry_of(p.name) is not None and p.starts == p.ends == "stand" and (not legs or p.parts <= {"legs"})
    ]
    scene = complete_scene(Scene(((sample_step(fitting[int(rng.integers(len(fitting)))], rng),),)), rng)
    joints = make_clip(scene, rng).joints
    if len(joints) > _LONGEST * FPS:
        return None
    captions = tuple(caption_and_hard_negative(scene, rng)[0] for _ in range(2))
    return CaptionedSegment(joints, captions, scene)
