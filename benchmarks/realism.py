"""Measures and features of synthetic motion beside real: percentiles and differences, by gait and by family of actions.

    python -m benchmarks.realism data/mocap captions.jsonl [--worst 12] [--families]

Real clips are the captioned spans of the split `train` whose captions all name the gait alone; synthetic ones
act the same step forward. Only frames of locomotion count. Printed are, for each measure, the 10th, 50th and 90th
percentile over synthetic and over real clips, and the share of real clips within the range of the synthetic; then the
features that differ most: their mean, standard deviation between clips, and standard deviation within a clip.

With `--families` other actions are compared, whole clips of them: how far and fast the body moves and turns, how the
trunk leans and twists, where the hands are, and how clips begin and end.
"""

from __future__ import annotations

import argparse
import re
from collections.abc import Iterable
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from encoders.corpus.actions.programs import programs, sample_step
from encoders.corpus.composition.captioned_motion import real_clips
from encoders.corpus.composition.synthetic_pairs import synthetic_clip
from encoders.corpus.scene import ActionStep, Scene
from encoders.features.canonical import FPS, LAYOUT, POINTS
from encoders.features.registry import FEATURE_KINDS
from indexer.datasets.captioned_takes import captioned_takes

Array = NDArray[np.float32]

_BODY = FEATURE_KINDS["body"]
_AHEAD = LAYOUT["root_velocity"].start + 2
#: Action, what its captions say, and the speed (m/s) from which it is under way.
_GAITS = (
    ("walk", r"walk", 0.5),
    ("run", r"\brun", 1.2),
    ("jog", r"\bjog", 1.2),
    ("sprint", r"sprint|\brun.*fast", 1.2),
)
_BESIDES = re.compile(
    r"turn|back|circle|side|left|right|diag|veer|around|zig|curv|stair|step|climb|bend|crouch|limp|tip|sneak|march|jump|"
    r"danc|wave|carr|hold|arm|hand|hill"
)
_SIDES = ("left", "right")
#: Family, what a caption of it says, and its actions.
_FAMILIES = (
    ("strikes", r"\b(punch|box|jab|strik|hook)", ("punch", "box", "jab", "hook")),
    ("kicks", r"\bkick(?!.*ball)", ("kick", "side kick", "roundhouse kick")),
    ("evasions and blocks", r"\b(dodg|duck|avoid|evad|block|defen)", ("dodge", "duck", "block")),
    ("carrying", r"\b(carr|holding)", ("carry", "carry on shoulder")),
    ("crawling", r"\bcrawl", ("crawl",)),
    ("jumping", r"\b(jump|leap)", ("jump", "leap")),
    ("standing", r"\bstand(s|ing)?\b(?! up)", ("stand",)),
    ("leaning, bending, twisting", r"\b(lean|bend|twist)", ("lean", "bend forward", "twist torso", "side bend")),
    ("throwing and swinging", r"\b(throw|swing|golf)", ("throw", "golf swing", "swing bat", "tennis swing")),
    ("lying and getting up", r"\b(lay|lie|lying|gets? up|falls?)\b", ("lie down", "get up", "fall")),
)


def main() -> None:
    """Print two tables a gait, or one a family."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=Path)
    parser.add_argument("captions", type=Path)
    parser.add_argument("--worst", type=int, default=12)
    parser.add_argument("--synthetic", type=int, default=150, help="clips of each gait")
    parser.add_argument("--families", action="store_true", help="compare families of actions instead of gaits")
    arguments = parser.parse_args()
    takes = captioned_takes(arguments.folder, arguments.captions, "train")
    real = [clip for take in takes for clip in real_clips(take, _BODY, varied=False)]
    rng = np.random.default_rng(0)
    for name, pattern, actions in _FAMILIES if arguments.families else ():
        fitting = [x for x, captions in real if any(re.search(pattern, caption) for caption in captions)]
        scenes = [Scene(((sample_step(programs()[action], rng),),)) for action in actions]
        clips = [
            synthetic_clip(scenes[i % len(scenes)], rng, _BODY, count=1).features for i in range(arguments.synthetic)
        ]
        print(f"\n{name}: {len(fitting)} real clips, {len(clips)} synthetic")
        if fitting:
            _table([carriage(x) for x in clips], [carriage(x) for x in fitting])
    for action, pattern, speed in () if arguments.families else _GAITS:
        fitting = [x for x, captions in real if all(re.search(pattern, c) and not _BESIDES.search(c) for c in captions)]
        scene = Scene(((ActionStep(action, direction="forward"),),))
        clips = [synthetic_clip(scene, rng, _BODY, count=1).features for _ in range(arguments.synthetic)]
        print(f"\n{action}: {len(fitting)} real clips, {len(clips)} synthetic")
        if not fitting:
            continue
        synthetic, known = _under_way(clips, speed), _under_way(fitting, speed)
        _measure(synthetic, known)
        _compare(_figures(synthetic), _figures(known), arguments.worst)


def _under_way(clips: Iterable[Array], speed: float) -> list[Array]:
    going = (x[x[:, _AHEAD] > speed] for x in clips)
    return [x for x in going if len(x) >= 8]


def measures(x: Array) -> dict[str, float]:
    """What gait analysis measures of one clip's features (T, F): metres, seconds, degrees."""
    points = x[:, LAYOUT["positions"]].reshape(len(x), -1, 3).astype(np.float64)
    place = {name: points[:, i] for i, name in enumerate(POINTS)}
    up, velocity = x[:, LAYOUT["trunk_up"]], x[:, LAYOUT["root_velocity"]]
    hips, chest = (_yaw(x[:, LAYOUT[f"{part}_forward"]]) for part in ("pelvis", "chest"))
    apart = place["left_ankle"][:, 2] - place["right_ankle"][:, 2]
    steps = np.count_nonzero(np.diff(np.signbit(apart - apart.mean()))) / (len(x) / FPS)
    speed = float(np.hypot(velocity[:, 0], velocity[:, 2]).mean())
    elbows = np.stack([_angle(*(place[f"{s}_{j}"] for j in ("shoulder", "elbow", "wrist"))) for s in _SIDES])
    swings = np.stack([_pitch(place[f"{s}_elbow"] - place[f"{s}_shoulder"]) for s in _SIDES])
    ankles = np.stack([place[f"{s}_ankle"] for s in _SIDES])
    knees = np.stack([place[f"{s}_knee"] for s in _SIDES])
    wrists = np.stack([place[f"{s}_wrist"] - place[f"{s}_shoulder"] for s in _SIDES])
    wrists[1, :, 0] *= -1
    lean = np.degrees(np.arctan2(up[:, 2], up[:, 1]))
    return {
        "speed": speed,
        "steps a second": steps,
        "step length": speed / max(steps, 0.5),
        "aside": float(np.degrees(np.arctan2(velocity[:, 0].mean(), velocity[:, 2].mean()))),
        "hips' rise (velocity)": float(velocity[:, 1].std()),
        "hips' sway (velocity)": float(velocity[:, 0].std()),
        "hips' surge (velocity)": float(velocity[:, 2].std()),
        "lean": float(lean.mean()),
        "lean's swing": float(lean.std()),
        "roll's swing": float(np.degrees(up[:, 0].std())),
        "hips against chest": float((hips - chest).std()),
        "elbow bend": float(elbows.mean()),
        "elbow's swing": _swing(elbows),
        "upper arm": float(swings.mean()),
        "upper arm's swing": _swing(swings),
        "wrist outward": float(wrists[..., 0].mean()),
        "wrist height": float(wrists[..., 1].mean()),
        "wrist ahead": float(wrists[..., 2].mean()),
        "feet apart": float((place["left_ankle"] - place["right_ankle"])[:, 0].mean()),
        "knee lift": float(np.percentile(knees[..., 1], 95)),
        "knee ahead": float(np.percentile(knees[..., 2], 95)),
        "heel kick (ankle's height)": float(np.percentile(ankles[..., 1], 95)),
        "foot behind": float(np.percentile(ankles[..., 2], 5)),
        "foot ahead": float(np.percentile(ankles[..., 2], 95)),
        "on the ground": float(x[:, LAYOUT["contacts"]].mean()),
    }


def _yaw(forward: Array) -> Array:
    return np.asarray(np.degrees(np.arctan2(forward[:, 0], forward[:, 2])))


def _pitch(limb: NDArray[np.float64]) -> NDArray[np.float64]:
    return np.degrees(np.arctan2(limb[:, 2], -limb[:, 1]))


def _angle(*joints: NDArray[np.float64]) -> NDArray[np.float64]:
    """Bend of a limb of three joints (T,), 0 straight."""
    upper, lower = joints[1] - joints[0], joints[2] - joints[1]
    cosine = (upper * lower).sum(-1) / (np.linalg.norm(upper, axis=-1) * np.linalg.norm(lower, axis=-1) + 1e-9)
    return np.asarray(np.degrees(np.arccos(np.clip(cosine, -1.0, 1.0))))


def _swing(angles: NDArray[np.float64]) -> float:
    low, high = np.percentile(angles, [5, 95], axis=1)
    return float((high - low).mean())


def carriage(x: Array) -> dict[str, float]:
    """How the whole body moves in one clip's features (T, F), whatever it does: metres, seconds, degrees."""
    points = x[:, LAYOUT["positions"]].reshape(len(x), -1, 3).astype(np.float64)
    place = {name: points[:, i] for i, name in enumerate(POINTS)}
    up, velocity = x[:, LAYOUT["trunk_up"]].astype(np.float64), x[:, LAYOUT["root_velocity"]].astype(np.float64)
    hips, chest = (np.unwrap(_yaw(x[:, LAYOUT[f"{part}_forward"]]), period=360) for part in ("pelvis", "chest"))
    lean, aside = np.degrees(np.arctan2(up[:, 2], up[:, 1])), np.degrees(np.arcsin(np.clip(up[:, 0], -1, 1)))
    wrists = np.stack([place[f"{s}_wrist"] - place[f"{s}_shoulder"] for s in _SIDES])
    wrists[1, :, 0] *= -1
    feet = np.stack([place[f"{s}_ankle"] for s in _SIDES])
    ankles = np.stack(
        [x[:, LAYOUT["velocities"]].reshape(len(x), -1, 3)[:, POINTS.index(f"{s}_ankle")] for s in _SIDES]
    )
    moving, second = np.abs(x[:, LAYOUT["velocities"]]).mean(1), int(FPS)
    return {
        "speed of the hips": float(np.hypot(velocity[:, 0], velocity[:, 2]).mean()),
        "fastest (95 %)": float(np.percentile(np.hypot(velocity[:, 0], velocity[:, 2]), 95)),
        "yaw rate (95 %, degrees/s)": float(np.percentile(np.abs(np.degrees(x[:, LAYOUT["yaw_rate"]])), 95)),
        "lean": float(lean.mean()),
        "lean's range": float(np.ptp(np.percentile(lean, [5, 95]))),
        "sideways lean's range": float(np.ptp(np.percentile(aside, [5, 95]))),
        "twist, chest against hips": float(np.abs(chest - hips).mean()),
        "twist's range": float(np.ptp(np.percentile(chest - hips, [5, 95]))),
        "speed of the feet": float(np.linalg.norm(ankles, axis=-1).mean()),
        "feet apart, sideways": float(np.abs(feet[0, :, 0] - feet[1, :, 0]).mean()),
        "feet apart, along": float(np.abs(feet[0, :, 2] - feet[1, :, 2]).mean()),
        "wrist outward": float(wrists[..., 0].mean()),
        "wrist height": float(wrists[..., 1].mean()),
        "wrist ahead": float(wrists[..., 2].mean()),
        "hands apart in height": float(np.abs(wrists[0, :, 1] - wrists[1, :, 1]).mean()),
        "wrist height, first second": float(wrists[:, :second, 1].mean()),
        "wrist height, last second": float(wrists[:, -second:, 1].mean()),
        "movement, first half second": float(moving[: second // 2].mean()),
        "movement, last half second": float(moving[-second // 2 :].mean()),
    }


def _measure(synthetic: list[Array], real: list[Array]) -> None:
    _table([measures(x) for x in synthetic], [measures(x) for x in real])


def _table(ours: list[dict[str, float]], theirs: list[dict[str, float]]) -> None:
    for name in ours[0]:
        a, b = (np.array([clip[name] for clip in clips]) for clips in (ours, theirs))
        low, high = np.percentile(a, [2, 98])
        spread = [" ".join(f"{v:7.2f}" for v in np.percentile(x, [10, 50, 90])) for x in (a, b)]
        print(
            f"  {name:27s} synthetic {spread[0]}   real {spread[1]}   covered {np.mean((b >= low) & (b <= high)):4.0%}"
        )


def _figures(going: list[Array]) -> tuple[Array, Array, Array]:
    """Mean, std between clips and mean std within clips of each feature (F,)."""
    means, moves = np.stack([x.mean(0) for x in going]), np.stack([x.std(0) for x in going])
    return means.mean(0), means.std(0), np.median(moves, axis=0)


def _compare(synthetic: tuple[Array, Array, Array], real: tuple[Array, Array, Array], worst: int) -> None:
    spread = np.sqrt(synthetic[1] ** 2 + real[1] ** 2) + 0.01
    moves = [np.abs(np.log((real[i] + 0.004) / (synthetic[i] + 0.004))) for i in (1, 2)]
    apart = (np.abs(real[0] - synthetic[0]) / spread, *moves)
    for name, difference, a, b in zip(("mean", "between clips", "within clips"), apart, synthetic, real, strict=True):
        rows = np.argsort(-difference)[:worst]
        print(f"  {name}: " + ", ".join(f"{_NAMES[i]} {a[i]:.3f} -> {b[i]:.3f}" for i in rows))


def _names() -> list[str]:
    names = []
    for group, place in LAYOUT.items():
        count = place.stop - place.start
        of_points = [f"{group} {point}.{axis}" for point in POINTS for axis in "xyz"]
        names += of_points if count == len(of_points) else [f"{group}.{i}" for i in range(count)]
    return names


_NAMES = _names()

if __name__ == "__main__":
    main()
