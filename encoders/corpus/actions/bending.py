"""Bends of the trunk and shifts of the body: bend, lean, twist, lunge, dodge, balance."""

from __future__ import annotations

import numpy as np
from numpy.random import Generator
from numpy.typing import ArrayLike

from encoders.corpus.engine.curves import (
    ANKLE,
    HIP,
    LEFT,
    SIDE_INDEX,
    STAND,
    TORSO,
    Array,
    Curves,
    hold,
    standing,
)
from encoders.corpus.engine.program import AMPLITUDES, program
from encoders.corpus.engine.stance import step_about
from encoders.corpus.engine.style import Manner
from encoders.corpus.engine.timing import duration
from encoders.corpus.engine.whole_body_poses import STANDING, down_and_up, irregular_wave, perform, pose, repeated
from encoders.corpus.scene import ActionStep


@program("bend forward", group="posture", amplitudes=AMPLITUDES, counts=(1, 4), weight=1.5)
def bend_forward(step: ActionStep, manner: Manner, rng: Generator, frames: int) -> Curves:
    """Bend far down, hands to the toes, shins or knees, and come up."""
    depth = rng.uniform(*{"small": (0.7, 1.0), "": (1.0, 1.9), "large": (1.8, 2.2)}[step.amplitude])
    knees = rng.uniform(0.0, 0.12)
    low = pose(
        root=(0, STAND - 0.05 - knees, -0.2), pelvis=(0.5 * depth, 0, 0), spine=(0.5 * depth, 0, 0),
        head=(rng.uniform(-0.3, 0.3), 0, 0), hands=(rng.uniform(-0.15, 0.1), -0.9, 0.15 * rng.random()), hang=1.0,
    )  # fmt: skip
    return down_and_up(step, manner, rng, frames, low, seconds=2.3)


@program(
    "lean", group="posture", parts={"spine", "head"}, directions=("left", "right", "forward", "backward"),
    amplitudes=AMPLITUDES, counts=(1, 4), weight=1.5,
)  # fmt: skip
def lean(step: ActionStep, manner: Manner, rng: Generator, frames: int) -> Curves:
    """Lean the upper body to a side, forward or back."""
    count = step.count or 1
    frames = duration(2.2 * count, step, manner, rng, frames)
    curves = standing(frames, TORSO)
    direction = step.direction or str(rng.choice(["left", "right", "forward", "backward"]))
    size = rng.uniform(0.35, 0.7) * {"small": 0.6, "": 1.0, "large": 1.5}[step.amplitude]
    bent = size * repeated(frames, count, rng)
    sideways = {"left": 1.0, "right": -1.0}.get(direction, 0.0)
    along = {"forward": 1.0, "backward": -0.85}.get(direction, 0.0)
    curves.spine[:, 1] += 0.85 * sideways * bent
    curves.pelvis[:, 1] += 0.15 * sideways * bent
    curves.root[:, 0] -= 0.06 * sideways * bent
    curves.head[:, 1] += 0.1 * sideways * bent
    curves.spine[:, 0] += 0.7 * along * bent
    curves.pelvis[:, 0] += 0.3 * along * bent
    curves.root[:, 2] -= 0.05 * along * bent
    curves.head[:, 0] += 0.35 * min(along, 0.0) * bent
    curves.feet[..., 0] *= rng.uniform(1.0, 1.8)
    return curves


@program("twist torso", group="exercise", parts=TORSO, directions=("left", "right"), counts=(1, 8), weight=1)
def twist_torso(step: ActionStep, manner: Manner, rng: Generator, frames: int) -> Curves:
    """Turn the upper body to a side, or to both in turn."""
    count = step.count or (1 if step.direction else int(rng.integers(2, 6)))
    frames = duration(1.6 * count, step, manner, rng, frames)
    curves = standing(frames, TORSO)
    size = rng.uniform(0.6, 1.5)
    if step.direction:
        turned = size * repeated(frames, count, rng) * (1.0 if step.direction == "left" else -1.0)
    else:
        turned = size * np.sin(np.pi * np.linspace(0, 2 * count, frames) * 0.5) * hold(frames, 0.1, 0.1)
    curves.spine[:, 2] += 0.75 * turned
    curves.pelvis[:, 2] += 0.25 * turned
    curves.head[:, 2] += 0.3 * turned
    curves.feet[..., 0] *= 1.6
    arms = [HANG, (0.9, 0.0, 0.1), (0.35, -0.65, 0.1), (-0.2, 0.0, 0.45)][int(rng.integers(4))]
    curves.spine[:, 1] += rng.normal(0.0, 0.15) * turned
    curves.hands[:] += (np.array(arms) - curves.hands) * hold(frames, 0.12, 0.12)[:, None, None]
    return curves


HANG = (0.2, -0.9, 0.15)


@program(
    "lunge",
    group="exercise",
    sides=("left", "right"),
    directions=("forward", "left", "right", "backward"),
    counts=(1, 5),
)
def lunge(step: ActionStep, manner: Manner, rng: Generator, frames: int) -> Curves:
    """A long step with one leg, its knee bent deeply, and back."""
    toward = step.direction or "forward"
    leg = SIDE_INDEX.get(step.side, SIDE_INDEX.get(toward, int(rng.integers(2))))
    sign = 1.0 if leg == LEFT else -1.0
    own, other = ("left", "right") if leg == LEFT else ("right", "left")
    names = {
        "foot": f"{own}_feet",
        "pitch": f"{own}_foot_pitch",
        "other": f"{other}_feet",
        "other_pitch": f"{other}_foot_pitch",
    }

    def lunging(**channels: ArrayLike) -> Array:
        return pose(**{names.get(name, name): value for name, value in channels.items()})

    far, depth, trunk = rng.uniform(0.65, 0.9), rng.uniform(0.48, 0.65), (rng.uniform(0.0, 0.3), 0, 0)
    hands = [(0.35, -0.65, 0.1), (0.13, -0.93, 0.1), (-0.3, -0.3, 0.4), (0.0, -0.6, 0.5)][int(rng.integers(4))]
    if toward in ("left", "right") and SIDE_INDEX[toward] != leg:  # the leg crosses before the other
        low = lunging(
            root=(-sign * 0.12, depth, 0.1), pelvis=(0.2, 0, -sign * 0.2), spine=(0.2, 0, 0), hands=hands,
            foot=(-sign * 0.4, ANKLE, 0.3), other=(-sign * HIP, ANKLE + 0.13, 0.05), other_pitch=-0.9,
        )  # fmt: skip
        middle = lunging(root=(-sign * 0.06, 0.82, 0.05), foot=(-sign * 0.12, ANKLE + 0.15, 0.28))
    elif toward in ("left", "right"):
        low = lunging(
            root=(sign * far * 0.62, depth, -0.1), pelvis=(0.25, 0, 0), spine=(0.25, 0, 0), hands=hands,
            foot=(sign * (far + 0.1), ANKLE, 0.0),
        )  # fmt: skip
        middle = lunging(root=(sign * far * 0.3, 0.78, -0.05), foot=(sign * far * 0.5, ANKLE + 0.12, 0.0))
    elif toward == "backward":
        low = lunging(
            root=(0, depth, -far * 0.5), spine=trunk, hands=hands, foot=(sign * HIP, ANKLE + 0.13, -far), pitch=-0.9
        )
        middle = lunging(root=(0, 0.82, -far * 0.25), foot=(sign * HIP, ANKLE + 0.15, -far * 0.5))
    else:
        low = lunging(
            root=(0, depth, far * 0.5), spine=trunk, hands=hands, foot=(sign * HIP, ANKLE, far),
            other=(-sign * HIP, ANKLE + 0.13, 0.1), other_pitch=-0.9,
        )  # fmt: skip
        middle = lunging(root=(0, 0.82, far * 0.25), foot=(sign * HIP, ANKLE + 0.15, far * 0.5))
    count = step.count or 1
    frames = duration(2.2 * count, step, manner, rng, frames)
    keys = [(0.02, STANDING)]
    for i in range(count):
        shares = np.array([0.2, 0.42, 0.58, 0.78, 0.98])
        rows = (middle, low, low, middle, STANDING)
        keys += [((i + share) / count, row) for share, row in zip(shares, rows, strict=True)]
    return perform(frames, keys)


@program("dodge", group="posture", directions=("left", "right", "backward"), counts=(1, 3), weight=1)
def dodge(step: ActionStep, manner: Manner, rng: Generator, frames: int) -> Curves:
    """Get the body out of the way quickly, by a step, a lean or a turn; the hands are anywhere, often on guard."""
    toward = step.direction or str(rng.choice(["left", "right", "backward"]))
    sign = {"left": 1.0, "right": -1.0}.get(toward, 0.0)
    back = -1.0 if not sign else 0.0
    hands = [(-0.15, rng.uniform(-0.6, 0.1), 0.4), (0.13, -0.93, 0.1), (0.3, -0.5, 0.3)][int(rng.integers(3))]
    far, deep, turn = rng.uniform(0.0, 0.45), rng.uniform(0.62, 0.86), rng.normal(0.0, 0.35)
    moved = pose(
        root=(sign * (0.12 + 0.7 * far), deep, back * (0.1 + 0.7 * far)), pelvis=(0.15 + 0.1 * back, sign * 0.15, turn),
        spine=(rng.uniform(0.0, 0.4) + 0.45 * back, sign * rng.uniform(0.15, 0.7), turn), hands=hands,
        head=(0, 0, -turn),
        left_feet=(HIP + far * max(sign, 0), ANKLE, far * back), right_feet=(-HIP + far * min(sign, 0), ANKLE, 0.0),
    )  # fmt: skip
    curves = down_and_up(step, manner, rng, frames, moved, seconds=rng.uniform(0.9, 1.4), stay=0.15)
    if rng.random() < 0.6:
        step_about(curves, rng, rng.uniform(0.2, 1.2))
    return curves


@program("balance on one leg", group="posture", sides=("left", "right"), weight=1.5)
def balance_on_one_leg(step: ActionStep, manner: Manner, rng: Generator, frames: int) -> Curves:
    """Stand on the named leg, the other raised, arms out to keep the balance."""
    frames = duration(4.0, step, manner, rng, frames)
    on = step.side or str(rng.choice(["left", "right"]))
    sign, free = (1.0, "right") if on == "left" else (-1.0, "left")
    arms = [(0.92, -0.05, 0.1), (0.6, -0.6, 0.2), (0.35, -0.65, 0.1), (0.95, 0.2, 0.0)][int(rng.integers(4))]
    kind = rng.integers(3)
    place = [(-sign * 0.08, 0.42, 0.12), (-sign * 0.1, 0.4, -0.4), (-sign * 0.04, 0.5, 0.05)][kind]
    low = pose(**{
        "root": (sign * 0.07, 0.89, 0.0), "pelvis": (0.05, sign * 0.06, 0), "hands": arms, f"{free}_feet": place,
        f"{free}_foot_pitch": -0.6, f"{free}_knee": -sign * 0.9 * (kind == 2), "spine": (0.1 * (kind == 1), 0, 0),
    })  # fmt: skip
    shift = pose(root=(sign * 0.08, 0.89, 0.0))
    curves = perform(frames, [(0.02, STANDING), (0.12, shift), (0.28, low), (0.8, low), (0.92, shift), (1.0, STANDING)])
    wobble = irregular_wave(frames, rng, (0.4, 1.0)) * hold(frames, 0.3, 0.2) * rng.uniform(0.02, 0.09)
    curves.spine[:, 1] += wobble
    curves.hands[..., 1] += np.array([1.5, -1.5]) * wobble[:, None]
    return curves
