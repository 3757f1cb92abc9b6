"""Keyframes: a movement as a sequence of key poses, as animators block it, interpolated to curves.

Key poses assume that the right side leads; for the left side the curves are mirrored. Sideways values are positive
towards the leading side; hands are (outward, upward, forward) of their own shoulder in arm lengths; feet are (outward,
upward, forward) of their standing position in metres; angles are radians. Channels of a key pose:

    lead, off, hands        wrist of the leading hand, of the other, of both; REST hangs
    hand, elbow             both if the step's side is "both", otherwise the leading one
    lead_elbow, off_elbow, elbows                               how far the elbow is turned out
    lead_reach, off_reach, reaches                              wrist in the world, (to its own side, up, forward) m
    spine, pelvis, head     (forward, to the leading side, turned to the leading side)
    root                    hips moved (to the leading side, up, forward), in metres
    lead_foot, off_foot, feet; lead_toes, off_toes (raised); lead_turn, off_turn (toes outward);
    lead_knee, off_knee     how far the knee is turned outward
    shrugs                  shoulders raised
    heading                 the whole body turned to the leading side
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.random import Generator
from numpy.typing import ArrayLike

from encoders.corpus.engine.curves import BODY, HANGING, LEFT, RIGHT, Array, Curves, standing
from encoders.corpus.engine.inbetweens import (
    accompany,
    clear_of_body,
    elbow_room,
    step_round,
    swung,
    take_stance,
    through,
    with_arcs,
)
from encoders.motion import FPS

REST = HANGING
#: Channels of a key pose and their values.
Channels = dict[str, ArrayLike]
_PAIRS = {
    "hands": ("lead", "off"), "elbows": ("lead_elbow", "off_elbow"), "reaches": ("lead_reach", "off_reach"),
    "feet": ("lead_foot", "off_foot"),
}  # fmt: skip
_NEUTRAL: dict[str, tuple[float, ...]] = {
    "lead": REST, "off": REST, "lead_elbow": (0.0,), "off_elbow": (0.0,), "spine": (0.0,) * 3, "pelvis": (0.0,) * 3,
    "head": (0.0,) * 3, "root": (0.0,) * 3, "lead_foot": (0.0,) * 3, "off_foot": (0.0,) * 3, "lead_toes": (0.0,),
    "off_toes": (0.0,), "lead_turn": (0.0,), "off_turn": (0.0,), "lead_knee": (0.0,), "off_knee": (0.0,),
    "shrugs": (0.0,), "heading": (0.0,),
}  # fmt: skip
_BEFORE_CHEST = np.array([0.0, -0.45, 0.3])
_TO_LEAD = np.array([1.0, -1.0, -1.0])  # the right side leads: towards it is -X, and to the left is positive in Curves


@dataclass(frozen=True)
class KeyPose:
    """A pose reached `seconds` after the previous one and held for `hold`; other channels interpolate across it."""

    seconds: float
    hold: float
    channels: Channels


def key(seconds: float, hold: float = 0.0, /, **channels: ArrayLike) -> KeyPose:
    """A key pose; see the module docstring for the channels."""
    return KeyPose(seconds, hold, channels)


def back(seconds: float = 0.6) -> KeyPose:
    """A key pose of standing relaxed: all channels return to neutral."""
    return KeyPose(seconds, 0.0, {"all": ()})


def _expand(keys: Iterable[KeyPose], both: bool) -> list[KeyPose]:
    """Expand paired channels, and `hand` and `elbow` by the side."""
    aliases: dict[str, tuple[str, ...]] = {
        **_PAIRS,
        "hand": _PAIRS["hands"] if both else ("lead",),
        "elbow": _PAIRS["elbows"] if both else ("lead_elbow",),
    }
    return [
        KeyPose(k.seconds, k.hold, {name: v for c, v in k.channels.items() for name in aliases.get(c, (c,))})
        for k in keys
    ]


def _timed(
    keys: Sequence[KeyPose], tempo: float, rng: Generator, frames: int
) -> tuple[list[tuple[float, float, Channels]], float]:
    """(arrival, departure, channels) of each key in seconds, with random timing, and the total."""
    moves = np.array([k.seconds for k in keys]) * tempo * np.exp(rng.normal(0.0, 0.08, len(keys)))
    holds = np.array([k.hold for k in keys]) * np.exp(rng.normal(0.0, 0.25, len(keys)))
    total = float(moves.sum() + holds.sum())
    wanted = frames / FPS
    if frames and total > wanted:
        squeeze = max(wanted / total, 0.6)
        moves, holds = moves * squeeze, holds * squeeze
    elif frames and holds.any():
        holds = holds * (1.0 + (wanted - total) / holds.sum())
    leave = np.cumsum(moves + holds)
    return [
        (float(end - hold), float(end), k.channels) for k, end, hold in zip(keys, leave, holds, strict=True)
    ], float(leave[-1])


def _tracks(timed: Sequence[tuple[float, float, Channels]]) -> dict[str, tuple[Array, Array]]:
    """Key times and values of each channel that any key names, starting at the neutral pose."""
    named = {name for _, _, channels in timed for name in channels} - {"all"}
    named |= {{"lead_reach": "lead", "off_reach": "off"}.get(name, name) for name in named}
    tracks = {}
    for name in named:
        rows: list[tuple[float, Array]] = []
        neutral = None if name.endswith("reach") else np.array(_NEUTRAL[name])
        if neutral is not None:
            rows.append((0.0, neutral))
        for index, (arrive, leave, channels) in enumerate(timed):
            value = channels.get(name, neutral if "all" in channels else None)
            if value is None:
                continue
            value = np.atleast_1d(np.asarray(value, np.float64))
            if "foot" in name and rows and "all" not in channels:
                rows += _stride(rows[-1], (arrive, value))
            elif "foot" in name and rows:
                rows += _return(name, rows[-1], timed[index - 1][1] if index else 0.0, arrive, value)
            rows.append((arrive, value))
            if leave > arrive:
                rows.append((leave, value))
        if rows and rows[0][0] == 0.0 and len(rows) > 1 and rows[1][0] <= 1e-6:
            rows.pop(0)  # a key at time zero replaces the neutral pose
        tracks[name] = (np.array([t for t, _ in rows]), np.array([v for _, v in rows]))
    return tracks


def _stride(start: tuple[float, Array], end: tuple[float, Array]) -> list[tuple[float, Array]]:
    """The lifted middle of a step between two places on the ground."""
    way = float(np.hypot(*(end[1] - start[1])[[0, 2]]))
    if way < 0.02 or max(start[1][1], end[1][1]) > 0.02:
        return []
    middle = (start[1] + end[1]) / 2 + np.array([0.0, np.clip(0.25 * way, 0.03, 0.12), 0.0])
    return [((start[0] + end[0]) / 2, middle)]


def _return(name: str, last: tuple[float, Array], begin: float, end: float, value: Array) -> list[tuple[float, Array]]:
    """The return of a foot: the leading one in the first half of the time, the other in the second."""
    middle = (begin + end) / 2
    start, stop = (begin, middle) if name == "lead_foot" else (middle, end)
    home = [] if stop == end else [(stop, value)]
    return [(start, last[1]), *_stride((start, last[1]), (stop, value)), *home]


def play(
    keys: Sequence[KeyPose],
    rng: Generator,
    *,
    lead: str = "right",
    both: bool = False,
    tempo: float = 1.0,
    frames: int = 0,
    parts: Iterable[str] = BODY,
    precise: bool = False,
    reach: float = 1.0,
) -> Curves:
    """Interpolate key poses to curves.

    Parameters
    ----------
    keys : sequence of Key
        Starting from standing relaxed.
    lead : str
        Side that leads, "left" or "right".
    both : bool
        Whether `hand` and `elbow` refer to both sides.
    tempo : float
        Factor of the time between key poses.
    frames : int
        Target length, by longer holds or somewhat faster moves; 0 for the natural length.
    parts : iterable of str
        Occupied body parts; "lead_arm" is the leading arm, or both.
    precise : bool
        Whether hands touch something, so that their positions vary little.
    reach : float
        Factor of the hands' distance from the chest, unless precise.
    """
    timed, total = _timed(_expand(keys, both), tempo, rng, frames)
    count = max(2, round(total * FPS))
    now = np.arange(count) / FPS
    tracks = _tracks(timed)
    owned = {p for part in parts for p in (_lead_parts(both) if part == "lead_arm" else (part,))}
    curves = standing(count, frozenset(owned))
    for name, (times, values) in tracks.items():
        if name in ("lead", "off") or name.endswith("reach"):
            continue
        _write(curves, name, through(now, times, values))
    for hand, name in ((RIGHT, "lead"), (LEFT, "off")):
        _move_hand(curves, hand, name, tracks, now, timed, rng, None if precise else reach)
    take_stance(curves, rng)
    if "heading" in tracks:
        step_round(curves)
    accompany(curves, rng)
    return curves.mirrored() if lead == "left" else curves


def _lead_parts(both: bool) -> tuple[str, ...]:
    return ("left_arm", "right_arm") if both else ("right_arm",)


def _write(curves: Curves, name: str, value: Array) -> None:
    side = RIGHT if name.startswith("lead") else LEFT
    outward = np.array([-1.0 if side == RIGHT else 1.0, 1.0, 1.0])
    if name in ("spine", "pelvis", "head"):
        getattr(curves, name)[:] += value * _TO_LEAD
    elif name == "root":
        curves.root[:] += value * [-1.0, 1.0, 1.0]
    elif name == "heading":
        curves.heading[:] -= value[:, 0]
    elif name == "shrugs":
        curves.shrug[:] += value
    elif name.endswith("foot"):
        curves.feet[:, side] += value * outward
        curves.foot_pitch[:, side] -= np.clip(2.0 * value[:, 1], 0.0, 0.5)  # a raised foot hangs
    elif name.endswith("toes"):
        curves.foot_pitch[:, side] += value[:, 0]
    elif name.endswith("turn"):
        curves.foot_yaw[:, side] += value[:, 0] * outward[0]
    elif name.endswith("knee"):
        curves.knee[:, side] += value[:, 0] * outward[0]
    elif name.endswith("elbow"):
        curves.elbow[:, side] += value[:, 0]
    else:
        raise ValueError(f"a key pose has no channel {name!r}")


def _move_hand(
    curves: Curves,
    hand: int,
    name: str,
    tracks: dict[str, tuple[Array, Array]],
    now: Array,
    timed: Sequence[tuple[float, float, Channels]],
    rng: Generator,
    reach: float | None,
) -> None:
    """Set wrist, hang and reach of one hand; hands off rest get noise, little of it if `reach` is None (precise)."""
    if name not in tracks:
        curves.hands[:, hand] += rng.normal(0.0, 0.02, 3)
        return
    times, target = tracks[name]
    busy = np.abs(target - np.array(REST)).max(-1, keepdims=True) > 0.02
    if reach is None:
        stray = rng.normal(0.0, 0.018, 3) + rng.normal(0.0, 0.006, target.shape)
    else:
        stray = rng.normal(0.0, 0.045, 3) + rng.normal(0.0, 0.015, target.shape)
        target = target + (reach - 1.0) * (target - _BEFORE_CHEST) * busy
    values = target + stray * busy
    length, meant = np.linalg.norm(values, axis=1, keepdims=True), np.linalg.norm(target, axis=1, keepdims=True)
    values = np.where(meant > 0.88, values * np.minimum(meant / length, 1.0 / length), values)
    times, rows = with_arcs(times, np.concatenate([values, 0.8 - 0.65 * busy], axis=1), rng)
    late = now - rng.normal(0.0, 0.02)
    place, curves.hang[:, hand] = swung(late, times, rows, rng.uniform(0.5, 1.0))
    curves.hands[:, hand] = clear_of_body(place)
    curves.elbow[:, hand] += elbow_room(curves.hands[:, hand])
    curves.elbow[:, hand] += rng.normal(0.0, 0.2) * (0.8 - curves.hang[:, hand]) / 0.65
    if f"{name}_reach" in tracks:
        spots, places = tracks[f"{name}_reach"]
        weights = [(0.0, 0.0)]
        for arrive, leave, channels in timed:
            if f"{name}_reach" in channels or name in channels or "all" in channels:
                weights += [(t, float(f"{name}_reach" in channels)) for t in sorted({arrive, leave})]
        table = np.array(weights)
        outward = np.array([-1.0 if hand == RIGHT else 1.0, 1.0, 1.0])
        curves.reach[:, hand] = through(now, spots, places + rng.normal(0.0, 0.015, 3)) * outward
        curves.reach_weight[:, hand] = through(now, table[:, 0], table[:, 1:])[:, 0]
