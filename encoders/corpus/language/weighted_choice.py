"""Weighted random choice, from any source of uniform numbers in [0, 1)."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import accumulate
from typing import Protocol, TypeVar

Option = TypeVar("Option")


class RandomSource(Protocol):
    """A source of uniform numbers in [0, 1): `numpy.random.Generator` and `random.Random` both are."""

    def random(self) -> float: ...


def pick(rng: RandomSource, options: Sequence[Option]) -> Option:
    """One of `options`, all with equal probability."""
    return options[int(rng.random() * len(options))]


def pick_early(rng: RandomSource, options: Sequence[Option]) -> Option:
    """One of `options`, the first ones more often: phrase lists start with the commonest."""
    return options[int(len(options) * rng.random() ** 1.6)]


def pick_weighted(rng: RandomSource, options: Sequence[Option], weights: Sequence[float]) -> Option:
    """One of `options` in proportion to `weights`."""
    sums = list(accumulate(weights))
    target = rng.random() * sums[-1]
    return next((option for option, limit in zip(options, sums, strict=True) if target < limit), options[-1])
