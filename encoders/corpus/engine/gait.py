"""Footsteps planted along a trajectory: the engine of walking, running, turning, marching and crawling."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from encoders.corpus.engine.curves import ANKLE, LEFT, LEGS, RIGHT, STAND, Array, Curves, ease, standing
from encoders.corpus.engine.style import Manner
from encoders.motion import FPS

#: Extra frames computed at either end, so that footholds outside the clip are known.
PAD = 30
_BALL = (0.065, 0.13)  # ball of the foot below and ahead of the ankle, metres


@dataclass(frozen=True)
class Gait:
    """Parameters of a gait; metres, radians, seconds.

    Attributes
    ----------
    speed : float
        Metres per second along the path.
    cadence : float
        Steps per second of both feet.
    duty : float
        Duty factor: share of a cycle that a foot is in stance; under 0.5 there is a flight phase.
    lift : float
        Rise of the ankle in the swing.
    bob : float
        Rise and fall of the hips.
    push : float
        Heel rise at push-off, radians.
    tiptoe : float
        Constant heel rise, radians.
    lean : float
        Forward lean of the body.
    arms : float
        Swing of the upper arm to either side of its middle, radians.
    elbow : float
        Bend of the elbow, radians.
    twist, yaw : float
        How far the chest turns against the legs to either side, radians; the pelvis' share of it, the other way.
    behind : float
        Distance of a foot behind the hips at mid-stance.
    around : float
        Outward swing of a foot.
    nod, tip : float
        How far the trunk pitches, and leans aside, to either side with every step, radians.
    kick : float
        Trailing of the heel in the swing, metres.
    drawn : float
        Backward carriage of the upper arms, radians.
    out : float
        Distance of the hands from the body, arm lengths.
    knees : float
        Outward swing of the knee, radians; inward if negative.
    width : float
        Half the distance between the feet.
    crouch : float
        Lowering of the hips from standing.
    offset : float
        Cycles from the landing of the left foot to that of the right.
    cross : float
        Distance of the left foot ahead of the right, for legs that cross in sideways steps.
    faces : bool
        Whether the body keeps facing ahead in sideways movement.
    gains : bool
        Whether speed increases throughout.
    """

    speed: float = 1.25
    cadence: float = 1.85
    duty: float = 0.565
    lift: float = 0.11
    bob: float = 0.008
    push: float = 0.75
    tiptoe: float = 0.0
    lean: float = 0.05
    arms: float = 0.16
    elbow: float = 0.34
    twist: float = 0.055
    yaw: float = 1.7
    behind: float = 0.0
    around: float = 0.03
    nod: float = 0.016
    tip: float = 0.07
    kick: float = 0.04
    drawn: float = 0.05
    out: float = 0.0
    knees: float = 0.0
    width: float = 0.04
    crouch: float = 0.005
    offset: float = 0.5
    cross: float = 0.0
    faces: bool = False
    gains: bool = False


@dataclass(frozen=True)
class Trajectory:
    """The path of a performer over N = F + 2 PAD frames.

    Attributes
    ----------
    root : float array (N, 2)
        x and z of the hips.
    facing : float array (N,)
        Heading of the body.
    effort : float array (N,)
        0 (standing still) to 1 (full stride).
    phase : float array (N,)
        Gait cycles, never decreasing; the left foot lands at integers.
    level : float array (N,) or float
        Height of the ground where the hips are.
    lift : float array (N,) or float
        Additional lift of the feet in the swing.
    """

    root: Array
    facing: Array
    effort: Array
    phase: Array
    level: Array | float = 0.0
    lift: Array | float = 0.0


def plant(
    trajectory: Trajectory, phase: Array, duty: float, aside: float, ahead: float = 0.0
) -> tuple[Array, Array, Array]:
    """A foot, knee or hand that is planted once per cycle and stays there until its swing.

    Parameters
    ----------
    phase : float array (N,)
        Its own cycles: planted from each integer on for a share of `duty`.
    aside, ahead : float
        Foothold to the left and ahead of the hips at mid-stance.

    Returns
    -------
    place : (N, 4) of x, ground, z and facing; share : (N,) of the cycle; swing : (N,) share of the swing.
    """
    frames = np.arange(len(phase), dtype=np.float64)
    index = np.floor(phase).astype(np.int64)
    holds = np.arange(index[0] - 1, index[-1] + 3)
    middle = np.interp(holds + duty / 2, phase + frames * 1e-9, frames)
    facing = np.interp(middle, frames, trajectory.facing)
    sin, cos = np.sin(facing), np.cos(facing)
    spots = np.empty((len(holds), 4))
    spots[:, 0] = np.interp(middle, frames, trajectory.root[:, 0]) + aside * cos + ahead * sin
    spots[:, 1] = (
        np.interp(middle, frames, trajectory.level) if isinstance(trajectory.level, np.ndarray) else trajectory.level
    )
    spots[:, 2] = np.interp(middle, frames, trajectory.root[:, 1]) - aside * sin + ahead * cos
    spots[:, 3] = facing
    share = phase - index
    swing = np.clip((share - duty) / (1 - duty), 0.0, 1.0)
    here = index - holds[0]
    move = ease(swing)[:, None]
    place = spots[here] * (1 - move) + spots[here + 1] * move
    # Up a step the foot rises first, down a step it sinks last.
    rise = spots[here + 1, 1] - spots[here, 1]
    place[:, 1] = spots[here, 1] + rise * ease(np.where(rise > 0, swing * 1.7, swing * 1.7 - 0.7))
    return place, share, swing


def _foot(trajectory: Trajectory, gait: Gait, manner: Manner, side: int) -> tuple[Array, Array, Array, Array]:
    """Ankle (N, 3), foot pitch (N,), foot yaw (N,) and outward knee swing (N,) of one side."""
    width = gait.width * float(np.clip(manner.factor("width"), 0.25, 2.8))
    place, share, swing = plant(
        trajectory,
        trajectory.phase - (gait.offset if side == RIGHT else 0.0),
        gait.duty,
        width if side == LEFT else -width,
        (gait.cross if side == LEFT else -gait.cross) - gait.behind,
    )
    effort, facing = trajectory.effort, place[:, 3]
    # A foot that must still move after the body has come to rest is lifted as well.
    goes = np.hypot(np.gradient(place[:, 0]), np.gradient(place[:, 2])) * FPS
    raised = np.maximum(gait.lift + manner.lift, 0.015) * np.maximum(effort, 0.6 * ease(goes / 0.5)) + trajectory.lift
    raised = raised * np.sin(np.pi * swing**0.75) ** 1.3  # the heel is highest early in the swing
    # Push-off: the heel rises about the ball of the foot, then the toes come up for landing.
    flat = 0.62 if gait.duty > 0.5 else 0.4
    off = ease((share - flat * gait.duty) / ((1 - flat) * gait.duty)) * (1 - ease(swing / 0.6))
    land = ease((swing - 0.5) / 0.5) + np.where(share < gait.duty, 1 - ease(share / (0.2 * gait.duty)), 0.0)
    heel = np.maximum(gait.push * off * effort, gait.tiptoe)
    down, ahead = _BALL
    forward = down * np.sin(heel) + ahead * (1 - np.cos(heel))
    up = ahead * np.sin(heel) - down * (1 - np.cos(heel))
    swinging = np.sin(np.pi * swing) * effort
    outward = (1 if side == LEFT else -1) * gait.around * swinging
    forward = forward - gait.kick * swinging
    ankle = np.empty((len(share), 3))
    ankle[:, 0] = place[:, 0] + forward * np.sin(facing) + outward * np.cos(facing)
    ankle[:, 1] = ANKLE + place[:, 1] + raised + up
    ankle[:, 2] = place[:, 2] + forward * np.cos(facing) - outward * np.sin(facing)
    toes = 0.0 if gait.tiptoe else 0.35 * min(gait.push, 0.7)
    return ankle, toes * effort * np.minimum(land, 1.0) - heel, facing, gait.knees * swinging


def step_along(trajectory: Trajectory, gait: Gait, manner: Manner) -> Curves:
    """Curves of a body along a trajectory; all channels are set, only "legs" are occupied."""
    keep = slice(PAD, len(trajectory.phase) - PAD)
    phase, effort = trajectory.phase[keep], trajectory.effort[keep]
    curves = standing(len(phase), LEGS)
    for side in (LEFT, RIGHT):
        ankle, pitch, yaw, knee = _foot(trajectory, gait, manner, side)
        curves.feet[:, side], curves.foot_pitch[:, side] = ankle[keep], pitch[keep]
        curves.foot_yaw[:, side] = yaw[keep] - curves.foot_yaw[:, side]  # toes point straight ahead
        curves.knee[:, side] += knee[keep] if side == LEFT else -knee[keep]
    cycle = 2 * np.pi * phase
    middle = cycle - np.pi * gait.duty  # 0 at mid-stance of the left foot, pi at mid-stance of the right
    beat = np.cos(middle)
    _hips(curves, trajectory, gait, manner, middle)
    _torso(curves, gait, manner, effort, cycle, beat)
    _balance(curves, trajectory, 0.25 if gait.duty > 0.5 else 0.33)
    _arms(curves, gait, manner, effort, cycle)
    return curves


def _hips(curves: Curves, trajectory: Trajectory, gait: Gait, manner: Manner, middle: Array) -> None:
    keep = slice(PAD, len(trajectory.phase) - PAD)
    beat = np.cos(middle)
    effort, facing = trajectory.effort[keep], trajectory.facing[keep]
    narrow = min(gait.width / 0.05, 1.6)
    wide = (0.04 if gait.duty < 0.5 else 0.026) * narrow
    sway = wide * float(np.clip(manner.factor("sway"), 0.2, 2.5)) * effort * beat
    # Slower over the standing foot, faster from foot to foot; least so where the body flies.
    share = 0.13 if gait.duty > 0.5 else 0.08
    surge = np.gradient(trajectory.root, axis=0)[keep] * FPS * share / (2 * np.pi * gait.cadence)
    surge *= -np.sin(2 * middle)[:, None]
    curves.root[:, 0] = trajectory.root[keep, 0] + sway * np.cos(facing) + surge[:, 0]
    curves.root[:, 2] = trajectory.root[keep, 1] - sway * np.sin(facing) + surge[:, 1]
    flies = gait.duty < 0.5
    bob = gait.bob * float(np.clip(manner.factor("bounce"), 0.2, 1.5 if flies else 2.5))
    bob += 0.011 * max(manner.bounce - 0.2, 0.0) + 0.4 * manner.pulse
    bob = -bob if flies else bob
    level = smooth_level(trajectory.level, len(trajectory.phase))[keep]
    # The body sinks and leans over a limping leg in stance.
    curves.root[:, 1] = STAND + level - gait.crouch + 0.12 * np.sin(gait.tiptoe)
    curves.root[:, 1] += effort * (bob * (2 * beat * beat - 1) - 0.03 * manner.limp * beat)
    curves.heading[:] = facing


def smooth_level(level: Array | float, frames: int, window: int = 15) -> Array:
    """Smoothed height of the ground under the hips (N,)."""
    if not isinstance(level, np.ndarray):
        return np.full(frames, float(level))
    padded = np.pad(level, window // 2, mode="edge")
    return np.convolve(padded, np.full(window, 1 / window), mode="valid")


def _torso(curves: Curves, gait: Gait, manner: Manner, effort: Array, cycle: Array, beat: Array) -> None:
    roll = 0.05 * float(np.clip(manner.factor("sway"), 0.2, 3.0)) * effort * beat
    turn = gait.twist * float(np.clip(manner.factor("twist"), 0.2, 2.5)) * effort * np.cos(cycle - 0.15)
    # The trunk pitches forward at foot contact and back over the foot.
    nod = gait.nod * effort * np.cos(2 * cycle - 0.4)
    curves.pelvis[:, 0] = 0.35 * gait.lean * effort + nod
    curves.pelvis[:, 1] = -roll
    curves.pelvis[:, 2] = -gait.yaw * turn
    curves.spine[:, 0] = 0.65 * gait.lean * effort
    # The trunk leans towards the landing foot.
    curves.spine[:, 1] = roll + effort * ((gait.tip + manner.rock) * np.cos(cycle) + 0.12 * manner.limp * beat)
    curves.spine[:, 2] = (1 + gait.yaw) * turn
    curves.head[:, 0] = -0.5 * gait.lean * effort + 4.0 * manner.pulse * effort * np.cos(2 * cycle)
    curves.head[:, 2] = -0.7 * turn


def _balance(curves: Curves, trajectory: Trajectory, share: float) -> None:
    """Lean against acceleration and centripetal force, by a share of the equilibrium angle."""
    keep = slice(PAD, len(trajectory.phase) - PAD)
    sin, cos = np.sin(trajectory.facing), np.cos(trajectory.facing)
    velocity = np.gradient(trajectory.root, axis=0) * FPS
    forward = velocity[:, 0] * sin + velocity[:, 1] * cos
    ahead = share * np.gradient(forward)[keep] * FPS / 9.81
    inward = 1.5 * share * (forward * np.gradient(trajectory.facing))[keep] * FPS / 9.81
    lean, roll = 0.35 * np.tanh(ahead / 0.35), 0.25 * np.tanh(inward / 0.25)
    curves.pelvis[:, 0] += 0.5 * lean
    curves.spine[:, 0] += 0.5 * lean
    curves.head[:, 0] -= 0.6 * lean
    curves.pelvis[:, 1] += 0.6 * roll
    curves.spine[:, 1] += 0.4 * roll


def _arms(curves: Curves, gait: Gait, manner: Manner, effort: Array, cycle: Array) -> None:
    swing = min(gait.arms * float(np.clip(manner.factor("swing"), 0.05, 2.2)), 1.25)
    side = np.stack([-np.cos(cycle - 0.15), np.cos(cycle - 0.15)], axis=1)  # 1: this arm is ahead
    effort = effort[:, None]
    upper = effort * (swing * side - gait.drawn)
    # Walkers swing the forearm; runners the upper arm, with the hands in front of the body.
    forearm, inward = (0.35, 0.08) if gait.duty < 0.5 else (1.2, 0.0)
    bend = 0.2 + effort * (gait.elbow - 0.2 + forearm * swing * (side + 0.3))
    out = 0.1 + effort * (gait.out - (inward + 0.1 * np.maximum(side, 0.0)) * min(gait.elbow, 1.0))
    swing_arms(curves, upper, np.maximum(bend, 0.05), out)
    if gait.duty < 0.5:  # elbows rise behind the body
        curves.elbow[:] -= 0.3 * swing * effort * side


def swing_arms(curves: Curves, upper: Array, bend: Array, out: float | Array = 0.13) -> None:
    """Swing both arms in the sagittal plane, in place.

    Parameters
    ----------
    upper, bend : float array (F, 2)
        Upper arm forward of hanging; elbow bend; radians.
    out : float or (F, 2)
        Wrist outward of its shoulder, arm lengths.
    """
    plane = np.sqrt(1 - np.square(np.minimum(np.abs(out), 0.6)))
    curves.hands[..., 0] = out
    curves.hands[..., 1] = -plane * (0.5 * np.cos(upper) + 0.49 * np.cos(upper + bend))
    curves.hands[..., 2] = plane * (0.5 * np.sin(upper) + 0.49 * np.sin(upper + bend))


def gait_phase(rate: Array, start: float, manner: Manner) -> Array:
    """Gait cycles from steps per second (N,); uneven if the manner limps or is jerky."""
    phase = start + np.cumsum(rate) / (2 * FPS)
    angle = 2 * np.pi * phase
    uneven = 0.045 * float(np.clip(manner.limp, -1.2, 1.2)) * np.sin(angle)
    return np.asarray(phase + uneven + 0.025 * float(np.clip(manner.jerk, 0.0, 1.2)) * np.sin(2 * angle))
