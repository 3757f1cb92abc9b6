"""What is measured on a motion: how often it repeats something, and by how much it turns.

A repetition is a bump of the movement of hands, feet, knees, elbows and head as seen from the pelvis, and of the height
of the pelvis, along one of its first principal components, away from where it begins and ends. That something is done n
times is the likelier, the more the n-th highest bump (by prominence) stands out from the next. Turns are read from the
direction that hips and shoulders face.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from encoders.geometry import length
from encoders.motion import Motion
from encoders.skeleton import INDEX

Array = NDArray[np.float64]

_PARTS = [
    INDEX[name]
    for name in "left_wrist right_wrist left_ankle right_ankle left_knee right_knee left_elbow right_elbow head".split()
]
#: Frames a second at which is measured, and frames over which is smoothed.
_FPS, _SMOOTH = 20.0, 5
#: Repetitions that are told apart, at most, and components that are looked at.
MOST_TIMES, _COMPONENTS = 10, 5
#: Metres of a bump at least, and by which two bumps differ by chance.
_LEAST, _NOISE = 0.03, 0.012
#: How much larger components count.
_SIZE = 0.25
#: How far from the middle of its range a signal may begin and end where bumps both ways count.
_BETWEEN = 0.2


def times_done(motion: Motion) -> Array:
    """How likely a motion does something 0, 1, 2 ... `MOST_TIMES` times (MOST_TIMES + 1,); 1 the likeliest."""
    components = _components(motion.resample(_FPS).joints.astype(np.float64))
    largest = max(float(np.ptp(components[:, 0])), 1e-9)
    likely = np.zeros(MOST_TIMES + 1)
    for signal in (up for component in components.T for up in _from_rest(component)):
        bumps = np.zeros(MOST_TIMES + 1)
        found = _prominences(signal)[: MOST_TIMES + 1]
        bumps[: len(found)] = found
        gaps = np.log((bumps[:-1] + _NOISE) / (bumps[1:] + _NOISE)) * (bumps[:-1] / largest) ** _SIZE
        likely[1:] = np.maximum(likely[1:], np.where(bumps[:-1] >= _LEAST, gaps, 0))
    return likely / max(float(likely.max()), 1e-9)


def turned(motion: Motion) -> float:
    """By how many degrees a motion turns at most from any instant to a later one; to the left positive."""
    facing = _facing(motion.resample(_FPS).joints.astype(np.float64))
    angle = _smoothed(np.degrees(np.unwrap(np.arctan2(facing[:, 0], facing[:, 1])))[:, None])[:, 0]
    left, right = (angle - np.minimum.accumulate(angle)).max(), (np.maximum.accumulate(angle) - angle).max()
    return float(left if left >= right else -right)


def _facing(joints: Array) -> Array:
    """The horizontal direction (T, 2), as x and z, that hips and shoulders face."""
    hips, shoulders = (
        joints[:, INDEX[f"left_{part}"]] - joints[:, INDEX[f"right_{part}"]] for part in ("hip", "shoulder")
    )
    across = hips + shoulders
    return np.stack([-across[:, 2], across[:, 0]], axis=1)


def _components(joints: Array) -> Array:
    """The first principal components (T, n) of the body's movement, in metres."""
    facing = _unit(_smoothed(_unit(_facing(joints))))
    seen = joints[:, _PARTS] - joints[:, :1]
    x, z = facing[:, None, 0], facing[:, None, 1]
    side, ahead = seen[..., 0] * z - seen[..., 2] * x, seen[..., 0] * x + seen[..., 2] * z
    signals = _smoothed(np.concatenate([side, ahead, seen[..., 1], 2 * joints[:, 0, 1:2]], axis=1))
    signals -= signals.mean(axis=0)
    _, _, axes = np.linalg.svd(signals, full_matrices=False)
    return np.asarray(signals @ axes[:_COMPONENTS].T)


def _unit(vectors: Array) -> Array:
    return np.asarray(vectors / np.maximum(length(vectors), 1e-9)[:, None])


def _smoothed(values: Array) -> Array:
    """The moving average over `_SMOOTH` frames of values (T, N)."""
    reach = min(_SMOOTH, len(values)) // 2
    padded = np.concatenate([values[:1].repeat(reach, 0), values, values[-1:].repeat(reach, 0)])
    sums = np.cumsum(np.concatenate([np.zeros((1, values.shape[1])), padded]), axis=0)
    width = 2 * reach + 1
    return np.asarray((sums[width:] - sums[:-width]) / width)


def _from_rest(signal: Array) -> list[Array]:
    """A signal, upside down where it begins and ends high; both ways where it does so in between."""
    low, high = signal.min(), signal.max()
    rest = ((signal[0] + signal[-1]) / 2 - low) / max(high - low, 1e-9)
    return [s for s, holds in ((signal, rest < 0.5 + _BETWEEN), (-signal, rest > 0.5 - _BETWEEN)) if holds]


def _prominences(signal: Array) -> Array:
    """How far each local maximum stands above the higher of the valleys beside it, the highest first."""
    rises = np.sign(np.diff(signal))
    peaks = np.flatnonzero((np.append(1, rises) > 0) & (np.append(rises, -1) <= 0))
    found = []
    for peak in peaks:
        higher = np.flatnonzero(signal > signal[peak])
        before, after = higher[higher < peak], higher[higher > peak]
        left = signal[(before[-1] if len(before) else 0) : peak + 1].min()
        right = signal[peak : (after[0] if len(after) else len(signal))].min()
        found.append(signal[peak] - max(left, right))
    return np.sort(np.array(found, np.float64))[::-1]
