"""Trajectories of locomotion in every direction that a step can have, from rest or already moving."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.random import Generator

from encoders.corpus.engine.curves import Array, Curves, ease, hold
from encoders.corpus.engine.gait import PAD, Gait, Trajectory, gait_phase, step_along
from encoders.corpus.engine.style import Manner
from encoders.corpus.engine.timing import SPEED, tempo
from encoders.corpus.scene import ActionStep
from encoders.motion import FPS

TURN = {
    "": 0.0, "forward": 0.0, "backward": np.pi, "left": np.pi / 2, "right": -np.pi / 2,
    "forward-left": np.pi / 4, "forward-right": -np.pi / 4,
    "backward-left": 3 * np.pi / 4, "backward-right": -3 * np.pi / 4,
}  # fmt: skip
STRAIGHT = ("forward", "backward", "left", "right", "forward-left", "forward-right", "backward-left", "backward-right")
AHEAD = ("forward", "left", "right", "forward-left", "forward-right")
CURVED = ("clockwise", "counterclockwise", "around", "zigzag", "back and forth")


#: Share of clips in which locomotion starts before and ends after the clip.
_MOVING_THROUGHOUT = 0.25


def seconds(frames: int) -> Array:
    """Time of every frame of a trajectory, (N,), 0 at the start of the clip."""
    return (np.arange(frames + 2 * PAD) - PAD) / FPS


def effort(frames: int, rng: Generator, *, rest: float = 0.6, rise: float = 0.6) -> Array:
    """Relative speed over time, 0 to 1, (N,): from rest or moving, to rest or moving.

    `rest` is the probability of rest at either end, `rise` the seconds of acceleration.
    """
    now, total = seconds(frames), frames / FPS
    rise = min(rise * rng.uniform(0.6, 1.5), 0.35 * total)
    going = np.ones(len(now))
    if rng.random() < _MOVING_THROUGHOUT:
        return going
    if rng.random() < rest:
        going *= ease((now - rng.uniform(0.0, 0.2)) / (rise * rng.uniform(0.8, 1.3)))
    if rng.random() < rest:
        going *= ease((total - rng.uniform(0.0, 0.2) - now) / (rise * rng.uniform(0.8, 1.3)))
    return going


def _gaining(frames: int, rng: Generator) -> Array:
    """Relative speed over time of a sprint in a hall, 0 to 1, (N,): it increases throughout, from rest or not."""
    now, total = seconds(frames), frames / FPS
    first = 0.0 if rng.random() < 0.35 else rng.uniform(0.4, 0.85)
    going = 1 - (1 - first) * np.exp(-np.maximum(now - 0.1, 0.0) / rng.uniform(0.5, 1.6))
    if rng.random() < 0.3:
        going *= ease((total - now) / rng.uniform(0.4, 0.8))
    return np.asarray(going)


def _circling(direction: str, gone: Array, total: float, rng: Generator) -> Array:
    side = {"clockwise": -1.0, "counterclockwise": 1.0}.get(direction, rng.choice([-1.0, 1.0]))
    radius = max(rng.uniform(0.5, 1.6), total / (3.5 * np.pi))
    return np.asarray(side * gone / min(radius, total / (1.3 * np.pi)))


def _zigzag(gone: Array, rng: Generator) -> Array:
    length = rng.uniform(0.9, 1.8)
    return np.asarray(rng.choice([-1, 1]) * rng.uniform(0.5, 0.9) * np.tanh(2.5 * np.sin(np.pi * gone / length)))


def _back_and_forth(gone: Array, total: float, rng: Generator) -> Array:
    turns = max(1, round(total / rng.uniform(1.5, 3.0)) - 1)
    at = total * np.arange(1, turns + 1) / (turns + 1)
    metres = max(0.6, 0.35 * FPS * float(np.diff(gone).max()))  # turns at speed need room
    return np.asarray(rng.choice([-1, 1]) * np.pi * ease((gone[:, None] - at) / metres + 0.5).sum(1))


def bearing(direction: str, way: Array, rng: Generator, *, faces: bool = False) -> tuple[Array, float]:
    """Heading and direction of movement along a path.

    Parameters
    ----------
    way : float array (N,)
        Distance travelled, metres.
    faces : bool
        Whether the body keeps facing ahead; otherwise it often turns to its direction.

    Returns
    -------
    facing : (N,) heading; angle : radians from the heading to the direction of movement, left positive.
    """
    gone = way - way[PAD]
    total = max(float(gone[-PAD - 1]), 0.3)
    if direction in ("clockwise", "counterclockwise", "around"):
        return _circling(direction, gone, total, rng), 0.0
    if direction == "zigzag":
        return _zigzag(gone, rng), 0.0
    if direction == "back and forth":
        return _back_and_forth(gone, total, rng), 0.0
    angle = TURN[direction]
    if "-" in direction:  # diagonals are rarely exact
        angle += np.sign(angle) * np.deg2rad(rng.uniform(-20, 20) * (1 if direction.startswith("forward") else -1))
    backward = direction.startswith("backward")
    if faces or backward or not angle or rng.random() < (0.85 if "-" in direction else 0.6):
        if direction in ("left", "right") and not faces:  # sideways movement while facing ahead drifts forward
            angle *= rng.uniform(0.4, 1.05)
        return _wandering(rng) * gone / max(total, 3.0), angle
    start = rng.uniform(0.0, 0.4) * total
    return angle * rng.uniform(0.85, 1.1) * ease((gone - start) / rng.uniform(0.5, 1.1)), 0.0


def _wandering(rng: Generator) -> float:
    """Random bend of a straight path, radians: mostly slight; one in four is larger."""
    return float(np.clip(rng.normal(0.0, 0.1 if rng.random() < 0.75 else 0.3), -0.4, 0.4))


def heading_offset(rng: Generator) -> float:
    """Random angle between heading and a forward path, radians: at most 12 degrees."""
    return float(np.clip(rng.normal(0.0, 0.08), -0.21, 0.21))


def plan_gait(
    step: ActionStep, gait: Gait, manner: Manner, rng: Generator, frames: int, going: Array | None = None
) -> tuple[Trajectory, Gait]:
    """The trajectory of a step, and the gait modified by direction, speed, amplitude and manner."""
    pace = tempo(step, rng)
    stride = manner.factor("stride") * {"small": 0.65, "": 1.0, "large": 1.3}[step.amplitude]
    still = step.direction == "in place"
    sideways = {"left": 0.8, "right": 0.8}.get(step.direction, 0.7 if step.direction.startswith("back") else 1.0)
    sideways *= rng.uniform(0.65, 1.3) if sideways < 1 else 1.0
    fastest = 1.9 if gait.duty > 0.5 else 6.5
    speed = gait.speed * pace * manner.factor("pace") * stride * sideways
    speed = min(speed, fastest)
    if going is None:  # runs in a hall are short and include start and stop
        going = _gaining(frames, rng) if gait.gains else effort(frames, rng, rest=0.5 if gait.duty > 0.5 else 0.65)
    way = np.cumsum(speed * going) / FPS
    facing, angle = bearing(
        "" if still else step.direction, np.zeros_like(way) if still else way, rng, faces=gait.faces
    )
    pace_of_feet = gait.cadence * np.sqrt(pace) * manner.factor("pace")
    if not still and abs(angle) < 0.3:
        angle += heading_offset(rng)
    if gait.duty < 0.4:  # gallops and high knees do not depend on speed
        gait = _running_at(gait, speed)
    # The reach of a leg is limited: longer steps at the same cadence shorten the stance.
    reach = 0.7 if gait.duty < 0.5 else 0.95
    duty = min(gait.duty, max(reach * pace_of_feet / 2 / max(speed, 0.1), 0.52 if gait.duty > 0.5 else 0.2))
    phase = gait_phase(pace_of_feet * (0.75 + 0.25 * going), rng.random(), manner)
    backing = max(-float(np.cos(angle)), 0.0)
    trying = going**0.4 if gait.gains else going  # sprints have full effort from the first step
    trajectory = Trajectory(integrate(0.0 * way if still else way, facing + angle), facing - facing[PAD], trying, phase)
    changed = replace(
        gait,
        speed=speed,
        duty=duty,
        arms=gait.arms * float(np.clip(stride * pace, 0.4, 1.4)),
        push=gait.push * (0.3 if still else max(float(np.cos(angle)), 0.15 + 0.15 * backing)),
        behind=gait.behind - 0.06 * backing,
        lean=gait.lean + backing * rng.normal(0.06, 0.1),
    )
    return trajectory, _sideways(changed, float(np.sin(angle)), speed / max(pace_of_feet, 0.5), rng)


def _running_at(gait: Gait, speed: float) -> Gait:
    """A run, parametrised at 3.4 m/s, at another speed: slower means longer stance, less lift and less lean."""
    ratio = float(np.clip(speed / 3.4, 0.35, 1.4))
    return replace(
        gait,
        duty=min(gait.duty * ratio**-0.3, 0.47),
        lift=gait.lift * ratio**0.7,
        kick=gait.kick * ratio**0.7,
        push=gait.push * ratio**0.3,
        lean=gait.lean * ratio**0.5,
        arms=gait.arms * ratio**0.4,
    )


def _sideways(gait: Gait, share: float, stride: float, rng: Generator) -> Gait:
    """The gait for sideways movement: wider; fully sideways the legs cross, or one foot leads and the other closes.

    `share` is the sine of the angle between heading and path, `stride` the metres of one step.
    """
    gait = replace(gait, width=gait.width + 0.03 * abs(share))
    if abs(share) < 0.35 or gait.duty < 0.5:
        return gait
    if rng.random() < 0.4:
        return replace(gait, cross=rng.choice([-1, 1]) * rng.uniform(0.05, 0.1))
    closing = float(np.sign(share)) * rng.uniform(0.0, 0.17)
    return replace(gait, width=max(gait.width, min(0.5 * stride * abs(share), 0.2)), offset=0.5 - closing)


def integrate(way: Array, direction: Array) -> Array:
    stretch = np.diff(way, prepend=way[0])[:, None]
    root = np.cumsum(stretch * np.stack([np.sin(direction), np.cos(direction)], axis=1), axis=0)
    return np.asarray(root - root[PAD])


def random_length(step: ActionStep, gait: Gait, manner: Manner, rng: Generator) -> int:
    """Random length of a gait in frames: up to 12 seconds, mostly limited by a room of 3 to 10 metres."""
    runs = gait.duty < 0.5
    most = rng.uniform(1.5, 4.0) if runs and rng.random() < 0.6 else rng.uniform(2.0, 6.0)
    if step.direction not in STRAIGHT:
        return int(most * FPS)
    if rng.random() < 0.4:  # a straight path across a hall
        most = rng.uniform(4.0, 12.0)
    if rng.random() < 0.2:
        return int(most * FPS)
    speed = gait.speed * manner.factor("pace") * manner.factor("stride") * SPEED[step.speed]
    return int(min(most, max(rng.uniform(2.5, 10.0) / speed, 0.8) + rng.uniform(0.1, 1.0)) * FPS)


def perform_gait(step: ActionStep, gait: Gait, manner: Manner, rng: Generator, frames: int = 0) -> Curves:
    """Perform a gait in the step's direction, for `frames` or a random length."""
    trajectory, gait = plan_gait(step, gait, manner, rng, frames or random_length(step, gait, manner, rng))
    curves = step_along(trajectory, gait, manner)
    # Hips and shoulders are rarely exactly parallel.
    twisted = rng.normal(0.0, 0.05)
    curves.pelvis[:, 2] -= twisted
    curves.spine[:, 2] += 1.5 * twisted
    _turn_along(curves, rng)
    return curves


def _turn_along(curves: Curves, rng: Generator) -> None:
    """In sideways movement, turn head and hips (with the toes) partly to the path, in place."""
    head = rng.uniform(0.1, 0.6) * (rng.random() < 0.4)
    hips = rng.uniform(0.05, 0.3) * (rng.random() < 0.5)
    way = curves.root[-1, [0, 2]] - curves.root[0, [0, 2]]
    aside = np.angle(np.exp(1j * (np.arctan2(way[0], way[1]) - curves.heading.mean())))
    if np.hypot(*way) > 0.5 and np.ptp(curves.heading) < 0.5 and 0.3 < abs(aside) < 2.0:
        curves.head[:, 2] += head * aside * hold(len(curves), 0.15, 0.1)
        turned = hips * np.clip(aside, -0.9, 0.9) * hold(len(curves), 0.15, 0.15)
        curves.pelvis[:, 2] += turned
        curves.spine[:, 2] -= turned
        curves.foot_yaw[:] += turned[:, None]
