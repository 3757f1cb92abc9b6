"""How often the right one of three clips comes first that differ in a count, or in an angle that is turned.

    python -m benchmarks.amounts data/hdm05 data/mocap captions.jsonl

Synthetic: the same action two or more times, or turns on the spot. Real: labelled clips of one repetition, played once,
twice and three times, and cuts of four seconds of captioned takes whose hips turn by about 90, 180 and 360 degrees from
first to last frame. Each sentence, such as "squats three times", ranks the three as search does; chance is 33 %.
"""

from __future__ import annotations

import argparse
import warnings
from itertools import combinations
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from encoders.bundle.bundle import Bundle
from encoders.corpus.actions.programs import programs
from encoders.corpus.composition.scene_clips import make_clip
from encoders.corpus.scene import ActionStep, Scene
from encoders.motion import Motion
from encoders.skeleton import INDEX
from indexer.datasets.captioned_takes import captioned_takes
from indexer.datasets.labelled_clips import labelled_clips
from search.query.amounts import amounts_of
from search.query.encoding import encode_queries
from search.ranking.by_amounts import bonus

#: What is asked of which, the clips in order of the sentences.
Case = tuple[list[str], list[Motion]]

_ACTIONS = 60
_WORDS = {1: "once", 2: "twice", 3: "three times", 4: "four times"}
_ONCE = {
    "squat1Reps": "squats",
    "hopBothLegs1hops": "hops with both feet",
    "kickLFront1Reps": "kicks with the left leg",
    "elbowToKnee1RepsLelbowStart": "touches the knee with the elbow",
    "rotateArmsBothBackward1Reps": "circles both arms backward",
    "throwBasketball": "throws a basketball",
    "grabHighR": "reaches up high with the right hand",
}
_ANGLES = {90: (70, 110), 180: (155, 205), 360: (320, 400)}
_SECONDS = 4.0


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    for name in ("labelled", "captioned", "captions"):
        parser.add_argument(name, type=Path)
    arguments = parser.parse_args()
    warnings.simplefilter("ignore")
    rng, bundle = np.random.default_rng(0), Bundle.load()
    takes = [take.motion for take in captioned_takes(arguments.captioned, arguments.captions, "val")]
    print("| right one of three first | by cosine alone | measured | questions |\n|---|---|---|---|")
    _report("counts, synthetic", bundle, _synthetic_counts(rng))
    _report("degrees, synthetic", bundle, _synthetic_turns(rng))
    _report("counts, real", bundle, _real_counts(arguments.labelled))
    _report("degrees, real", bundle, _real_turns(takes, rng))


def _report(name: str, bundle: Bundle, cases: list[Case]) -> None:
    right = np.concatenate([_is_first(bundle, *case) for case in cases], axis=1).mean(axis=1)
    print(f"| {name} | {100 * right[0]:.0f} % | {100 * right[1]:.0f} % | {3 * len(cases)} |", flush=True)


def _is_first(bundle: Bundle, sentences: list[str], motions: list[Motion]) -> NDArray[np.bool_]:
    """Whether the right clip comes first for each sentence, by cosine alone and measured (2, 3)."""
    scores = encode_queries(bundle, sentences) @ bundle.encode_motions(motions).T
    added = np.array([[bonus(motion, amounts_of(sentence)) for motion in motions] for sentence in sentences])
    return np.array([scores.argmax(axis=1), (scores + added).argmax(axis=1)]) == np.arange(len(motions))


def _synthetic_counts(rng: np.random.Generator) -> list[Case]:
    counted = [name for name, program in programs().items() if program.counts and "spin" not in name]
    cases = []
    for name in rng.permutation(counted)[:_ACTIONS]:
        least, most = programs()[name].counts or (1, 1)
        counts = [count for count in _WORDS if least <= count <= most]
        clips = {count: _made(rng, ActionStep(str(name), count=count)) for count in counts}
        for three in combinations(counts, 3):
            cases.append(([f"{name} {_WORDS[count]}" for count in three], [clips[count] for count in three]))
    return cases


def _synthetic_turns(rng: np.random.Generator) -> list[Case]:
    sentences = ["turns 90 degrees to the left", "turns 90 degrees to the right", "turns 180 degrees"]
    spins = [f"spins {_WORDS[count]}" for count in (1, 2, 3)]
    turns = [ActionStep("turn", direction=direction) for direction in ("left", "right", "around")]
    rounds = [ActionStep("spin", count=count) for count in (1, 2, 3)]
    return [
        (texts, [_made(rng, step) for step in steps])
        for _ in range(20)
        for texts, steps in ((sentences, turns), (spins, rounds))
    ]


def _made(rng: np.random.Generator, step: ActionStep) -> Motion:
    return Motion(make_clip(Scene(((step,),)), rng).joints)


def _real_counts(folder: Path) -> list[Case]:
    archive = labelled_clips(folder)
    chosen = [(label, motion) for label, motion in zip(archive.labels, archive.motions, strict=True) if label in _ONCE]
    return [
        ([f"{_ONCE[label]} {_WORDS[count]}" for count in (1, 2, 3)], [_repeated(motion, count) for count in (1, 2, 3)])
        for label, motion in chosen
    ]


def _repeated(motion: Motion, count: int) -> Motion:
    """A motion so often one after the other, each from where the last one ended, eased over a few frames."""
    joints = motion.joints
    parts = [joints]
    for _ in range(count - 1):
        shift = (parts[-1][-1, 0] - joints[0, 0]) * [1, 0, 1]
        following = joints + shift
        ease = np.linspace(1, 0, 8)[: len(following), None, None]
        following[: len(ease)] += ease * (parts[-1][-1] - following[0])
        parts.append(following)
    return Motion(np.concatenate(parts).astype(np.float32), motion.fps)


def _real_turns(takes: list[Motion], rng: np.random.Generator) -> list[Case]:
    found: dict[int, list[Motion]] = {angle: [] for angle in _ANGLES}
    for take in takes:
        for start in np.arange(0, take.duration - _SECONDS, 1.0):
            cut = take.crop(start, start + _SECONDS)
            across = cut.joints[:, INDEX["left_hip"]] - cut.joints[:, INDEX["right_hip"]]
            heading = np.degrees(np.unwrap(np.arctan2(-across[:, 2], across[:, 0])))
            for angle, (least, most) in _ANGLES.items():
                if least <= abs(heading[-1] - heading[0]) <= most:
                    found[angle].append(cut)
    many = min(map(len, found.values()))
    orders = [rng.permutation(len(cuts))[:many] for cuts in found.values()]
    sentences = [f"turns {angle} degrees" for angle in found]
    return [
        (sentences, [cuts[i] for cuts, i in zip(found.values(), row, strict=True)]) for row in zip(*orders, strict=True)
    ]


if __name__ == "__main__":
    main()
