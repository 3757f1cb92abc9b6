"""Feet that stand where they stood: sliding that a blend brings is taken out of the legs.

Where the pieces' own feet rest on the ground and those of the joined motion do not, each such foot is held at one place
and the leg bent to reach it (two-bone inverse kinematics); before and after, the foot is let go over a few frames, as
Kovar et al. ("Footskate cleanup for motion capture editing", SCA 2002) do.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from encoders.geometry import cross, length, unit
from encoders.skeleton import INDEX

Array = NDArray[np.float64]

_LEGS = [tuple(INDEX[f"{side}_{joint}"] for joint in ("hip", "knee", "ankle", "foot")) for side in ("left", "right")]
#: Metres above its own lowest height in which a foot may stand, metres a second below which it does.
_LOW, _SLOW = 0.06, 0.25
#: Shortest stand in seconds, seconds in which a held foot is let go, and how far a leg may be stretched.
_STAND, _RELEASE, _REACH = 0.1, 0.2, 0.999


def standing(joints: Array, fps: float) -> NDArray[np.bool_]:
    """Whether each foot (T, 2), left and right, rests on the ground."""
    toes = joints[:, [leg[3] for leg in _LEGS]]
    speed = length(np.gradient(toes, axis=0)) * fps if len(toes) > 1 else np.zeros(toes.shape[:2])
    low = toes[..., 1] - np.percentile(toes[..., 1], 2) < _LOW
    rests: NDArray[np.bool_] = low & (speed < _SLOW)
    return rests


def planted(joints: Array, rests: NDArray[np.bool_], fps: float) -> Array:
    """Joints (T, 22, 3) with feet held in place while they rest.

    Parameters
    ----------
    rests : bool array (T, 2)
        Where a foot should stand.
    """
    held: Array = joints.copy()
    for side, leg in enumerate(_LEGS):
        shift = np.zeros((len(joints), 3))
        for first, last in _runs(rests[:, side]):
            if (last - first) / fps < _STAND:
                continue
            at = joints[first:last, leg[3]]
            shift[first:last] = (np.median(at, axis=0) - at) * np.array([1.0, 0.0, 1.0])
        held[:, leg] = _reached(joints[:, leg], _eased(shift, rests[:, side], round(_RELEASE * fps)))
    return held


def _runs(rests: NDArray[np.bool_]) -> list[tuple[int, int]]:
    edges = np.flatnonzero(np.diff(np.concatenate([[0], rests.astype(np.int8), [0]])))
    return [(int(first), int(last)) for first, last in edges.reshape(-1, 2)]


def _eased(shift: Array, rests: NDArray[np.bool_], frames: int) -> Array:
    """Shifts (T, 3) that are let go before and after a stand, rather than at once."""
    known = np.flatnonzero(rests)
    if len(known) == 0 or frames < 1:
        return shift
    times = np.arange(len(shift))
    after = np.searchsorted(known, times)
    before = known[np.maximum(after - 1, 0)]
    ahead = known[np.minimum(after, len(known) - 1)]
    to_before, to_ahead = np.abs(times - before), np.abs(ahead - times)
    share = np.clip(1 - np.stack([to_before, to_ahead]) / frames, 0, None)
    share = share * share * (3 - 2 * share)
    share = share / np.maximum(share.sum(axis=0), 1)
    eased = share[0, :, None] * shift[before] + share[1, :, None] * shift[ahead]
    return np.where(rests[:, None], shift, eased)


def _reached(leg: Array, shift: Array) -> Array:
    """Hip, knee, ankle and toes (T, 4, 3) with ankle and toes shifted (T, 3), bones as long as before."""
    hip, knee, ankle, toes = (leg[:, i] for i in range(4))
    upper, lower = length(knee - hip), length(ankle - knee)
    way = ankle + shift - hip
    reach = np.minimum(length(way), _REACH * (upper + lower))
    direction = unit(way)
    along = (upper**2 - lower**2 + reach**2) / np.maximum(2 * reach, 1e-9)
    out = np.sqrt(np.maximum(upper**2 - along**2, 0))
    bend = knee - hip - direction * ((knee - hip) * direction).sum(-1, keepdims=True)
    straight = length(bend) < 1e-4
    bend = np.where(straight[:, None], cross(direction, np.broadcast_to([1.0, 0.0, 0.0], direction.shape)), bend)
    new_ankle = hip + direction * reach[:, None]
    new_knee = hip + direction * along[:, None] + unit(bend) * out[:, None]
    return np.stack([hip, new_knee, new_ankle, toes + new_ankle - ankle], axis=1)
