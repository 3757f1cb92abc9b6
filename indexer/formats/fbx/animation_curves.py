"""Animation curves: keys, how values go from one to the next, and their values at given times.

Between two keys a curve stays, goes straight, or follows a cubic Bezier in time and value. A tangent has a slope, and a
weight: the share of the interval along which it pulls, a third unless stated. Which bits of a key mean what, and how
slopes of `auto` keys come about, is as ufbx (version 0.21) and with it the FBX SDK have it.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from indexer.formats.fbx.records import DamagedFbx, Record

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]

CONSTANT, CUBIC = 0x2, 0x8
TO_NEXT = 0x100  # of a constant: it takes the next key's value
TCB, USER = 0x200, 0x400
CLAMP, TIME_INDEPENDENT, CLAMP_PROGRESSIVE = 0x1000, 0x2000, 0x4000
_WEIGHTED, _NEXT_WEIGHTED = 0x1000000, 0x2000000
THIRD = 0.333333
_WEIGHT_UNIT = 1e-4
_FLAT = 1e-4  # the slopes of a key below which it has no bias
_STEPS = 10  # of Newton's method


class Extrapolation(NamedTuple):
    """What a curve does beyond its keys: the format's letter, C where it stays; how often, below 0 for ever."""

    mode: str = "C"
    repeats: int = -1


@dataclass(frozen=True)
class Curve:
    """Keys of one curve.

    Attributes
    ----------
    times : int array (K,)
        In ticks, ascending.
    values : float array (K,)
    runs : int array (R,)
        How many keys in sequence each of the following is for.
    flags : int array (R,)
    slopes : float array (R, 2)
        Of the tangent after the key, and of that before the next key. For TCB keys tension and continuity.
    weights : float array (R, 2)
        Likewise.
    bias : float array (R,)
        Of TCB keys.
    before, after : Extrapolation
    """

    times: Integers
    values: Floats
    runs: Integers
    flags: Integers
    slopes: Floats
    weights: Floats
    bias: Floats
    before: Extrapolation
    after: Extrapolation


def read_curve(record: Record) -> Curve | None:
    """The curve of a record; None where it has no keys.

    Raises
    ------
    DamagedFbx
        Where its arrays do not belong together.
    """
    times, values = record.numbers("KeyTime", "i8"), record.numbers("KeyValueFloat", "f8")
    flags, runs = record.numbers("KeyAttrFlags", "i8"), record.numbers("KeyAttrRefCount", "i8")
    data = record.numbers("KeyAttrDataFloat", "f4")
    if not len(times):
        return None
    if len(values) != len(times) or len(runs) != len(flags) or len(data) != 4 * len(runs):
        raise DamagedFbx(f"a curve of {len(times)} keys has {len(values)} values and {len(runs)} sets of attributes")
    ends = np.minimum(np.cumsum(np.clip(runs, 0, len(times))), len(times))
    if not len(ends) or ends[-1] < len(times):
        raise DamagedFbx(f"a curve of {len(times)} keys has attributes for fewer")
    runs = np.diff(ends, prepend=0)
    data = data.reshape(-1, 4)
    # two weights are packed into the bits of one number
    packed = np.ascontiguousarray(data[:, 2]).view("<u4").astype(np.int64)
    weights = np.stack(
        [
            np.where(flags & _WEIGHTED, (packed & 0xFFFF) * _WEIGHT_UNIT, THIRD),
            np.where(flags & _NEXT_WEIGHTED, (packed >> 16) * _WEIGHT_UNIT, THIRD),
        ],
        axis=1,
    )
    slopes = np.nan_to_num(data[:, :2].astype(np.float64))
    bias = np.nan_to_num(data[:, 2].astype(np.float64))
    curve = Curve(times, values, runs, flags, slopes, weights, bias, *extrapolations(record))
    return checked(curve)


def checked(curve: Curve) -> Curve:
    """The curve, with keys in order of time.

    Raises
    ------
    DamagedFbx
        Where values are no numbers.
    """
    if not np.isfinite(curve.values).all() or np.abs(curve.times).max() > 1 << 60:
        raise DamagedFbx("a curve holds values that are no numbers")
    if (np.diff(curve.times) < 0).any():
        order = np.argsort(curve.times, kind="stable")
        runs = np.repeat(np.arange(len(curve.runs)), curve.runs)[order]
        ones = np.ones(len(order), np.int64)
        curve = replace(
            curve, times=curve.times[order], values=curve.values[order], runs=ones, flags=curve.flags[runs],
            slopes=curve.slopes[runs], weights=curve.weights[runs], bias=curve.bias[runs],
        )  # fmt: skip
    return curve


def extrapolations(record: Record) -> tuple[Extrapolation, Extrapolation]:
    found = []
    for name in ("Pre-Extrapolation", "Post-Extrapolation"):
        child = record.find(name)
        kind = child.find("Type") if child is not None else None
        if child is None or kind is None or not kind.values:
            found.append(Extrapolation())
            continue
        mode = kind.values[0]
        letter = chr(mode) if isinstance(mode, int) and 0 < mode < 128 else str(mode)
        found.append(Extrapolation(letter, int(np.clip(child.number("Repetition", -1), -1, 1 << 30))))
    return found[0], found[1]


def sample(curves: Sequence[Curve], ticks: Floats, second: float) -> Floats:
    """Values (C, T) of curves at times (T,) in ticks, of which a second has so many."""
    values = np.empty((len(curves), len(ticks)))
    if not curves:
        return values
    keys = _Keys.of(curves, second)
    left, times = np.empty((len(curves), len(ticks)), np.int64), np.empty((len(curves), len(ticks)))
    raised: dict[int, Floats] = {}
    known: dict[int, tuple[Integers, Floats]] = {}  # curves often share the times of their keys
    for i, curve in enumerate(curves):
        if curve.before.mode != "C" or curve.after.mode != "C":
            inside, raised[i] = _extrapolated(curve, ticks, second)
            left[i], times[i] = _places(curve, inside)
            continue
        if id(curve.times) not in known:
            known[id(curve.times)] = _places(curve, ticks)
        left[i], times[i] = known[id(curve.times)]
    values = keys.values_at(left + keys.firsts[:, None], times)
    for i, offsets in raised.items():
        values[i] += offsets
    return values


def _places(curve: Curve, ticks: Floats) -> tuple[Integers, Floats]:
    """The key at or before each time, and the time, no earlier than the first key and no later than the last."""
    places = np.searchsorted(curve.times, ticks, side="right") - 1
    return np.maximum(places, 0), np.clip(ticks, curve.times[0], curve.times[-1])


def _extrapolated(curve: Curve, ticks: Floats, second: float) -> tuple[Floats, Floats]:
    """Times (T,) within the keys that stand for given ones, and what is to be added to the values there."""
    first, last = float(curve.times[0]), float(curve.times[-1])
    length, rise = last - first, float(curve.values[-1] - curve.values[0])
    moved, raised = ticks.copy(), np.zeros(len(ticks))
    for (mode, count), sign, beyond in ((curve.before, -1, first - ticks), (curve.after, 1, ticks - last)):
        out = beyond > 0
        if mode == "K" and len(curve.times) > 1:
            end = np.array([0 if sign < 0 else len(curve.times) - 1])
            before, after = _Keys.of([curve], second).slopes_at(end)
            raised[out] = sign * beyond[out] / second * (after if sign < 0 else before)[0]
        elif mode in ("A", "R", "M") and length >= 1 and count != 0:
            turns, rest = np.divmod(beyond[out], length)
            if count > 0:
                rest = np.where(turns >= count, length, rest)
                turns = np.minimum(turns, count - 1)
            if mode == "M":
                rest = np.where(turns % 2 == 0, length - rest, rest)
            moved[out] = first + (rest if sign > 0 else length - rest)
            if mode == "A":
                raised[out] = sign * rise * (turns + 1)
    return moved, raised


class _Keys(NamedTuple):
    """The keys of many curves in one sequence; `run` is the place of a key's attributes."""

    second: float
    times: Floats
    values: Floats
    is_first: NDArray[np.bool_]
    is_last: NDArray[np.bool_]
    run: Integers
    flags: Integers
    slopes: Floats
    weights: Floats
    bias: Floats
    firsts: Integers

    @classmethod
    def of(cls, curves: Sequence[Curve], second: float) -> _Keys:
        counts = np.array([len(curve.times) for curve in curves])
        runs = np.concatenate([curve.runs for curve in curves])
        firsts = np.cumsum(counts) - counts
        is_first, is_last = np.zeros((2, int(counts.sum())), np.bool_)
        is_first[firsts] = True
        is_last[firsts + counts - 1] = True
        return cls(
            second,
            np.concatenate([curve.times for curve in curves]).astype(np.float64),
            np.concatenate([curve.values for curve in curves]),
            is_first,
            is_last,
            np.repeat(np.arange(len(runs)), runs),
            np.concatenate([curve.flags for curve in curves]),
            np.concatenate([curve.slopes for curve in curves]),
            np.concatenate([curve.weights for curve in curves]),
            np.concatenate([curve.bias for curve in curves]),
            firsts,
        )

    def values_at(self, left: Integers, times: Floats) -> Floats:
        """Values at times that lie on the keys `left`, or between them and the next ones."""
        values: Floats = self.values[left]
        between = np.flatnonzero((times > self.times[left]).ravel())
        if len(between):
            values.reshape(-1)[between] = self._between(left.ravel()[between], times.ravel()[between])
        return values

    def _between(self, i: Integers, times: Floats) -> Floats:
        flags = self.flags[self.run[i]]
        start, end = self.values[i], self.values[i + 1]
        share = (times - self.times[i]) / (self.times[i + 1] - self.times[i])
        values: Floats = start + (end - start) * share
        constant = (flags & CONSTANT) != 0
        values[constant] = np.where(flags & TO_NEXT, end, start)[constant]
        cubic = np.flatnonzero(~constant & ((flags & CUBIC) != 0))
        if len(cubic):
            values[cubic] = self._cubic(i[cubic], share[cubic])
        return values

    def _cubic(self, i: Integers, share: Floats) -> Floats:
        length = (self.times[i + 1] - self.times[i]) / self.second
        outgoing, incoming = self.weights_at(i)[1], self.weights_at(i + 1)[0]
        u = _bezier_parameter(outgoing, 1 - incoming, share)
        v = 1 - u
        first = self.values[i] + self.slopes_at(i)[1] * outgoing * length
        second = self.values[i + 1] - self.slopes_at(i + 1)[0] * incoming * length
        return v**3 * self.values[i] + 3 * v * u * (v * first + u * second) + u**3 * self.values[i + 1]

    def weights_at(self, keys: Integers) -> tuple[Floats, Floats]:
        """Weights of the tangents before and after keys."""
        before = np.maximum(keys - 1, 0)
        curved, follows = self._is(keys, CUBIC), self._is(before, CUBIC) & ~self._is(before, TCB)
        return (
            np.where(self.is_first[keys] | ~follows, THIRD, self.weights[self.run[before], 1]),
            np.where(curved, self.weights[self.run[keys], 0], THIRD),
        )

    def slopes_at(self, keys: Integers) -> tuple[Floats, Floats]:
        """Slopes of the tangents before and after keys, in values a second."""
        before = np.maximum(keys - 1, 0)
        after = np.minimum(keys + 1, len(self.times) - 1)
        passed = np.where(self.is_first[keys], 0.0, (self.times[keys] - self.times[before]) / self.second)
        coming = np.where(self.is_last[keys], 0.0, (self.times[after] - self.times[keys]) / self.second)
        left = np.divide(self.values[keys] - self.values[before], passed, out=np.zeros(len(keys)), where=passed > 0)
        right = np.divide(self.values[after] - self.values[keys], coming, out=np.zeros(len(keys)), where=coming > 0)

        stated = self.slopes[self.run[before], 1]
        stated = np.where(self._is(before, CUBIC), np.where(self._is(before, TCB), 0.0, stated), left)
        stated = np.where(self.is_first[keys] | self._is(before, CONSTANT), 0.0, stated)
        slopes = np.stack([stated, self.slopes[self.run[keys], 0]])

        curved, tcb, user = (self._is(keys, kind) for kind in (CUBIC, TCB, USER))
        if (curved & ~tcb & ~user).any():
            bend = _Bend(passed, coming, left, right, *self.weights_at(keys), self.flags[self.run[keys]])
            slopes = np.where(curved & ~tcb & ~user, bend.slopes(*slopes), slopes)
        if (curved & tcb).any():
            (tension, continuity), bias = self.slopes[self.run[keys]].T, self.bias[self.run[keys]]
            slopes = np.where(curved & tcb, _tcb(tension, continuity, bias, passed, coming, left, right), slopes)
        slopes[1] = np.where(curved, slopes[1], np.where(self._is(keys, CONSTANT), 0.0, right))
        return slopes[0], slopes[1]

    def _is(self, keys: Integers, kind: int) -> NDArray[np.bool_]:
        """Whether keys are of a kind; a constant key is no cubic one."""
        flags = self.flags[self.run[keys]]
        found: NDArray[np.bool_] = (flags & kind) != 0
        return found if kind == CONSTANT else found & ((flags & CONSTANT) == 0)


class _Bend(NamedTuple):
    """What the slopes of `auto` keys come from: seconds and slopes to the keys before and after, weights, flags."""

    passed: Floats
    coming: Floats
    left: Floats
    right: Floats
    weight_left: Floats
    weight_right: Floats
    flags: Integers

    def slopes(self, stated_left: Floats, stated_right: Floats) -> Floats:
        """Slopes before and after (2, K). What a key states as slopes is, for an `auto` key, its bias in percent."""
        inner = (self.passed > 0) & (self.coming > 0)
        is_smooth = np.abs(stated_left + stated_right) <= _FLAT
        before = np.where(is_smooth, stated_right, -stated_left)
        at_end = self._outer(np.where(self.passed > 0, self.left, self.right),
                             np.where(self.passed > 0, -stated_left, stated_right))  # fmt: skip
        slopes = np.stack([self._inner(before), self._inner(stated_right)])
        return np.where(inner, slopes, np.where((self.passed > 0) | (self.coming > 0), at_end, 0.0))

    def _inner(self, bias: Floats) -> Floats:
        """Slopes at keys that stand between two others."""
        whole = np.maximum(self.passed + self.coming, 1e-300)
        slope = (self.left * self.passed + self.right * self.coming) / whole
        free = (self.flags & TIME_INDEPENDENT) == 0
        mixed = 0.5 * slope + 0.5 * (self.left * self.coming + self.right * self.passed) / whole
        pull = np.where(np.abs(bias) > 0.01, np.abs(bias) / 100, 0.0)
        target = np.where(bias > 0, self.right, self.left)
        away = target - mixed
        sign = np.where(np.where(np.abs(away) > 1e-5, away, bias) > 0, 1.0, -1.0)
        mixed = mixed * (1 - pull) + target * pull + 40 * sign * np.maximum(pull - 5, 0) ** 2
        slope = np.where(free, mixed, slope)

        sign = np.where(slope >= 0, 1.0, -1.0)
        limit = np.minimum(
            np.divide(sign * self.left, self.weight_left, out=np.zeros_like(slope), where=self.weight_left > 0),
            np.divide(sign * self.right, self.weight_right, out=np.zeros_like(slope), where=self.weight_right > 0),
        )
        limited = sign * np.minimum(np.abs(slope), np.maximum(limit, 0))
        slope = np.where(self.flags & CLAMP_PROGRESSIVE, limited, slope)
        is_level = ((self.flags & CLAMP) != 0) & ((self.left == 0) | (self.right == 0))
        return np.where(is_level, 0.0, slope)

    def _outer(self, slope: Floats, bias: Floats) -> Floats:
        """Slopes at first and last keys."""
        free = (self.flags & TIME_INDEPENDENT) == 0
        extra = 40 * np.where(bias > 0, 1.0, -1.0) * np.maximum(np.abs(bias) / 100 - 5, 0) ** 2
        is_level = (self.flags & CLAMP_PROGRESSIVE) != 0
        is_level |= ((self.flags & CLAMP) != 0) & (slope == 0)
        return np.where(is_level, 0.0, slope + np.where(free, extra, 0.0))


def _tcb(
    tension: Floats, continuity: Floats, bias: Floats, passed: Floats, coming: Floats, left: Floats, right: Floats
) -> Floats:
    """Slopes before and after (2, K) of keys with tension, continuity and bias (Kochanek and Bartels 1984)."""
    factor = np.where((passed > 0) & (coming > 0), 0.5, 1.0) * (1 - tension)
    before = (1 + bias) * (1 - continuity) * left + (1 - bias) * (1 + continuity) * right
    after = (1 + bias) * (1 + continuity) * left + (1 - bias) * (1 - continuity) * right
    slopes: Floats = factor * np.stack([before, after])
    return slopes


def _bezier_parameter(first: Floats, second: Floats, share: Floats) -> Floats:
    """Where on Bezier curves from 0 to 1 with two inner points the given shares of the way are; by Newton's method."""
    a, b, c = 1 + 3 * (first - second), 3 * (second - 2 * first), 3 * first
    u: Floats = share.copy()
    for _ in range(_STEPS):
        u -= (((a * u + b) * u + c) * u - share) / ((3 * a * u + 2 * b) * u + c)
    return u
