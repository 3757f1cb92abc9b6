"""Slopes of the tangents of keys that do not state them: `auto` keys, and those of tension, continuity and bias.

How the slopes of `auto` keys come about is as ufbx (version 0.21), and with it the FBX SDK, has it.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from indexer.formats.fbx.animation_curves import CLAMP, CLAMP_PROGRESSIVE, TIME_INDEPENDENT

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]

_FLAT = 1e-4  # the slopes of a key below which it has no bias


class AutoSlopes(NamedTuple):
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
        is_smooth = np.abs(stated_left + stated_right) <= _FLAT
        after = self._inner(stated_right)
        before = after if is_smooth.all() else self._inner(np.where(is_smooth, stated_right, -stated_left))
        slopes = np.stack([before, after])
        rows = np.flatnonzero((self.passed <= 0) | (self.coming <= 0))
        slopes[:, rows] = self._of(rows)._outer(stated_left[rows], stated_right[rows])
        return slopes

    def _of(self, rows: Integers) -> AutoSlopes:
        return AutoSlopes._make(values[rows] for values in self)

    def _inner(self, bias: Floats) -> Floats:
        """Slopes at keys that stand between two others."""
        whole = np.maximum(self.passed + self.coming, 1e-300)
        slope: Floats = (self.left * self.passed + self.right * self.coming) / whole
        mixed = 0.5 * slope + 0.5 * (self.left * self.coming + self.right * self.passed) / whole
        rows = np.flatnonzero(np.abs(bias) > 0.01)
        mixed[rows] = self._of(rows)._pulled(mixed[rows], bias[rows])
        slope = np.where(self.flags & TIME_INDEPENDENT, slope, mixed)
        rows = np.flatnonzero(self.flags & CLAMP_PROGRESSIVE)
        slope[rows] = self._of(rows)._limited(slope[rows])
        rows = np.flatnonzero(self.flags & CLAMP)
        slope[rows[(self.left[rows] == 0) | (self.right[rows] == 0)]] = 0
        return slope

    def _pulled(self, mixed: Floats, bias: Floats) -> Floats:
        """Slopes drawn by a bias towards that of one side."""
        pull = np.abs(bias) / 100
        target = np.where(bias > 0, self.right, self.left)
        away = target - mixed
        sign = np.where(np.where(np.abs(away) > 1e-5, away, bias) > 0, 1.0, -1.0)
        pulled: Floats = mixed * (1 - pull) + target * pull + 40 * sign * np.maximum(pull - 5, 0) ** 2
        return pulled

    def _limited(self, slope: Floats) -> Floats:
        """Slopes such that the curve does not swing over its keys."""
        sign = np.where(slope >= 0, 1.0, -1.0)
        limit = np.minimum(
            np.divide(sign * self.left, self.weight_left, out=np.zeros_like(slope), where=self.weight_left > 0),
            np.divide(sign * self.right, self.weight_right, out=np.zeros_like(slope), where=self.weight_right > 0),
        )
        limited: Floats = sign * np.minimum(np.abs(slope), np.maximum(limit, 0))
        return limited

    def _outer(self, stated_left: Floats, stated_right: Floats) -> Floats:
        """Slopes at first and last keys."""
        slope = np.where(self.passed > 0, self.left, self.right)
        bias = np.where(self.passed > 0, -stated_left, stated_right)
        free = (self.flags & TIME_INDEPENDENT) == 0
        extra = 40 * np.where(bias > 0, 1.0, -1.0) * np.maximum(np.abs(bias) / 100 - 5, 0) ** 2
        is_level = (self.flags & CLAMP_PROGRESSIVE) != 0
        is_level |= ((self.flags & CLAMP) != 0) & (slope == 0)
        is_level |= (self.passed <= 0) & (self.coming <= 0)
        return np.where(is_level, 0.0, slope + np.where(free, extra, 0.0))


def tcb_slopes(
    tension: Floats, continuity: Floats, bias: Floats, passed: Floats, coming: Floats, left: Floats, right: Floats
) -> Floats:
    """Slopes before and after (2, K) of keys with tension, continuity and bias (Kochanek and Bartels 1984)."""
    factor = np.where((passed > 0) & (coming > 0), 0.5, 1.0) * (1 - tension)
    before = (1 + bias) * (1 - continuity) * left + (1 - bias) * (1 + continuity) * right
    after = (1 + bias) * (1 + continuity) * left + (1 - bias) * (1 - continuity) * right
    slopes: Floats = factor * np.stack([before, after])
    return slopes
