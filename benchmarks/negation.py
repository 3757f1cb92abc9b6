"""How well search takes away what a sentence negates: "walks without turning", "kicks, not left", "jumps -forward".

    python -m benchmarks.negation data/hdm05 data/mocap captions.jsonl

Each question asks for one thing without another, of an archive whose clips are known to show both, one or none:
labelled clips, some of them mirrored; the same joined two by two; synthetic scenes; scenes of actions drawn by chance,
which nothing was chosen by; captioned takes, by the words of their captions. Right is what has the first and not the
second. Printed are, for each way, the mean average precision; how often a right clip comes first; how often a right
clip comes before one that has both; and the share of clips that have both among the first ten.
"""

from __future__ import annotations

import argparse
import re
import warnings
from collections.abc import Callable, Iterable, Iterator
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from encoders.bundle.bundle import Bundle
from encoders.corpus.actions.programs import programs
from encoders.corpus.composition.scene_clips import make_clip
from encoders.corpus.scene import ActionStep, Scene
from encoders.english import gerund, third_person
from encoders.metrics import average_precision
from encoders.motion import Motion
from encoders.protocol import unrelated_motions
from indexer.datasets.captioned_takes import captioned_takes
from indexer.datasets.labelled_clips import LabelledClips, labelled_clips
from search.evaluate.gallery import Gallery
from search.query.encoding import encode_queries
from search.query.negation import parts_of
from search.query.paraphrases import VERBS, is_action

Scores = NDArray[np.float64]

#: Label -> asked for, and taken away.
_LABELS = {
    "squat1Reps": ("squats", "squatting"),
    "hopBothLegs1hops": ("hops", "jumping"),
    "kickLFront1Reps": ("kicks", "kicking"),
    "throwBasketball": ("throws a ball", "throwing"),
    "rotateArmsBothBackward1Reps": ("circles both arms", "circling the arms"),
    "sneak2StepsLStart": ("sneaks forward", "sneaking"),
    "depositFloorR": ("puts something on the floor", "putting something on the floor"),
    "elbowToKnee1RepsLelbowStart": ("touches the knee with the elbow", "touching the knee with the elbow"),
}
#: Asked for, taken away, the labels of both (by their beginnings), of the second; "~" mirrored.
_LABELLED = """
goes down to the floor | lying down | squat deposit ~deposit lieDown | lieDown
moves forward | running | sneak ~sneak jog ~jog | jog ~jog
moves forward | sneaking | sneak ~sneak jog ~jog | sneak ~sneak
lifts a knee | kicking | kick ~kick elbow | kick ~kick
lifts a leg | touching it with the elbow | kick ~kick elbow | elbow
raises the arms | throwing | grab ~grab rotate throw ~throw | throw ~throw
raises an arm | circling the arms | grab ~grab rotate throw ~throw | rotate
bends the knees | jumping | squat hop sneak ~sneak | hop
bends the knees | squatting | squat hop sneak ~sneak | squat
bends down | lying down | squat deposit ~deposit lieDown | lieDown
bends down | putting something on the floor | squat deposit ~deposit lieDown | deposit ~deposit
kicks forward | left | kick ~kick | kick
kicks forward | right | kick ~kick | ~kick
kicks | with the left leg | kick ~kick | kick
kicks | with the right leg | kick ~kick | ~kick
reaches up high | with the right hand | grab ~grab | grab
reaches up high | with the left hand | grab ~grab | ~grab
puts something down on the floor | with the right hand | deposit ~deposit | deposit
puts something down on the floor | with the left hand | deposit ~deposit | ~deposit
jogs in a circle | to the left | jog ~jog | jog
jogs in a circle | to the right | jog ~jog | ~jog
"""
_MIRRORED = ("kick", "grab", "deposit", "jog", "throw", "sneak")
#: An action, its words, what of it is varied, and the values with words of their own where these differ.
_VARIED = """
jump | jumps | direction | forward, backward, left: to the left, right: to the right, in place
walk | walks | direction | forward, backward, left: to the left, right: to the right
kick | kicks | side | left: with the left leg, right
punch | punches | side | left, right: with the right hand
wave | waves | side | left: with the left hand, right
raise arm | raises an arm | side | left, right
throw | throws something | side | left: with the left hand, right: with the right hand
walk | walks | speed | slow: slowly, fast
turn | turns around | speed | slow: slowly, fast
wave | waves | speed | slow: slowly, fast
run | runs | speed | slow: slowly, fast
turn | turns | direction | left, right: to the right
"""
#: Two actions at the same time ("+") or one after the other, and the words of both.
_TWO = """
walk + carry | walks | carrying something
walk + wave | walks | waving
walk + clap | walks | clapping
walk + phone call | walks | phoning
walk + arms behind back | walks | holding the arms behind the back
walk + hands on hips | walks | putting the hands on the hips
walk + cross arms | walks | crossing the arms
walk + shield eyes | walks | shielding the eyes
stand + carry | stands | carrying something
stand + wave | stands | waving
stand + clap | stands | clapping
stand + hands on hips | stands | putting the hands on the hips
stand + cross arms | stands | crossing the arms
walk , sit down | walks | sitting down
walk , turn | walks | turning
walk , fall | walks | falling
walk , stumble | walks | stumbling
run , jump | runs | jumping
run , fall | runs | falling
squat , jump | squats | jumping
jump , squat | jumps | squatting
jump , clap | jumps | clapping
box , kick | boxes | kicking
box , dodge | boxes | dodging
wave + walk | waves | walking
carry + walk | carries something | walking
sit down , walk | sits down | walking
fall , run | falls | running
"""
_CAPTIONED = r"""
walks | turning | walk | turn|circl|back
walks | climbing | walk | climb|stair|ladder
walks | dancing | walk | danc|salsa
walks | slowly | walk | slow|sad
walks | to the left | walk | left
walks | swinging the arms | walk | swing|sway
runs | jumping | \brun|jog | jump|leap
runs | diagonally | \brun|jog|sprint | diagonal|left|right
jumps | running | jump|leap|hop | \brun|jog|sprint
dances | spinning | danc|salsa | spin|twirl|circ|turn
dances | salsa | danc|salsa | salsa
climbs | climbing a ladder | climb | ladder
dribbles a ball | running | dribbl|ball | \brun
raises the arms | dancing | arms|hands | danc|salsa
kicks | kicking a ball | kick | ball
moves the arms | punching | arms | punch|kung|box
does exercises | squatting | exercise|stretch|squat|jumping jack | squat
"""
#: Clips of each synthetic scene, and pairs of actions drawn by chance.
_CLIPS, _DRAWN = 6, 50


class Asked(NamedTuple):
    """What is asked for, what is taken away, which clips show the first, and which the second."""

    wanted: str
    unwanted: str
    has: NDArray[np.bool_]
    has_unwanted: NDArray[np.bool_]

    def sentence(self, number: int) -> str:
        """The question in one of the ways that people put it."""
        if " " not in self.unwanted and number % 3 == 2:
            return f"{self.wanted} -{self.unwanted}"
        if number % 3 == 1:
            return f"{self.wanted}, not {self.unwanted}"
        is_action = self.unwanted.split()[0].endswith("ing")
        return f"{self.wanted} without {self.unwanted}" if is_action else f"{self.wanted} but not {self.unwanted}"


Archive = tuple[list[Motion], list[Asked]]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    for name in ("labelled", "captioned", "captions"):
        parser.add_argument(name, type=Path)
    arguments = parser.parse_args()
    warnings.simplefilter("ignore")
    rng, bundle, archive = np.random.default_rng(0), Bundle.load(), labelled_clips(arguments.labelled)
    _report(bundle, "labelled clips", _labelled(archive))
    _report(bundle, "labelled clips joined two by two", _joined(archive, rng))
    _report(bundle, "synthetic scenes", _synthetic(rng))
    _report(bundle, "synthetic scenes of actions drawn by chance", _drawn(np.random.default_rng(7)))
    _report(bundle, "captioned takes", _captioned(arguments.captioned, arguments.captions))


def _report(bundle: Bundle, name: str, archive: Archive) -> None:
    motions, questions = archive[0], [q for q in archive[1] if (q.has & q.has_unwanted).any()]
    gallery = Gallery(bundle, motions)
    print(f"\n{name}: {len(motions)} clips, {len(questions)} questions")
    print("| way | mean AP | right first | before those with both | with both in first ten |\n|---|---|---|---|---|")
    for way, scores in _ways(bundle, gallery, [q.sentence(i) for i, q in enumerate(questions)]):
        figures = np.mean([_figures(row, q) for row, q in zip(scores, questions, strict=True)], axis=0)
        print(f"| {way} | {figures[0]:.3f} | " + " | ".join(f"{100 * f:.0f} %" for f in figures[1:]) + " |", flush=True)


def _figures(scores: Scores, question: Asked) -> tuple[float, ...]:
    right, both = question.has & ~question.has_unwanted, question.has & question.has_unwanted
    first = np.argsort(-scores, kind="stable")[:10]
    before = float((scores[right][:, None] > scores[both][None]).mean())
    return average_precision(scores, right), float(right[first[0]]), before, float(both[first].mean())


def _ways(bundle: Bundle, gallery: Gallery, sentences: list[str]) -> Iterator[tuple[str, Scores]]:
    parts = [parts_of(sentence) for sentence in sentences]
    assert all(len(part.unwanted) == 1 for part in parts), "a negation that is not understood"
    wanted = encode_queries(bundle, [part.wanted for part in parts])
    unwanted = encode_queries(bundle, [part.unwanted[0] for part in parts])
    of_wanted = gallery.scores(wanted)
    yield "the sentence as it is", gallery.scores(bundle.encode_texts(sentences))
    yield "the negated part dropped", of_wanted
    yield "**search**", gallery.scores(encode_queries(bundle, sentences))
    halved = wanted - 0.5 * unwanted
    yield "half of the vector subtracted", gallery.scores(halved / np.linalg.norm(halved, axis=1, keepdims=True))
    background = unrelated_motions(bundle)
    if background is not None:
        beside = encode_queries(bundle, [f"{part.wanted} {part.unwanted[0]}" for part in parts])
        vectors = np.where([[is_action(part.unwanted[0])] for part in parts], unwanted, beside)
        level = np.percentile(vectors @ background.T, 95, axis=1)[:, None]
        above = np.maximum(0, gallery.scores(vectors) - level)
        yield "score less what is above the background", of_wanted - above


def _rows(table: str) -> Iterator[list[str]]:
    for line in table.strip().splitlines():
        yield [cell.strip() for cell in line.split(" | ")]


def _labelled(archive: LabelledClips) -> Archive:
    pairs = list(zip(archive.motions, archive.labels, strict=True))
    pairs += [(motion.mirror(), f"~{label}") for motion, label in pairs if label.startswith(_MIRRORED)]

    def of(beginnings: str) -> NDArray[np.bool_]:
        return np.array([label.startswith(tuple(beginnings.split())) for _, label in pairs])

    asked = [Asked(wanted, unwanted, of(both), of(second)) for wanted, unwanted, both, second in _rows(_LABELLED)]
    return [motion for motion, _ in pairs], asked


def _joined(archive: LabelledClips, rng: np.random.Generator) -> Archive:
    clips = [(motion, {label}) for motion, label in zip(archive.motions, archive.labels, strict=True)]
    by_label = {name: [motion for motion, labels in clips if name in labels] for name in _LABELS}
    for first, second in _pairs(_LABELS):
        for a, b in rng.integers(len(by_label[first]), size=(2, 2)):
            clips.append((_one_after_another(by_label[first][a], by_label[second][b]), {first, second}))
    has = {name: np.array([name in labels for _, labels in clips]) for name in _LABELS}
    asked = [Asked(_LABELS[a][0], _LABELS[b][1], has[a], has[b]) for a, b in _pairs(_LABELS)]
    return [motion for motion, _ in clips], asked


def _pairs(names: Iterable[str]) -> list[tuple[str, str]]:
    return [(a, b) for a in names for b in names if a != b]


def _one_after_another(first: Motion, second: Motion) -> Motion:
    """The second motion from where the first ended, eased over a few frames."""
    shift = (first.joints[-1, 0] - second.joints[0, 0]) * [1, 0, 1]
    following = second.resample(first.fps).joints + shift
    ease = np.linspace(1, 0, 8)[: len(following), None, None]
    following[: len(ease)] += ease * (first.joints[-1] - following[0])
    return Motion(np.concatenate([first.joints, following]).astype(np.float32), first.fps)


def _synthetic(rng: np.random.Generator) -> Archive:
    scenes: list[tuple[Scene, set[str]]] = []
    named: list[tuple[str, str, str, str]] = []
    for action, words, attribute, values in _rows(_VARIED):
        for value in values.split(", "):
            name, _, own = value.partition(": ")
            scenes.append((Scene(((ActionStep(action, **{attribute: name}),),)), {action, f"{attribute}={name}"}))
            named.append((words, own or (name if name != "slow" else "slowly"), action, f"{attribute}={name}"))
    for pair, words, unwanted in _rows(_TWO):
        first, how, second = re.split(r" ([+,]) ", pair)
        steps = ActionStep(first), ActionStep(second)
        scenes.append((Scene((steps,) if how == "+" else ((steps[0],), (steps[1],))), {first, second}))
        scenes.append((Scene(((steps[0],),)), {first}))
        named.append((words, unwanted, first, second))
    clips = [(Motion(make_clip(scene, rng).joints), facts) for scene, facts in scenes for _ in range(_CLIPS)]

    def of(fact: str) -> NDArray[np.bool_]:
        return np.array([fact in facts for _, facts in clips])

    return [motion for motion, _ in clips], [Asked(w, u, of(first), of(second)) for w, u, first, second in named]


def _drawn(rng: np.random.Generator) -> Archive:
    """Actions drawn by chance, alone and one after the other: nothing was chosen by them."""
    names = [
        n for n, p in programs().items() if n.split()[0] in VERBS and not p.held_out and p.starts == p.ends == "stand"
    ]
    pairs = rng.permutation(names)[: 2 * _DRAWN].reshape(-1, 2).tolist()
    shown = [names for pair in pairs for names in (pair, pair[:1], pair[1:]) for _ in range(_CLIPS)]
    motions = [Motion(make_clip(Scene(tuple((ActionStep(n),) for n in names)), rng).joints) for names in shown]

    def of(name: str) -> NDArray[np.bool_]:
        return np.array([name in names for names in shown])

    asked = [Asked(_inflected(a, third_person), _inflected(b, gerund), of(a), of(b)) for a, b in pairs]
    return motions, asked


def _inflected(name: str, form: Callable[[str], str]) -> str:
    verb, space, rest = name.partition(" ")
    return form(verb) + space + rest


def _captioned(folder: Path, captions: Path) -> Archive:
    spans = {}
    for take in captioned_takes(folder, captions, "val"):
        for span in take.spans:
            text = " | ".join([take.description, *span.captions]).lower()
            spans.setdefault((take.trial, span.start), (take.motion.crop(span.start, span.end), text))

    def of(pattern: str) -> NDArray[np.bool_]:
        return np.array([bool(re.search(pattern, text)) for _, text in spans.values()])

    asked = [Asked(wanted, unwanted, of(first), of(second)) for wanted, unwanted, first, second in _rows(_CAPTIONED)]
    return [motion for motion, _ in spans.values()], asked


if __name__ == "__main__":
    main()
