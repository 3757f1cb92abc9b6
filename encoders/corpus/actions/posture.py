"""Postures and changes between them: stand, sit, squat, crouch, kneel."""

from __future__ import annotations

import numpy as np
from numpy.random import Generator
from numpy.typing import ArrayLike

from encoders.corpus.engine.curves import ANKLE, HIP, LEFT, LEGS, RIGHT, Array, Curves, hold, standing
from encoders.corpus.engine.program import AMPLITUDES, program
from encoders.corpus.engine.stance import step_about
from encoders.corpus.engine.style import Manner
from encoders.corpus.engine.timing import duration
from encoders.corpus.engine.whole_body_poses import STANDING, down_and_up, irregular_wave, perform, pose
from encoders.corpus.scene import ActionStep
from encoders.motion import FPS


@program("stand", group="posture", parts=LEGS, weight=2)
def stand(step: ActionStep, manner: Manner, rng: Generator, frames: int) -> Curves:
    """Stand still, with breathing and slight sway."""
    frames = duration(3.5, step, manner, rng, frames)
    curves = standing(frames, LEGS)
    calm = rng.uniform(0.2, 1.0)
    curves.root[:, 0] += 0.012 * calm * irregular_wave(frames, rng, (0.1, 0.35))
    curves.root[:, 2] += 0.01 * calm * irregular_wave(frames, rng, (0.1, 0.35))
    curves.spine[:, 0] += 0.02 * irregular_wave(frames, rng, (0.2, 0.35))
    curves.head[:, 2] += 0.12 * calm * irregular_wave(frames, rng, (0.1, 0.3))
    curves.feet[..., 0] *= rng.uniform(0.7, 1.8)
    curves.feet[:, :, 2] += rng.normal(0.0, 0.03, 2)
    return curves


@program("shift weight", group="posture", parts=LEGS, sides=("left", "right"))
def shift_weight(step: ActionStep, manner: Manner, rng: Generator, frames: int) -> Curves:
    """Shift the weight from leg to leg; with a side: onto that leg only."""
    frames = duration(3.5, step, manner, rng, frames)
    curves = standing(frames, LEGS)
    if step.side:
        shift = hold(frames, 0.3, 0.25) * (1.0 if step.side == "left" else -1.0)
    else:
        shift = np.sin(2 * np.pi * rng.integers(1, 4) * np.linspace(0, 1, frames)) * hold(frames, 0.15, 0.15)
    curves.feet[..., 0] *= rng.uniform(1.0, 1.8)
    curves.root[:, 0] += rng.uniform(0.06, 0.1) * shift
    curves.root[:, 1] -= 0.012 * np.abs(shift)
    curves.pelvis[:, 1] -= 0.14 * shift
    curves.spine[:, 1] += 0.12 * shift
    curves.feet[:, LEFT, 1] += 0.02 * np.clip(-shift, 0, 1)
    curves.feet[:, RIGHT, 1] += 0.02 * np.clip(shift, 0, 1)
    return curves


@program(
    "sway",
    group="posture",
    parts={"legs", "spine"},
    directions=("left", "right", "back and forth"),
    amplitudes=AMPLITUDES,
)
def sway(step: ActionStep, manner: Manner, rng: Generator, frames: int) -> Curves:
    """Rock the body from side to side (or forward and back), the feet where they are."""
    frames = duration(4.0, step, manner, rng, frames)
    curves = standing(frames, LEGS | {"spine"})
    size = rng.uniform(0.6, 1.2) * {"small": 0.6, "": 1.0, "large": 1.6}[step.amplitude]
    wave = np.sin(2 * np.pi * rng.uniform(0.3, 0.8) * np.arange(frames) / FPS) * hold(frames, 0.15, 0.15) * size
    if step.direction == "back and forth":
        curves.root[:, 2] += 0.05 * wave
        curves.pelvis[:, 0] += 0.1 * wave
        curves.spine[:, 0] += 0.15 * wave
        return curves
    wave *= -1.0 if step.direction == "right" else 1.0
    curves.feet[..., 0] *= 1.5
    curves.root[:, 0] += 0.07 * wave
    curves.pelvis[:, 1] -= 0.06 * wave
    curves.spine[:, 1] += 0.25 * wave
    curves.head[:, 1] += 0.08 * wave
    curves.hands[..., 0] += np.array([0.12, -0.12]) * wave[:, None] + 0.05
    return curves


@program("shiver", group="posture", styled=False)
def shiver(step: ActionStep, manner: Manner, rng: Generator, frames: int) -> Curves:
    """Tremble with cold, arms hugged around the body."""
    frames = duration(3.0, step, manner, rng, frames)
    hugged = pose(hands=(-0.42, -0.45, 0.42), spine=(0.3, 0, 0), head=(0.25, 0, 0), root=(0, 0.86, 0), shrug=0.25)
    if rng.random() < 0.4:
        hugged = pose(hands=(-0.25, -0.3, 0.38), spine=(0.25, 0, 0), head=(0.2, 0, 0), root=(0, 0.86, 0), shrug=0.3)
    curves = perform(frames, [(0.0, STANDING), (0.15, hugged), (0.88, hugged), (1.0, STANDING)])
    shake = np.sin(2 * np.pi * rng.uniform(6.0, 8.5) * np.arange(frames) / FPS) * hold(frames, 0.2, 0.15)
    curves.spine[:, 2] += 0.06 * shake
    curves.spine[:, 1] += 0.03 * np.roll(shake, 2)
    curves.hands[..., 1] += 0.025 * shake[:, None]
    curves.root[:, 0] += 0.006 * shake
    return curves


def _seat(step: ActionStep, rng: Generator) -> tuple[Array, bool]:
    """A seated row, and whether it is on the floor."""
    floor = step.height == "low" or (not step.height and rng.random() < 0.15)
    hands = (rng.uniform(-0.1, 0.1), rng.uniform(-0.75, -0.5), rng.uniform(0.35, 0.6))
    if floor:
        if rng.random() < 0.5:  # cross-legged
            row = pose(
                root=(0, 0.13, -0.25), pelvis=(-0.12, 0, 0), spine=(0.35, 0, 0), feet=(-0.06, 0.09, 0.12), knee=1.25,
                foot_pitch=-0.5, hands=(0.15, hands[1], hands[2]), foot_yaw=0.9,
            )  # fmt: skip
        else:
            row = pose(
                root=(0, 0.13, -0.4), pelvis=(-0.2, 0, 0), spine=(0.45, 0, 0), hands=(0.0, -0.4, 0.75),
                feet=(0.12, 0.09, rng.uniform(0.05, 0.35)), foot_pitch=0.2,
            )  # fmt: skip
        return row, True
    seat = rng.uniform(0.42, 0.54) * (1.25 if step.height == "high" else 1.0)
    row = pose(
        root=(0, seat, -0.42), pelvis=(-0.12, 0, 0), spine=(rng.uniform(0.05, 0.3), 0, 0), hands=hands,
        feet=(rng.uniform(0.08, 0.18), ANKLE, rng.uniform(-0.02, 0.12)),
    )  # fmt: skip
    return row, False


def _lowering(row: Array, floor: bool, rng: Generator) -> Array:
    """Halfway between standing and the seat: hips back, trunk forward."""
    if floor:
        hand = {"right_reach": (-0.3, 0.05, -0.45)} if rng.random() < 0.7 else {}
        return pose(root=(0, 0.4, -0.25), pelvis=(0.3, 0, 0), spine=(0.5, 0, 0), hands=(0.1, -0.6, 0.5), **hand)
    return pose(
        root=(0, 0.68, -0.28), pelvis=(0.42, 0, 0), spine=(0.4, 0, 0), hands=(0.1, -0.85, 0.3), head=(-0.3, 0, 0)
    )


@program("sit down", group="posture", heights=("low", "middle", "high"), ends="sit", weight=2.5)
def sit_down(step: ActionStep, manner: Manner, rng: Generator, frames: int) -> Curves:
    """Sit down on a chair (height low: on the floor; high: on a stool) and stay."""
    row, floor = _seat(step, rng)
    frames = duration(3.2 if floor else 2.3, step, manner, rng, frames)
    down = rng.uniform(0.55, 0.85)
    return perform(frames, [(0.05, STANDING), (0.5 * down, _lowering(row, floor, rng)), (down, row), (1.0, row)])


@program("stand up", group="posture", heights=("low", "middle", "high"), starts="sit", weight=2)
def stand_up(step: ActionStep, manner: Manner, rng: Generator, frames: int) -> Curves:
    """Rise from a chair (height low: from the floor) to standing."""
    row, floor = _seat(step, rng)
    frames = duration(3.0 if floor else 2.1, step, manner, rng, frames)
    up = rng.uniform(0.65, 0.95)
    return perform(
        frames, [(rng.uniform(0.0, 0.2), row), (0.5 * up, _lowering(row, floor, rng)), (up, STANDING), (1.0, STANDING)]
    )


@program("sit", group="posture", heights=("low", "middle"), starts="sit", ends="sit", weight=1.5)
def sit(step: ActionStep, manner: Manner, rng: Generator, frames: int) -> Curves:
    """Sit still, with small changes of posture."""
    frames = duration(3.5, step, manner, rng, frames)
    row, _ = _seat(step, rng)
    curves = perform(frames, [(0.0, row), (1.0, row)])
    curves.spine[:, 0] += 0.06 * irregular_wave(frames, rng, (0.1, 0.3))
    curves.spine[:, 1] += 0.03 * irregular_wave(frames, rng, (0.1, 0.3))
    curves.head[:, 2] += 0.25 * rng.random() * irregular_wave(frames, rng, (0.1, 0.3))
    curves.hands[..., 1] += 0.03 * irregular_wave(frames, rng, (0.1, 0.4))[:, None]
    return curves


@program("squat", group="posture", counts=(1, 6), amplitudes=AMPLITUDES, weight=1.5)
def squat(step: ActionStep, manner: Manner, rng: Generator, frames: int) -> Curves:
    """Bend the knees deeply and come up, trunk nearly upright."""
    depth = rng.uniform(*{"small": (0.6, 0.72), "": (0.32, 0.6), "large": (0.25, 0.38)}[step.amplitude])
    wide = rng.uniform(1.0, 2.2) * HIP
    hands = [(-0.1, 0.0, 0.9), (-0.25, -0.3, 0.5), (0.15, -0.85, 0.3), (-0.3, -0.35, 0.42)][int(rng.integers(4))]
    low = pose(
        root=(0, depth, -0.22 * (1 - depth)), pelvis=(0.35, 0, 0), spine=(rng.uniform(0.1, 0.4), 0, 0),
        head=(-0.4, 0, 0), hands=hands, feet=(wide, ANKLE, 0), knee=0.25, foot_yaw=0.35, foot_pitch=0.0,
    )  # fmt: skip
    curves = down_and_up(step, manner, rng, frames, low, seconds=1.7)
    curves.feet[..., 0] = np.array([wide, -wide])
    return curves


@program("crouch", group="posture", directions=("down",), weight=1.5)
def crouch(step: ActionStep, manner: Manner, rng: Generator, frames: int) -> Curves:
    """Get down low, trunk bent over the thighs, arms in front."""
    low = pose(
        root=(0, rng.uniform(0.3, 0.5), -0.12), pelvis=(0.5, 0, 0), spine=(rng.uniform(0.5, 0.9), 0, 0),
        head=(-0.5, 0, 0), hands=(rng.uniform(-0.3, 0.1), -0.65, 0.5), left_feet=(HIP, ANKLE, 0.1),
        right_feet=(-HIP, ANKLE + 0.06, -0.1), right_foot_pitch=-0.6,
    )  # fmt: skip
    return down_and_up(step, manner, rng, frames, low, seconds=2.4, stay=0.5)


@program("duck", group="posture", directions=("down",), weight=1)
def duck(step: ActionStep, manner: Manner, rng: Generator, frames: int) -> Curves:
    """Bend quickly at knees and trunk to let something pass overhead, often with a step or a turn."""
    covered = rng.random() < 0.3
    aside, turn = rng.normal(0.0, 0.2), rng.normal(0.0, 0.25)
    hands = [(0.0, -0.5, 0.5), (-0.15, -0.1, 0.35), (0.2, -0.75, 0.3), (0.35, -0.5, 0.2)][int(rng.integers(4))]
    low = pose(
        root=(0.4 * aside, rng.uniform(0.45, 0.7), rng.uniform(-0.15, 0.1)), pelvis=(rng.uniform(0.2, 0.5), 0, turn),
        spine=(rng.uniform(0.3, 0.9), aside, turn), head=(rng.uniform(-0.2, 0.4), 0, 0),
        hands=(-0.1, 0.4, 0.15) if covered else hands, elbow=0.4 * covered,
    )  # fmt: skip
    curves = down_and_up(step, manner, rng, frames, low, seconds=rng.uniform(0.9, 1.5), stay=0.1)
    if rng.random() < 0.5:
        step_about(curves, rng, rng.uniform(0.2, 1.2))
    return curves


@program("kneel", group="posture", sides=("left", "right", "both"), heights=("low",), weight=1.5)
def kneel(step: ActionStep, manner: Manner, rng: Generator, frames: int) -> Curves:
    """Go down on one knee (the named side's) or on both; mostly up again."""
    side = step.side or str(rng.choice(["left", "right", "both"]))
    hands = [(0.13, -0.93, 0.1), (0.0, -0.6, 0.45), (-0.3, -0.35, 0.4)][int(rng.integers(3))]
    back = -0.45
    down, up = ("left", "right") if side != "right" else ("right", "left")
    sign = 1.0 if down == "left" else -1.0
    half: dict[str, ArrayLike] = {
        "root": (0, 0.47, back + 0.05), "spine": (0.1, 0, 0), "hands": hands,
        f"{down}_feet": (sign * HIP, 0.09, back - 0.4), f"{down}_foot_pitch": -1.1,
        f"{up}_feet": (-sign * HIP, ANKLE, 0.0),
    }  # fmt: skip
    low = pose(**half)
    if side != "both":
        return down_and_up(step, manner, rng, frames, low, seconds=3.0, stay=0.5)
    sitting = rng.random() < 0.3
    both = pose(
        root=(0, 0.25 if sitting else 0.47, back - (0.22 if sitting else 0.0)), spine=(0.1, 0, 0), hands=hands,
        feet=(HIP, 0.08, back - 0.4), foot_pitch=-1.5,
    )  # fmt: skip
    frames = duration(3.6, step, manner, rng, frames)
    if rng.random() < 0.5:
        return perform(frames, [(0.03, STANDING), (0.35, low), (0.6, both), (1.0, both)])
    return perform(frames, [(0.03, STANDING), (0.25, low), (0.42, both), (0.6, both), (0.76, low), (0.98, STANDING)])
