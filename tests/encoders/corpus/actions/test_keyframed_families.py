"""Programs of key poses (gestures, sports, objects, dance, exercise): bodies, sides, directions, counts, speeds."""

import numpy as np
import pytest

from encoders.corpus.actions.programs import parts_of, programs
from encoders.corpus.engine.curves import LEFT, RIGHT, Curves
from encoders.corpus.engine.posing import OFFSETS, pose
from encoders.corpus.engine.style import NEUTRAL
from encoders.corpus.scene import ActionStep
from encoders.skeleton import INDEX, PARENTS

KEYFRAMED = sorted(n for n, p in programs().items() if not p.make.__module__.startswith("encoders.corpus.actions."))
SIDES = {"left": LEFT, "right": RIGHT}


def perform(step: ActionStep, seed: int = 0, frames: int = 0) -> Curves:
    return programs()[step.action].make(step, NEUTRAL, np.random.default_rng(seed), frames)


def steps_of(name: str) -> list[ActionStep]:
    """The plain step, and one step per supported value of each attribute (the ends of the counts)."""
    p = programs()[name]
    attributes = {
        "side": p.sides, "direction": p.directions, "speed": p.speeds, "amplitude": p.amplitudes, "height": p.heights,
        "count": p.counts or (),
    }  # fmt: skip
    return [
        ActionStep(name),
        *(ActionStep(name, **{field: value}) for field, values in attributes.items() for value in values),
    ]


def wrist_travel(step: ActionStep, side: int, seeds: int = 5) -> float:
    """Mean path length of a wrist, in arm lengths."""
    total = 0.0
    for seed in range(seeds):
        hands = perform(step, seed).hands[:, side]
        total += float(np.linalg.norm(np.diff(hands, axis=0), axis=1).sum())
    return total / seeds


def test_at_least_two_hundred_programs_are_keyframed():
    assert len(KEYFRAMED) >= 200


@pytest.mark.parametrize("name", KEYFRAMED)
def test_every_attribute_gives_plausible_motion(name):
    steps = steps_of(name)
    curves = [perform(step, seed) for seed, step in enumerate(steps)]
    for step, c in zip(steps, curves, strict=True):
        assert 12 <= len(c) <= 20 * 45, step
        assert c.spans == [(0, len(c))], step
    joints = pose(Curves(np.concatenate([c.data for c in curves]), []), OFFSETS)
    assert np.isfinite(joints).all()
    lengths = np.linalg.norm(joints[:, 1:] - joints[:, PARENTS[1:]], axis=-1)
    assert np.ptp(lengths, axis=0).max() < 1e-6
    assert joints[:, INDEX["pelvis"], 1].min() > 0.05
    assert joints[..., 1].min() > -0.12
    seams = np.cumsum([len(c) for c in curves])[:-1]
    speed = 20 * np.delete(np.linalg.norm(np.diff(joints, axis=0), axis=-1), seams - 1, axis=0)
    assert speed.max() < 20.0, "no joint of a body is faster than a pitcher's hand"


ONE_HANDED = [
    n for n in KEYFRAMED if "left" in programs()[n].sides and perform(ActionStep(n, side="left")).parts == {"left_arm"}
]


@pytest.mark.parametrize("name", ONE_HANDED)
def test_the_named_hand_moves_most(name):
    for side, hand in SIDES.items():
        travel = [wrist_travel(ActionStep(name, side=side), of, seeds=2) for of in (LEFT, RIGHT)]
        assert travel[hand] > 2 * travel[1 - hand]


@pytest.mark.parametrize("name", ["wave", "point", "guide", "salute", "phone call", "touch nose", "raise arm", "knock"])
def test_the_other_hand_of_a_one_handed_gesture_stays_free(name):
    assert parts_of(ActionStep(name, side="left")) == {"left_arm"}
    c = perform(ActionStep(name, side="left"))
    if name not in ("guide",):
        assert np.ptp(c.hands[:, RIGHT], axis=0).max() < 0.02


@pytest.mark.parametrize("name", ["wave", "clap", "cheer", "raise arm", "surrender"])
def test_both_hands_move_alike(name):
    side = "both" if "both" in programs()[name].sides else ""
    travel = [wrist_travel(ActionStep(name, side=side), hand) for hand in (LEFT, RIGHT)]
    assert max(travel) < 1.35 * min(travel)


@pytest.mark.parametrize(
    "name", ["kick", "kick ball", "side kick", "roundhouse kick", "raise knee", "raise leg", "leg swing"]
)
@pytest.mark.parametrize("side", ["left", "right"])
def test_the_named_leg_is_raised(name, side):
    for seed in range(4):
        high = perform(ActionStep(name, side=side), seed).feet[..., 1].max(axis=0)
        assert high[SIDES[side]] > high[1 - SIDES[side]] + 0.05


def peaks(values: np.ndarray) -> int:
    """Number of maxima near the highest, with a clear dip between them."""
    low, high = values.min(), values.max()
    count, armed = 0, True
    for value in (values - low) / (high - low):
        if armed and value > 0.85:
            count, armed = count + 1, False
        elif value < 0.6:
            armed = True
    return count


COUNTED = {
    "jumping jacks": lambda c: c.hands[:, RIGHT, 1],
    "squats with arms": lambda c: -c.root[:, 1],
    "nod": lambda c: c.head[:, 0],
    "shake head": lambda c: c.head[:, 2],
    "raise arm sideways": lambda c: c.hands[:, RIGHT, 0],
    "kick": lambda c: c.feet[:, RIGHT, 1],
    "jab": lambda c: c.hands[:, RIGHT, 2],
    "throw": lambda c: -c.hands[:, RIGHT, 2],
    "toe touch": lambda c: c.pelvis[:, 0],
    "chop wood": lambda c: c.hands[:, RIGHT, 1],
    "push-up": lambda c: -c.root[5 * 4 : -5 * 4, 1],
    "drink": lambda c: c.hands[:, RIGHT, 1],
}


@pytest.mark.parametrize("name", sorted(COUNTED))
@pytest.mark.parametrize("count", [2, 3])
def test_movements_are_repeated_as_often_as_the_count_says(name, count):
    side = "right" if "right" in programs()[name].sides else ""
    hits = [peaks(COUNTED[name](perform(ActionStep(name, side=side, count=count), seed))) == count for seed in range(6)]
    assert sum(hits) >= 5


@pytest.mark.parametrize("name", ["wave", "punch", "dig", "jumping jacks", "dance", "sweep"])
def test_slow_takes_longer_than_fast(name):
    count = 3 if programs()[name].counts else 0
    lengths = [
        np.mean([len(perform(ActionStep(name, speed=speed, count=count), seed)) for seed in range(8)])
        for speed in ("fast", "", "slow")
    ]
    assert lengths[0] < lengths[1] < lengths[2]


@pytest.mark.parametrize("name", ["wave", "stir", "arm circles", "clap"])
def test_large_is_larger_than_small(name):
    def extent(amplitude):
        step = ActionStep(name, amplitude=amplitude, side="right" if name != "clap" else "", count=4)
        hands = [perform(step, seed).hands[15:-15, RIGHT] for seed in range(6)]
        return np.mean([np.ptp(places, axis=0).max() for places in hands])

    assert extent("small") < extent("large")


@pytest.mark.parametrize(
    ("direction", "axis", "sign"), [("left", 0, 1), ("right", 0, -1), ("up", 1, 1), ("forward", 2, 1)]
)
def test_pointing_follows_the_direction(direction, axis, sign):
    for seed in range(5):
        joints = pose(perform(ActionStep("point", direction=direction), seed), OFFSETS)
        arms = (
            joints[:, [INDEX["left_wrist"], INDEX["right_wrist"]]]
            - joints[:, [INDEX["left_shoulder"], INDEX["right_shoulder"]]]
        )
        assert (sign * arms[..., axis]).max() > 0.25


@pytest.mark.parametrize(("direction", "sign"), [("left", 1), ("right", -1)])
@pytest.mark.parametrize("side", ["left", "right"])
def test_guiding_follows_the_direction_with_either_hand(direction, sign, side):
    for seed in range(5):
        joints = pose(perform(ActionStep("guide", direction=direction, side=side), seed), OFFSETS)
        wrist = joints[:, INDEX[f"{side}_wrist"], 0] - joints[:, INDEX["spine3"], 0]
        assert (sign * wrist).max() > 0.1


@pytest.mark.parametrize(("direction", "sign"), [("left", 1), ("right", -1)])
@pytest.mark.parametrize("name", ["look", "tilt head"])
def test_the_head_goes_to_the_named_side(name, direction, sign):
    head = perform(ActionStep(name, direction=direction)).head[:, 2 if name == "look" else 1]
    assert sign * head[np.abs(head).argmax()] > 0.2


@pytest.mark.parametrize(("direction", "sign"), [("counterclockwise", 1), ("clockwise", -1)])
@pytest.mark.parametrize("name", ["spin dance", "pirouette"])
def test_spins_follow_the_direction(name, direction, sign):
    for seed in range(4):
        assert sign * perform(ActionStep(name, direction=direction), seed).heading[-1] > 6.0


@pytest.mark.parametrize(("height", "low", "high"), [("low", 0.0, 0.45), ("high", 1.4, 2.2)])
def test_things_are_picked_up_at_the_named_height(height, low, high):
    wrists = pose(perform(ActionStep("pick up", height=height, side="both")), OFFSETS)[
        :, [INDEX["left_wrist"], INDEX["right_wrist"]], 1
    ]
    reached = wrists.min() if height == "low" else wrists.max()
    assert low <= reached <= high


def test_a_gesture_fills_the_time_it_is_given():
    assert abs(len(perform(ActionStep("cross arms"), frames=120)) - 120) < 12
    assert len(perform(ActionStep("clap"), frames=160)) > len(perform(ActionStep("clap"), frames=60))


@pytest.mark.parametrize("name", ["wave", "guide", "punch", "dance", "cross arms", "pick up"])
def test_two_performances_differ(name):
    first, second = perform(ActionStep(name), 1), perform(ActionStep(name), 2)
    frames = min(len(first), len(second))
    assert np.abs(first.data[:frames] - second.data[:frames]).max() > 0.05


def test_feet_without_key_poses_stay_in_place():
    for name in ("wave", "drink", "clap", "cry"):
        feet = perform(ActionStep(name)).feet
        assert np.ptp(feet, axis=0).max() == 0.0
