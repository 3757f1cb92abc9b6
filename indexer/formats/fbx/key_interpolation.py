"""Values of animation curves at given times.

Between two keys a curve stays, goes straight, or follows a cubic Bezier in time and value. A tangent has a slope, and a
weight: the share of the interval along which it pulls, a third unless stated.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from indexer.formats.fbx.animation_curves import (
    CONSTANT,
    CUBIC,
    TCB,
    THIRD,
    TO_NEXT,
    USER,
    Curve,
)  # fmt: skip
from indexer.formats.fbx.tangent_slopes import AutoSlopes, tcb_slopes

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]

_STEPS = 10  # of Newton's method
_ON_KEY = 2.0  # ticks from a key within which a time is that of the key, which programs round up or down


def sample(curves: Sequence[Curve], ticks: Floats, second: float) -> Floats:
    """Values (C, T) of curves at times (T,) in ticks, of which a second has so many."""
    values = np.empty((len(curves), len(ticks)))
    raised: dict[int, Floats] = {}
    known: dict[int, _Places] = {}  # curves often share the times of their keys
    bent: list[tuple[int, _Places]] = []
    for i, curve in enumerate(curves):
        if curve.is_still:
            values[i] = curve.values[0]
            continue
        if curve.stays and curve.attributes.is_straight:
            values[i] = np.interp(ticks, curve.times, curve.values)
            continue
        if curve.stays:
            if id(curve.times) not in known:
                known[id(curve.times)] = _Places.of(curve, ticks)
            places = known[id(curve.times)]
        else:
            inside, raised[i] = _extrapolated(curve, ticks, second)
            places = _Places.of(curve, inside)
        if curve.attributes.is_straight:
            values[i] = np.interp(places.inside, places.keys, curve.values)
            continue
        values[i] = curve.values[places.left]
        if len(places.between):
            bent.append((i, places))
    if bent:
        keys = _Keys.of([curves[i] for i, _ in bent], second)
        left = np.concatenate([p.left[p.between] + first for (_, p), first in zip(bent, keys.firsts, strict=True)])
        between = keys.between(left, np.concatenate([places.inside[places.between] for _, places in bent]))
        ends = np.cumsum([len(places.between) for _, places in bent])
        for (i, places), found in zip(bent, np.split(between, ends[:-1]), strict=True):
            values[i, places.between] = found
    for i, offsets in raised.items():
        values[i] += offsets
    return values


class _Places(NamedTuple):
    """Where times (T,) lie among the keys (K,) of a curve: the key at or before each; which are between two keys."""

    keys: Floats
    inside: Floats
    left: Integers
    between: Integers

    @classmethod
    def of(cls, curve: Curve, ticks: Floats) -> _Places:
        inside = np.clip(ticks, curve.times[0], curve.times[-1])
        keys = curve.times.astype(np.float64)
        left = np.maximum(np.searchsorted(keys, inside + _ON_KEY, side="right") - 1, 0)
        return cls(keys, inside, left, np.flatnonzero(inside - keys[left] > _ON_KEY))


def _extrapolated(curve: Curve, ticks: Floats, second: float) -> tuple[Floats, Floats]:
    """Times (T,) within the keys that stand for given ones, and what is to be added to the values there."""
    first, last = float(curve.times[0]), float(curve.times[-1])
    length, rise = last - first, float(curve.values[-1] - curve.values[0])
    moved, raised = ticks.copy(), np.zeros(len(ticks))
    for (mode, count), sign, beyond in ((curve.before, -1, first - ticks), (curve.after, 1, ticks - last)):
        out = beyond > 0
        if mode == "K" and len(curve.times) > 1:
            before, after = _Keys.of([curve], second).slopes()
            raised[out] = sign * beyond[out] / second * (after[0] if sign < 0 else before[-1])
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
    """The keys (K,) of many curves in one sequence, and where each curve begins (C,)."""

    second: float
    times: Floats
    values: Floats
    flags: Integers
    stated: Floats
    weights: Floats
    bias: Floats
    is_first: NDArray[np.bool_]
    is_last: NDArray[np.bool_]
    firsts: Integers

    @classmethod
    def of(cls, curves: Sequence[Curve], second: float) -> _Keys:
        counts = np.array([len(curve.times) for curve in curves])
        firsts = np.cumsum(counts) - counts
        parts = zip(*(curve.attributes[:5] for curve in curves), strict=True)
        runs, *attributes = (np.concatenate(part) for part in parts)
        run = np.repeat(np.arange(len(runs)), runs)  # of each key, what is said of its run
        flags, stated, weights, bias = (part if len(run) == len(runs) else part[run] for part in attributes)
        is_first, is_last = np.zeros((2, int(counts.sum())), np.bool_)
        is_first[firsts] = True
        is_last[firsts + counts - 1] = True
        times = np.concatenate([curve.times for curve in curves]).astype(np.float64)
        values = np.concatenate([curve.values for curve in curves])
        return cls(second, times, values, flags, stated, weights, bias, is_first, is_last, firsts)

    def between(self, i: Integers, times: Floats) -> Floats:
        """Values at times that lie between the keys `i` and the next ones."""
        flags = self.flags[i]
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
        (before, after), (incoming, outgoing) = self.slopes(), self.sides()
        incoming, outgoing = incoming[i + 1], outgoing[i]
        length = (self.times[i + 1] - self.times[i]) / self.second
        weighted = np.flatnonzero((incoming != THIRD) | (outgoing != THIRD))
        u = share.copy()
        u[weighted] = _bezier_parameter(outgoing[weighted], 1 - incoming[weighted], share[weighted])
        v = 1 - u
        start, end = self.values[i], self.values[i + 1]
        first, second = start + after[i] * outgoing * length, end - before[i + 1] * incoming * length
        values: Floats = v * v * v * start + 3 * v * u * (v * first + u * second) + u * u * u * end
        return values

    def sides(self) -> tuple[Floats, Floats]:
        """Weights of the tangents before and after all keys."""
        curved = self._are(CUBIC)
        follows = ~self.is_first & _previous(curved & ~self._are(TCB))
        return (
            np.where(follows, _previous(self.weights[:, 1]), THIRD),
            np.where(curved, self.weights[:, 0], THIRD),
        )

    def slopes(self) -> tuple[Floats, Floats]:
        """Slopes of the tangents before and after all keys, in values a second."""
        step, rise = np.diff(self.times, append=self.times[-1]) / self.second, np.diff(self.values, append=0)
        coming = np.where(self.is_last, 0.0, step)
        passed = np.where(self.is_first, 0.0, _previous(step))
        right = np.divide(rise, coming, out=np.zeros(len(rise)), where=coming > 0)
        left = np.where(self.is_first, 0.0, _previous(right))

        constant, curved, tcb, user = (self._are(kind) for kind in (CONSTANT, CUBIC, TCB, USER))
        stated = np.where(curved, np.where(tcb, 0.0, self.stated[:, 1]), np.where(constant, 0.0, right))
        slopes = np.stack([np.where(self.is_first, 0.0, _previous(stated)), self.stated[:, 0]])
        is_auto = curved & ~tcb & ~user
        if is_auto.any():
            bend = AutoSlopes(passed, coming, left, right, *self.sides(), self.flags)
            slopes = np.where(is_auto, bend.slopes(*slopes), slopes)
        if (curved & tcb).any():
            tension, continuity = self.stated.T
            slopes = np.where(
                curved & tcb, tcb_slopes(tension, continuity, self.bias, passed, coming, left, right), slopes
            )
        slopes[1] = np.where(curved, slopes[1], np.where(constant, 0.0, right))
        return slopes[0], slopes[1]

    def _are(self, kind: int) -> NDArray[np.bool_]:
        """Which keys are of a kind; a constant key is no cubic one."""
        found: NDArray[np.bool_] = (self.flags & kind) != 0
        return found if kind == CONSTANT else found & ((self.flags & CONSTANT) == 0)


def _previous(values: NDArray[Any]) -> NDArray[Any]:
    """Of each key what belongs to the key before."""
    return np.concatenate([values[:1], values[:-1]])


def _bezier_parameter(first: Floats, second: Floats, share: Floats) -> Floats:
    """Where on Bezier curves from 0 to 1 with two inner points the given shares of the way are; by Newton's method."""
    a, b, c = 1 + 3 * (first - second), 3 * (second - 2 * first), 3 * first
    u: Floats = share.copy()
    for _ in range(_STEPS):
        u -= (((a * u + b) * u + c) * u - share) / ((3 * a * u + 2 * b) * u + c)
    return u
