"""Weighted draws that need of their source of chance no more than `random()` in [0, 1)."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import accumulate
from typing import Protocol, TypeVar

Option = TypeVar("Option")


class RandomSource(Protocol):
    """A source of chance: `numpy.random.Generator` and `random.Random` both are."""

    def random(self) -> float: ...


def pick(rng: RandomSource, options: Sequence[Option]) -> Option:
    """One of `options`, all alike."""
    return options[int(rng.random() * len(options))]


def pick_early(rng: RandomSource, options: Sequence[Option]) -> Option:
    """One of `options`, the first ones more often: lists open with the words that most people use."""
    return options[int(len(options) * rng.random() ** 1.6)]


def pick_weighted(rng: RandomSource, options: Sequence[Option], weights: Sequence[float]) -> Option:
    """One of `options` in proportion to `weights`."""
    sums = list(accumulate(weights))
    target = rng.random() * sums[-1]
    return next((option for option, limit in zip(options, sums, strict=True) if target < limit), options[-1])
