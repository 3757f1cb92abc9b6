"""Sequences: steps are found in order, with the spans that add up to most."""

from __future__ import annotations

import itertools

import numpy as np
import pytest

from search.moments.sequences import GAP_COST, MAX_GAP_COST, consecutive_spans, find_sequence, windows_in_order
from search.spans import temporal_iou
from tests.search.fakes import queried, take


def test_the_chain_is_the_best_of_all_that_keep_the_order() -> None:
    rng = np.random.default_rng(1)
    starts = rng.uniform(0, 10, 24)
    ends = starts + rng.uniform(0.5, 3, 24)
    scores = rng.normal(size=(3, 24))

    def value(chain: tuple[int, ...]) -> float:
        gaps = (starts[b] - ends[a] for a, b in itertools.pairwise(chain))
        cost = sum(min(GAP_COST * gap, MAX_GAP_COST) for gap in gaps)
        return float(sum(scores[step, i] for step, i in enumerate(chain)) - cost)

    legal = [
        chain
        for chain in itertools.permutations(range(24), 3)
        if all(ends[a] <= starts[b] for a, b in itertools.pairwise(chain))
    ]
    found = windows_in_order(starts, ends, scores)
    assert found is not None
    assert tuple(found[0]) == max(legal, key=value)
    assert found[1] == pytest.approx(max(map(value, legal)))


def test_no_chain_where_no_window_follows_another() -> None:
    assert windows_in_order(np.array([0.0, 1.0]), np.array([5.0, 6.0]), np.ones((2, 2))) is None


def test_steps_are_found_in_order_even_where_each_alone_fits_better_elsewhere() -> None:
    features = take(60, (5, 8, 2), (20, 23, 1), (24, 27, 2), (27.5, 31, 3), (50, 53, 3))
    features[50:80, 2] += 1  # the second step is clearest before the first
    found = find_sequence(queried(features, 1, 2, 3))
    truth = [(20, 23), (24, 27), (27.5, 31)]
    assert all(temporal_iou([m.start], [m.end], a, b)[0] > 0.7 for m, (a, b) in zip(found, truth, strict=True))
    assert all(before.end <= after.start for before, after in itertools.pairwise(found))


def test_no_chain_in_a_take_too_short_for_it() -> None:
    assert find_sequence(queried(take(1.2), 1, 2, 3)) == []


def _brute(rows: np.ndarray) -> float:
    count, frames = rows.shape
    cuts = itertools.combinations_with_replacement(range(frames + 1), 2 * count)
    spans = (list(zip(cut[::2], cut[1::2], strict=True)) for cut in cuts)
    return max(
        sum(row[a:b].sum() for row, (a, b) in zip(rows, chain, strict=True))
        for chain in spans
        if all(a < b for a, b in chain)
    )


@pytest.mark.parametrize("count", [1, 2, 3])
@pytest.mark.parametrize("seed", range(5))
def test_the_spans_add_up_to_most_of_all_in_order(count: int, seed: int) -> None:
    rows = np.random.default_rng(seed).normal(size=(count, 8))
    found = consecutive_spans(list(rows))
    assert sum(row[a:b].sum() for row, (a, b) in zip(rows, found, strict=True)) == pytest.approx(_brute(rows))
    assert all(0 <= a < b <= 8 for a, b in found)
    assert all(before[1] <= after[0] for before, after in itertools.pairwise(found))


def test_spans_have_a_least_length_where_there_is_room() -> None:
    gain = -np.ones((2, 20))
    assert all(b - a == 5 for a, b in consecutive_spans(list(gain), 5))
    assert all(b - a == 10 for a, b in consecutive_spans(list(gain), 50))
