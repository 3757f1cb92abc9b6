"""The choice of spans: the best of all paths, and poses that agree."""

from __future__ import annotations

from itertools import pairwise, product

import numpy as np

from search.compose.choosing import Edge, best_path, join_costs
from tests.search.conftest import made_motion


def test_the_path_is_the_best_of_all() -> None:
    rng = np.random.default_rng(0)
    for _ in range(20):
        sizes = rng.integers(1, 5, size=4)
        fits = [rng.normal(size=n) for n in sizes]
        joins = [rng.normal(size=(a, b)) for a, b in pairwise(sizes)]

        def value(path: tuple[int, ...], fits: list = fits, joins: list = joins) -> float:
            gained = sum(fit[i] for fit, i in zip(fits, path, strict=True))
            return gained - sum(join[a, b] for join, a, b in zip(joins, path, path[1:], strict=False))

        best = max(product(*(range(n) for n in sizes)), key=value)
        assert tuple(best_path(fits, joins)) == best


def test_poses_that_agree_cost_nothing_wherever_they_are_and_face() -> None:
    frames = made_motion(2, 1).joints[[10, 13]].astype(np.float64)
    angle = 1.2
    turn = np.array([[np.cos(angle), 0, np.sin(angle)], [0, 1, 0], [-np.sin(angle), 0, np.cos(angle)]])
    elsewhere = frames @ turn.T + np.array([3.0, 0.0, -2.0])
    other = made_motion(2, 5).joints[[20, 23]].astype(np.float64)
    edges = [Edge.of(place, 0, 0.15) for place in (frames, elsewhere, other)]
    costs = join_costs(edges[:1], edges)[0]
    assert costs[0] == 0
    assert costs[1] < 1e-9
    assert costs[2] > 0.01
