"""Locomotion follows the step's direction, speed and count; feet stay planted in stance."""

from __future__ import annotations

import numpy as np
import pytest

from encoders.corpus.actions.programs import programs
from encoders.corpus.composition.scene_clips import make_clip
from encoders.corpus.engine.curves import ANKLE, Curves
from encoders.corpus.engine.posing import OFFSETS, pose
from encoders.corpus.engine.style import Manner
from encoders.corpus.scene import ActionStep, Scene
from encoders.skeleton import INDEX
from tests.encoders.corpus.performances import joint, peaks, perform, plain


@pytest.mark.parametrize(
    "step",
    [
        ActionStep("walk", direction="forward"),
        ActionStep("walk", direction="clockwise"),
        ActionStep("walk", direction="backward"),
        ActionStep("turn", direction="left"),
        ActionStep("sidestep", direction="left"),
        ActionStep("squat", count=2),
        ActionStep("march"),
    ],
    ids=str,
)
def test_feet_do_not_slide_in_stance(step: ActionStep) -> None:
    curves = perform(step)
    flat = (np.abs(curves.feet[..., 1] - ANKLE) < 1e-3) & (np.abs(curves.foot_pitch) < 1e-3)
    stands = flat[1:] & flat[:-1]
    assert stands.mean() > 0.15
    speed = np.linalg.norm(np.diff(curves.feet[..., [0, 2]], axis=0), axis=-1) * 20
    assert speed[stands].mean() < 0.02, "planted in the curves"
    posed = pose(curves, OFFSETS)[:, [INDEX["left_ankle"], INDEX["right_ankle"]]]
    speed = np.linalg.norm(np.diff(posed[..., [0, 2]], axis=0), axis=-1) * 20
    assert speed[stands].mean() < 0.05, "and within reach of the legs"


@pytest.mark.parametrize(("direction", "toward"), [
    ("forward", (0, 1)), ("backward", (0, -1)), ("left", (1, 0)), ("right", (-1, 0)),
    ("forward-left", (1, 1)), ("forward-right", (-1, 1)), ("backward-left", (1, -1)),
])  # fmt: skip
def test_walking_follows_the_direction_with_plus_x_to_the_left(direction: str, toward: tuple[int, int]) -> None:
    for seed in range(6):
        curves = perform(ActionStep("walk", direction=direction), seed, 100)
        way = curves.root[-1, [0, 2]] - curves.root[0, [0, 2]]
        for axis in (0, 1):
            if toward[axis]:
                assert way[axis] * toward[axis] > 0.3
    assert plain(ActionStep("walk", direction="forward")).joints[0, INDEX["left_hip"], 0] > 0


@pytest.mark.parametrize(
    ("direction", "sign"), [("left", 1), ("right", -1), ("counterclockwise", 1), ("clockwise", -1)]
)
def test_turning_left_is_counterclockwise_from_above(direction: str, sign: int) -> None:
    assert all(sign * perform(ActionStep("turn", direction=direction), seed).heading[-1] > 0.9 for seed in range(4))
    assert sign * perform(ActionStep("spin jump", direction=direction)).heading[-1] > 0.9
    clip = plain(ActionStep("turn", direction=direction))
    across = joint(clip, "left_hip") - joint(clip, "right_hip")
    turned = np.unwrap(np.arctan2(-across[:, 2], across[:, 0]))
    assert sign * (turned[-1] - turned[0]) > 0.9


def test_walking_in_place_stays_and_back_and_forth_returns() -> None:
    assert np.abs(perform(ActionStep("walk", direction="in place")).root[:, [0, 2]]).max() < 0.1
    curves = perform(ActionStep("walk", direction="back and forth"), 0, 160)
    assert np.ptp(curves.root[:, 2]) > 1
    assert np.abs(np.gradient(curves.heading)).max() > 0.05


@pytest.mark.parametrize(("name", "low", "high"), [("walk", 0.7, 1.8), ("run", 0.9, 5.2), ("sprint", 1.6, 7.1)])
def test_gaits_go_at_human_speeds(name: str, low: float, high: float) -> None:
    for seed in range(8):
        speed = (
            np.linalg.norm(
                np.diff(perform(ActionStep(name, direction="forward"), seed, 80).root[:, [0, 2]], axis=0), axis=1
            )
            * 20
        )
        assert low < np.median(speed) < high


def _ahead(curves: Curves) -> np.ndarray:
    return np.diff(curves.root[:, 2]) * 20


def test_a_sprint_is_fast_in_any_manner_but_a_run_may_be_slow() -> None:
    tired = Manner(pace=-0.6, stride=-0.5)

    def speeds(name: str) -> list[float]:
        step, make = ActionStep(name, direction="forward"), programs()[name].make
        return [
            float(np.percentile(_ahead(make(step, tired, np.random.default_rng(seed), 80)), 90)) for seed in range(12)
        ]

    assert min(speeds("sprint")) > 2.3
    assert max(speeds("run")) < 2.3


def test_a_slower_run_lifts_the_feet_less_and_stands_longer() -> None:
    slow, fast = (
        [
            perform(ActionStep("run", direction="forward", speed=speed), seed, 80).feet[..., 1] - ANKLE
            for seed in range(12)
        ]
        for speed in ("slow", "fast")
    )
    assert np.mean([x.max() for x in slow]) < 0.75 * np.mean([x.max() for x in fast])
    assert np.mean([(x < 0.02).mean() for x in slow]) > np.mean([(x < 0.02).mean() for x in fast])


def test_arm_carriage_varies_between_runners() -> None:
    hands = np.array(
        [perform(ActionStep("run", direction="forward"), seed, 80).hands.mean(axis=(0, 1)) for seed in range(40)]
    )
    outward, height = hands[:, 0], hands[:, 1]
    assert height.min() < -0.75 < -0.6 < height.max()
    assert outward.min() < 0.06
    assert outward.max() > 0.2


def test_turns_at_speed_have_a_wide_radius() -> None:
    for seed in range(12):
        clip = make_clip(
            Scene(((ActionStep("sprint", direction="back and forth", amplitude="large"),),)),
            np.random.default_rng(seed),
        )
        head = np.linalg.norm(np.diff(joint(clip, "head"), axis=0), axis=-1) * clip.fps
        assert head.max() < 14


@pytest.mark.parametrize(("direction", "sign"), [("left", 1), ("right", -1)])
def test_sidesteps_keep_facing_ahead(direction: str, sign: int) -> None:
    turned = []
    for seed in range(8):
        curves = perform(ActionStep("sidestep", direction=direction), seed)
        turned.append(np.abs(curves.heading).max())
        assert sign * (curves.root[-1, 0] - curves.root[0, 0]) > 0.3
    assert np.median(turned) < 0.2, "most keep facing ahead"
    assert max(turned) < 0.41, "a straight way bends by at most 0.4"


@pytest.mark.parametrize("count", [1, 3, 6])
@pytest.mark.parametrize(("direction", "axis", "sign"), [("forward", 2, 1), ("backward", 2, -1), ("left", 0, 1)])
def test_single_steps_follow_count_and_direction(direction: str, axis: int, sign: int, count: int) -> None:
    for seed in range(3):
        curves = perform(ActionStep("take steps", direction=direction, count=count), seed)
        lifts = sum(peaks(curves.feet[:, foot, 1], ANKLE + 0.025) for foot in (0, 1))
        assert lifts in ((2 * count,) if direction == "left" else (count, count + 1))  # with and without closing
        assert sign * curves.root[-1, axis] > 0.1 * count


@pytest.mark.parametrize(("direction", "sign"), [("left", 1), ("right", -1)])
def test_half_a_circle_turns_by_half_a_turn(direction: str, sign: int) -> None:
    for seed in range(4):
        assert 2.3 < sign * perform(ActionStep("walk half circle", direction=direction), seed).heading[-1] < 4.0


def test_a_figure_of_eight_turns_both_ways_and_returns() -> None:
    for seed in range(4):
        curves = perform(ActionStep("walk figure eight"), seed)
        assert np.ptp(curves.heading) > 5.0
        assert abs(curves.heading[-1] - curves.heading[0]) < 1.0


@pytest.mark.parametrize(("direction", "axis", "sign"), [("forward", 2, 1), ("backward", 2, -1), ("right", 0, -1)])
def test_a_push_moves_the_body_in_its_direction(direction: str, axis: int, sign: int) -> None:
    for seed in range(5):
        curves = perform(ActionStep("get pushed", direction=direction), seed)
        assert sign * (curves.root[-1, axis] - curves.root[0, axis]) > 0.15
        assert np.abs(np.diff(curves.root[-5:], axis=0)).max() < 0.02, "it stands again"


def test_straight_walks_drift_slightly_and_diagonal_ones_differ_from_them() -> None:
    def aside(direction: str) -> np.ndarray:
        found = []
        for seed in range(40):
            curves = perform(ActionStep("walk", direction=direction), seed, 80)
            way = curves.root[-1, [0, 2]] - curves.root[0, [0, 2]]
            if np.ptp(curves.heading) < 0.3:  # the others turn to where they go
                found.append(np.degrees(np.arctan2(way[0], way[1]) - curves.heading.mean()))
        return np.array(found)

    ahead, diagonal = aside("forward"), aside("forward-left")
    assert np.std(ahead) > 2
    assert np.abs(ahead).max() < 18
    assert 20 < diagonal.min() < diagonal.max() < 70
