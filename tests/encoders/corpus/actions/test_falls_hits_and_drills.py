"""Falls lie where they say, hits throw the body away from the blow, and crossing limbs meet."""

from __future__ import annotations

import numpy as np
import pytest

from encoders.corpus.scene import ActionStep
from tests.encoders.corpus.performances import joint, perform, plain

WAYS = {"forward": (2, 1), "backward": (2, -1), "left": (0, 1), "right": (0, -1)}


@pytest.mark.parametrize("way", WAYS)
@pytest.mark.parametrize("name", ["fall", "collapse", "die"])
def test_a_fall_ends_lying_in_its_direction(name: str, way: str) -> None:
    axis, sign = WAYS[way]
    for seed in range(3):
        clip = plain(ActionStep(name, direction=way), seed=seed)
        head, hips = joint(clip, "head")[-1], joint(clip, "pelvis")[-1]
        assert head[1] < 0.5
        assert hips[1] < 0.3
        assert sign * (head - hips)[axis] > 0.2


@pytest.mark.parametrize(("name", "sign"), [("trip and fall", 1), ("slip and fall", -1)])
def test_a_walker_trips_forward_and_slips_backward(name: str, sign: int) -> None:
    for seed in range(4):
        clip = plain(ActionStep(name), seed=seed)
        hips, head = joint(clip, "pelvis"), joint(clip, "head")
        assert hips[-1, 2] - hips[0, 2] > 0.5, "the steps before the fall lead ahead"
        assert hips[-1, 1] < 0.3
        assert sign * (head - hips)[-1, 2] > -0.25, "who slips lies on the back or sits"


@pytest.mark.parametrize(("side", "sign"), [("left", -1), ("right", 1)])
@pytest.mark.parametrize("height", ["middle", "high"])
def test_a_hit_throws_the_body_to_the_other_side(side: str, sign: int, height: str) -> None:
    moved = [perform(ActionStep("hit from the side", side=side, height=height), s).root[:, 0] for s in range(4)]
    assert all(sign * x[np.abs(x).argmax()] > 0.05 for x in moved)


def test_a_hit_from_behind_throws_the_body_forward_and_one_from_the_front_back() -> None:
    for seed in range(4):
        behind, front = (perform(ActionStep(f"hit {way}"), seed).root[:, 2] for way in ("from behind", "reaction"))
        assert behind.max() > 0.1
        assert front.min() < -0.05


@pytest.mark.parametrize("side", ["left", "right"])
@pytest.mark.parametrize(
    ("name", "one", "other", "nearer"),
    [
        ("elbow to knee", "knee", "elbow", 0.35),
        ("touch heel", "ankle", "wrist", 0.45),
        ("touch elbow", "wrist", "elbow", 0.2),
        ("touch opposite knee", "wrist", "knee", 0.3),
        ("touch opposite shoulder", "wrist", "shoulder", 0.25),
    ],
)
def test_crossing_limbs_meet(name: str, one: str, other: str, nearer: float, side: str) -> None:
    across = {"left": "right", "right": "left"}[side]
    for seed in range(3):
        clip = plain(ActionStep(name, side=side), seed=seed)
        apart = np.linalg.norm(joint(clip, f"{side}_{one}") - joint(clip, f"{across}_{other}"), axis=1)
        assert apart.min() < nearer


def test_a_jump_that_starts_in_one_step_lands_in_the_next() -> None:
    clip = plain(ActionStep("jump start"), ActionStep("land"), seed=1)
    lowest = np.minimum(joint(clip, "left_ankle"), joint(clip, "right_ankle"))[:, 1]
    assert lowest[0] < 0.12
    assert lowest.max() > 0.2
    assert lowest[-1] < 0.12


def test_bent_knees_keep_the_heels_up() -> None:
    for seed in range(4):
        low = perform(ActionStep("tiptoes with bent knees", count=2), seed)
        deepest = low.root[:, 1].argmin()
        assert low.root[deepest, 1] < 0.85
        assert low.foot_pitch[deepest].max() < -0.3


@pytest.mark.parametrize(("side", "way"), [("left", "right"), ("right", "left")])
def test_a_leg_raised_to_the_other_side_crosses(side: str, way: str) -> None:
    sign, foot = (1, 1) if way == "left" else (-1, 0)
    feet = perform(ActionStep("raise leg", side=side, direction=way)).feet
    highest = feet[:, foot, 1].argmax()
    assert sign * (feet[highest, foot, 0] - feet[highest, 1 - foot, 0]) > 0.0
