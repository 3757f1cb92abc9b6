"""The choice of spans: the best of all paths, and poses that agree."""

from __future__ import annotations

from itertools import pairwise, product

import numpy as np

from search.compose.choosing import Edge, Joins, best_path, join_costs, refined
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


def test_a_choice_is_refined_by_what_comes_out_and_never_made_worse() -> None:
    rng = np.random.default_rng(1)

    class Table:
        """Scores of two intervals that are seen during each other."""

        seen = [[0, 1], [0, 1]]  # noqa: RUF012

        def __init__(self) -> None:
            self.scores = rng.normal(size=(2, 3, 3))

        def of(self, interval: int, choices: list[list[int]]) -> np.ndarray:
            return np.array([self.scores[interval, a, b] for a, b in choices])

    costs = [np.zeros(3), np.zeros(3)]
    for _ in range(20):
        table, joins = Table(), Joins((0, 1), rng.normal(size=3), (rng.normal(size=(3, 3)),))

        def value(a: int, b: int, table: Table = table, joins: Joins = joins) -> float:
            return table.scores[:, a, b].sum() - joins.begin[a] - joins.costs[0][a, b]

        a, b = refined([0, 0], costs, joins, table)  # type: ignore[arg-type]
        assert value(a, b) >= value(0, 0)
        assert value(a, b) == max(value(a, other) for other in range(3))
