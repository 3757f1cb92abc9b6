"""Keeping and changing posture on one's feet or seat: stand, sit, squat, crouch, kneel, bow, lean, lunge, dodge."""

from __future__ import annotations

import numpy as np
from numpy.random import Generator
from numpy.typing import ArrayLike

from encoders.corpus.curves import ANKLE, HIP, LEFT, LEGS, RIGHT, SIDES, STAND, Array, Curves, ease, hold, standing
from encoders.corpus.poses import STANDING, perform, pose
from encoders.corpus.programs import AMPLITUDES, program
from encoders.corpus.scene import Step
from encoders.corpus.style import Manner
from encoders.corpus.timing import duration
from encoders.motion import FPS

TORSO = frozenset({"spine", "head"})
BODY_BUT_HEAD = frozenset({"legs", "spine"})


def _waver(frames: int, rng: Generator, hertz: tuple[float, float]) -> Array:
    """A slow irregular wave (F,) of about unit size."""
    time = np.arange(frames) / FPS
    waves = [np.sin(2 * np.pi * (rng.uniform(*hertz) * time + rng.random())) for _ in range(2)]
    return np.asarray(sum(waves)) / 1.4


def _repeat(frames: int, count: int, rng: Generator, *, down: float = 0.35, up: float = 0.35) -> Array:
    """0 to 1 and back `count` times, (F,)."""
    local = (np.arange(frames) * count / frames) % 1.0
    return ease(local / (down * rng.uniform(0.8, 1.2))) * ease((1 - local) / (up * rng.uniform(0.8, 1.2)))


@program("stand", group="posture", parts=LEGS, weight=2)
def stand(step: Step, manner: Manner, rng: Generator, frames: int) -> Curves:
    """Stand still, breathing and wavering a little."""
    frames = duration(3.5, step, manner, rng, frames)
    curves = standing(frames, LEGS)
    calm = rng.uniform(0.2, 1.0)
    curves.root[:, 0] += 0.012 * calm * _waver(frames, rng, (0.1, 0.35))
    curves.root[:, 2] += 0.01 * calm * _waver(frames, rng, (0.1, 0.35))
    curves.spine[:, 0] += 0.02 * _waver(frames, rng, (0.2, 0.35))
    curves.head[:, 2] += 0.12 * calm * _waver(frames, rng, (0.1, 0.3))
    curves.feet[..., 0] *= rng.uniform(0.7, 1.8)
    curves.feet[:, :, 2] += rng.normal(0.0, 0.03, 2)
    return curves


@program("shift weight", group="posture", parts=LEGS, sides=("left", "right"))
def shift_weight(step: Step, manner: Manner, rng: Generator, frames: int) -> Curves:
    """Put the weight on one leg, then on the other; named: on that one only."""
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
def sway(step: Step, manner: Manner, rng: Generator, frames: int) -> Curves:
    """Rock the body from side to side (or forward and back), the feet where they are."""
    frames = duration(4.0, step, manner, rng, frames)
    curves = standing(frames, BODY_BUT_HEAD)
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
def shiver(step: Step, manner: Manner, rng: Generator, frames: int) -> Curves:
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


def _seat(step: Step, rng: Generator) -> tuple[Array, bool]:
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
                root=(0, 0.13, -0.4), pelvis=(-0.2, 0, 0), spine=(0.45, 0, 0), feet=(0.12, 0.09, rng.uniform(0.05, 0.35)),
                hands=(0.0, -0.4, 0.75), foot_pitch=0.2,
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
def sit_down(step: Step, manner: Manner, rng: Generator, frames: int) -> Curves:
    """Sit down on a chair (height low: on the floor; high: on a stool) and stay."""
    row, floor = _seat(step, rng)
    frames = duration(3.2 if floor else 2.3, step, manner, rng, frames)
    down = rng.uniform(0.55, 0.85)
    return perform(frames, [(0.05, STANDING), (0.5 * down, _lowering(row, floor, rng)), (down, row), (1.0, row)])


@program("stand up", group="posture", heights=("low", "middle", "high"), starts="sit", weight=2)
def stand_up(step: Step, manner: Manner, rng: Generator, frames: int) -> Curves:
    """Rise from a chair (height low: from the floor) to standing."""
    row, floor = _seat(step, rng)
    frames = duration(3.0 if floor else 2.1, step, manner, rng, frames)
    up = rng.uniform(0.65, 0.95)
    return perform(
        frames, [(rng.uniform(0.0, 0.2), row), (0.5 * up, _lowering(row, floor, rng)), (up, STANDING), (1.0, STANDING)]
    )


@program("sit", group="posture", heights=("low", "middle"), starts="sit", ends="sit", weight=1.5)
def sit(step: Step, manner: Manner, rng: Generator, frames: int) -> Curves:
    """Sit still, with small changes of posture."""
    frames = duration(3.5, step, manner, rng, frames)
    row, _ = _seat(step, rng)
    curves = perform(frames, [(0.0, row), (1.0, row)])
    curves.spine[:, 0] += 0.06 * _waver(frames, rng, (0.1, 0.3))
    curves.spine[:, 1] += 0.03 * _waver(frames, rng, (0.1, 0.3))
    curves.head[:, 2] += 0.25 * rng.random() * _waver(frames, rng, (0.1, 0.3))
    curves.hands[..., 1] += 0.03 * _waver(frames, rng, (0.1, 0.4))[:, None]
    return curves


def _down_and_up(
    step: Step, manner: Manner, rng: Generator, frames: int, low: Array, *, seconds: float, stay: float = 0.2
) -> Curves:
    """Into a pose and out of it, `step.count` times; named once, it is sometimes kept."""
    count = step.count or 1
    frames = duration(seconds * count, step, manner, rng, frames)
    if count == 1 and rng.random() < stay:
        return perform(frames, [(0.05, STANDING), (rng.uniform(0.4, 0.7), low), (1.0, low)])
    keys = [(0.02, STANDING)]
    for i in range(count):
        half = rng.uniform(0.05, 0.3) / 2
        keys += [((i + 0.5 - half) / count, low), ((i + 0.5 + half) / count, low), ((i + 0.98) / count, STANDING)]
    return perform(frames, keys)


@program("squat", group="posture", counts=(1, 6), amplitudes=AMPLITUDES, weight=1.5)
def squat(step: Step, manner: Manner, rng: Generator, frames: int) -> Curves:
    """Bend the knees deeply and come up, trunk nearly upright."""
    depth = rng.uniform(*{"small": (0.6, 0.72), "": (0.32, 0.6), "large": (0.25, 0.38)}[step.amplitude])
    wide = rng.uniform(1.0, 2.2) * HIP
    hands = [(-0.1, 0.0, 0.9), (-0.25, -0.3, 0.5), (0.15, -0.85, 0.3), (-0.3, -0.35, 0.42)][int(rng.integers(4))]
    low = pose(
        root=(0, depth, -0.22 * (1 - depth)), pelvis=(0.35, 0, 0), spine=(rng.uniform(0.1, 0.4), 0, 0),
        head=(-0.4, 0, 0), hands=hands, feet=(wide, ANKLE, 0), knee=0.25, foot_yaw=0.35, foot_pitch=0.0,
    )  # fmt: skip
    curves = _down_and_up(step, manner, rng, frames, low, seconds=1.7)
    curves.feet[..., 0] = np.array([wide, -wide])
    return curves


@program("crouch", group="posture", directions=("down",), weight=1.5)
def crouch(step: Step, manner: Manner, rng: Generator, frames: int) -> Curves:
    """Get down low, trunk bent over the thighs, arms in front."""
    low = pose(
        root=(0, rng.uniform(0.3, 0.5), -0.12), pelvis=(0.5, 0, 0), spine=(rng.uniform(0.5, 0.9), 0, 0),
        head=(-0.5, 0, 0), hands=(rng.uniform(-0.3, 0.1), -0.65, 0.5), left_feet=(HIP, ANKLE, 0.1),
        right_feet=(-HIP, ANKLE + 0.06, -0.1), right_foot_pitch=-0.6,
    )  # fmt: skip
    return _down_and_up(step, manner, rng, frames, low, seconds=2.4, stay=0.5)


@program("duck", group="posture", directions=("down",), weight=1)
def duck(step: Step, manner: Manner, rng: Generator, frames: int) -> Curves:
    """Bend quickly at knees and trunk to let something pass overhead."""
    covered = rng.random() < 0.3
    low = pose(
        root=(0, rng.uniform(0.5, 0.68), -0.1), pelvis=(0.4, 0, 0), spine=(rng.uniform(0.5, 0.8), 0, 0),
        head=(0.35, 0, 0), hands=(-0.1, 0.4, 0.15) if covered else (0.0, -0.5, 0.5), elbow=0.4 * covered,
    )  # fmt: skip
    return _down_and_up(step, manner, rng, frames, low, seconds=1.3, stay=0.0)


@program("kneel", group="posture", sides=("left", "right", "both"), heights=("low",), weight=1.5)
def kneel(step: Step, manner: Manner, rng: Generator, frames: int) -> Curves:
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
        return _down_and_up(step, manner, rng, frames, low, seconds=3.0, stay=0.5)
    sitting = rng.random() < 0.3
    both = pose(
        root=(0, 0.25 if sitting else 0.47, back - (0.22 if sitting else 0.0)), spine=(0.1, 0, 0), hands=hands,
        feet=(HIP, 0.08, back - 0.4), foot_pitch=-1.5,
    )  # fmt: skip
    frames = duration(3.6, step, manner, rng, frames)
    if rng.random() < 0.5:
        return perform(frames, [(0.03, STANDING), (0.35, low), (0.6, both), (1.0, both)])
    return perform(frames, [(0.03, STANDING), (0.25, low), (0.42, both), (0.6, both), (0.76, low), (0.98, STANDING)])


@program("bow", group="posture", parts=TORSO, amplitudes=AMPLITUDES, counts=(1, 3), weight=2.5)
def bow(step: Step, manner: Manner, rng: Generator, frames: int) -> Curves:
    """Bend at the waist and come up again; arms at the sides, on the thighs, before the belly or one across it."""
    count = step.count or 1
    frames = duration(2.4 * count, step, manner, rng, frames)
    curves = standing(frames, TORSO)
    depth = rng.uniform(*{"small": (0.35, 0.6), "": (0.5, 1.2), "large": (1.1, 1.6)}[step.amplitude])
    down = depth * _repeat(frames, count, rng, down=rng.uniform(0.2, 0.42), up=rng.uniform(0.2, 0.42))
    share = rng.uniform(0.35, 0.75)
    curves.pelvis[:, 0] += share * down
    curves.root[:, 2] -= 0.2 * share * down
    curves.root[:, 1] -= 0.03 * share * down
    curves.spine[:, 0] += (1 - share) * down
    curves.head[:, 0] += rng.uniform(-0.1, 0.5) * down
    curves.feet[..., 0] *= rng.uniform(0.4, 1.2)
    near = (down / depth)[:, None]
    manners = rng.random()
    if manners < 0.4:  # hands stay at the thighs
        curves.hang[:] = 0.8 - 0.75 * near
    elif manners < 0.6:  # hands slide down before the thighs
        curves.hands[..., 0] += (-0.3 - 0.13) * near
        curves.hands[..., 2] += 0.15 * near
    elif manners < 0.75:  # one arm across the belly, perhaps the other behind the back
        arm = int(rng.integers(2))
        curves.hands[:, arm] += (np.array([-0.42, -0.42, 0.4]) - curves.hands[:, arm]) * near
        curves.hang[:, arm] *= 1 - near[:, 0]
        if rng.random() < 0.5:
            curves.hands[:, 1 - arm] += (np.array([0.5, -0.55, -0.25]) - curves.hands[:, 1 - arm]) * near
    return curves


@program("bend forward", group="posture", amplitudes=AMPLITUDES, counts=(1, 4), weight=1.5)
def bend_forward(step: Step, manner: Manner, rng: Generator, frames: int) -> Curves:
    """Bend far down, hands to the toes, shins or knees, and come up."""
    depth = rng.uniform(*{"small": (0.7, 1.0), "": (1.0, 1.9), "large": (1.8, 2.2)}[step.amplitude])
    knees = rng.uniform(0.0, 0.12)
    low = pose(
        root=(0, STAND - 0.05 - knees, -0.2), pelvis=(0.5 * depth, 0, 0), spine=(0.5 * depth, 0, 0),
        head=(rng.uniform(-0.3, 0.3), 0, 0), hands=(rng.uniform(-0.15, 0.1), -0.9, 0.15 * rng.random()), hang=1.0,
    )  # fmt: skip
    return _down_and_up(step, manner, rng, frames, low, seconds=2.3)


@program(
    "lean", group="posture", parts={"spine", "head"}, directions=("left", "right", "forward", "backward"),
    amplitudes=AMPLITUDES, counts=(1, 4), weight=1.5,
)  # fmt: skip
def lean(step: Step, manner: Manner, rng: Generator, frames: int) -> Curves:
    """Lean the upper body to a side, forward or back."""
    count = step.count or 1
    frames = duration(2.2 * count, step, manner, rng, frames)
    curves = standing(frames, TORSO)
    direction = step.direction or str(rng.choice(["left", "right", "forward", "backward"]))
    size = rng.uniform(0.35, 0.7) * {"small": 0.6, "": 1.0, "large": 1.5}[step.amplitude]
    bent = size * _repeat(frames, count, rng)
    sideways = {"left": 1.0, "right": -1.0}.get(direction, 0.0)
    along = {"forward": 1.0, "backward": -0.6}.get(direction, 0.0)
    curves.spine[:, 1] += 0.85 * sideways * bent
    curves.pelvis[:, 1] += 0.15 * sideways * bent
    curves.root[:, 0] -= 0.06 * sideways * bent
    curves.head[:, 1] += 0.1 * sideways * bent
    curves.spine[:, 0] += 0.7 * along * bent
    curves.pelvis[:, 0] += 0.3 * along * bent
    curves.root[:, 2] -= 0.05 * along * bent
    curves.feet[..., 0] *= rng.uniform(1.0, 1.8)
    return curves


@program("twist torso", group="exercise", parts=TORSO, directions=("left", "right"), counts=(1, 8), weight=1)
def twist_torso(step: Step, manner: Manner, rng: Generator, frames: int) -> Curves:
    """Turn the upper body to a side, or to both in turn."""
    count = step.count or (1 if step.direction else int(rng.integers(2, 6)))
    frames = duration(1.6 * count, step, manner, rng, frames)
    curves = standing(frames, TORSO)
    size = rng.uniform(0.6, 1.1)
    if step.direction:
        turned = size * _repeat(frames, count, rng) * (1.0 if step.direction == "left" else -1.0)
    else:
        turned = size * np.sin(np.pi * np.linspace(0, 2 * count, frames) * 0.5) * hold(frames, 0.1, 0.1)
    curves.spine[:, 2] += 0.75 * turned
    curves.pelvis[:, 2] += 0.25 * turned
    curves.head[:, 2] += 0.3 * turned
    curves.feet[..., 0] *= 1.6
    arms = [HANG, (0.9, 0.0, 0.1), (0.35, -0.65, 0.1), (-0.2, 0.0, 0.45)][int(rng.integers(4))]
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
def lunge(step: Step, manner: Manner, rng: Generator, frames: int) -> Curves:
    """A long step with one leg, its knee bent deeply, and back."""
    toward = step.direction or "forward"
    leg = {"left": LEFT, "right": RIGHT}.get(toward, SIDES.get(step.side, int(rng.integers(2))))
    sign = 1.0 if leg == LEFT else -1.0
    name, other = ("left", "right") if leg == LEFT else ("right", "left")
    far = rng.uniform(0.65, 0.9)
    hands = [(0.35, -0.65, 0.1), (0.13, -0.93, 0.1), (-0.3, -0.3, 0.4), (0.0, -0.6, 0.5)][int(rng.integers(4))]
    if toward in ("left", "right"):
        low = pose(**{
            "root": (sign * far * 0.62, rng.uniform(0.5, 0.65), -0.1), "pelvis": (0.25, 0, 0), "spine": (0.25, 0, 0),
            "hands": hands, f"{name}_feet": (sign * (far + 0.1), ANKLE, 0.0),
        })  # fmt: skip
        passing: dict[str, ArrayLike] = {
            "root": (sign * far * 0.3, 0.78, -0.05),
            f"{name}_feet": (sign * far * 0.5, ANKLE + 0.12, 0.0),
        }
    else:
        way = -1.0 if toward == "backward" else 1.0
        low = pose(**{
            "root": (0, rng.uniform(0.48, 0.65), way * far * 0.5), "spine": (rng.uniform(0.0, 0.3), 0, 0), "hands": hands,
            f"{name if way > 0 else other}_feet": ((sign if way > 0 else -sign) * HIP, ANKLE, far if way > 0 else 0.0),
            f"{other if way > 0 else name}_feet": ((-sign if way > 0 else sign) * HIP, ANKLE + 0.13, 0.1 if way > 0 else -far),
            f"{other if way > 0 else name}_foot_pitch": -0.9,
        })  # fmt: skip
        passing = {"root": (0, 0.82, way * far * 0.25), f"{name}_feet": (sign * HIP, ANKLE + 0.15, way * far * 0.5)}
    middle = pose(**passing)
    count = step.count or 1
    frames = duration(2.2 * count, step, manner, rng, frames)
    keys = [(0.02, STANDING)]
    for i in range(count):
        shares = np.array([0.2, 0.42, 0.58, 0.78, 0.98])
        rows = (middle, low, low, middle, STANDING)
        keys += [((i + share) / count, row) for share, row in zip(shares, rows, strict=True)]
    return perform(frames, keys)


@program("dodge", group="posture", directions=("left", "right", "backward"), counts=(1, 3), weight=1)
def dodge(step: Step, manner: Manner, rng: Generator, frames: int) -> Curves:
    """Get the body out of the way quickly, hands up."""
    toward = step.direction or str(rng.choice(["left", "right", "backward"]))
    sign = {"left": 1.0, "right": -1.0}.get(toward, 0.0)
    back = -1.0 if not sign else 0.0
    hands = (-0.15, rng.uniform(-0.6, -0.1), 0.45)
    moved = pose(
        root=(sign * 0.18, rng.uniform(0.66, 0.8), back * 0.15), pelvis=(0.15 + 0.1 * back, sign * 0.15, 0),
        spine=(0.15 + 0.35 * back, sign * 0.45, 0), hands=hands, left_feet=(HIP + 0.22 * max(sign, 0), ANKLE, 0),
        right_feet=(-HIP + 0.22 * min(sign, 0), ANKLE, 0.0),
    )  # fmt: skip
    return _down_and_up(step, manner, rng, frames, moved, seconds=1.2, stay=0.0)


@program("balance on one leg", group="posture", sides=("left", "right"), weight=1.5)
def balance_on_one_leg(step: Step, manner: Manner, rng: Generator, frames: int) -> Curves:
    """Stand on the named leg, the other raised, arms out to keep the balance."""
    frames = duration(4.0, step, manner, rng, frames)
    on = step.side or str(rng.choice(["left", "right"]))
    sign, free = (1.0, "right") if on == "left" else (-1.0, "left")
    arms = [(0.92, -0.05, 0.1), (0.6, -0.6, 0.2), (0.35, -0.65, 0.1), (0.95, 0.2, 0.0)][int(rng.integers(4))]
    kind = rng.integers(3)
    place = [(-sign * 0.08, 0.42, 0.12), (-sign * 0.1, 0.4, -0.4), (-sign * 0.04, 0.5, 0.05)][kind]
    low = pose(**{
        "root": (sign * 0.07, 0.89, 0.0), "pelvis": (0.05, sign * 0.06, 0), "hands": arms, f"{free}_feet": place,
        f"{free}_foot_pitch": -0.6, f"{free}_knee": -sign * 0.9 * (kind == 2), "spine": (0.1 if kind == 1 else 0.0, 0, 0),
    })  # fmt: skip
    shift = pose(root=(sign * 0.08, 0.89, 0.0))
    curves = perform(frames, [(0.02, STANDING), (0.12, shift), (0.28, low), (0.8, low), (0.92, shift), (1.0, STANDING)])
    wobble = _waver(frames, rng, (0.4, 1.0)) * hold(frames, 0.3, 0.2) * rng.uniform(0.02, 0.09)
    curves.spine[:, 1] += wobble
    curves.hands[..., 1] += np.array([1.5, -1.5]) * wobble[:, None]
    return curves
