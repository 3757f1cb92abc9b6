"""The dissimilar subset: as far apart as can be, and the same every time."""

from __future__ import annotations

from itertools import combinations

import numpy as np
import pytest

from search.evaluate.retrieval.dissimilar_subset import dissimilar_subset


def unit(seed: int, count: int, size: int = 6) -> np.ndarray:
    vectors = np.random.default_rng(seed).normal(size=(count, size))
    return vectors / np.linalg.norm(vectors, axis=1, keepdims=True)


def cost(vectors: np.ndarray, chosen: np.ndarray) -> float:
    similarity = vectors[chosen] @ vectors[chosen].T
    return float(similarity.sum() - np.trace(similarity)) / 2


@pytest.mark.parametrize("seed", range(8))
def test_no_exchange_is_better_and_the_best_of_all_choices_is_near(seed: int) -> None:
    vectors = unit(seed, 14)
    captions = [str(i) for i in range(14)]
    chosen = dissimilar_subset(vectors, captions, 4)
    assert chosen.tolist() == sorted(set(chosen.tolist()))
    found = cost(vectors, chosen)
    for out in chosen:
        for into in set(range(14)) - set(chosen.tolist()):
            assert cost(vectors, np.array([*(set(chosen) - {out}), into])) >= found - 1e-6
    costs = np.sort([cost(vectors, np.array(some)) for some in combinations(range(14), 4)])
    assert np.searchsorted(costs, found - 1e-9) < 0.02 * len(costs), "among the best fiftieth of all choices"


def test_of_equal_captions_the_first_counts() -> None:
    vectors = unit(0, 5)[[0, 1, 1, 2, 3, 4]]
    captions = ["a", "b", "b", "c", "d", "e"]
    assert 2 not in dissimilar_subset(vectors, captions, 4)
    assert dissimilar_subset(vectors, captions).tolist() == [0, 1, 3, 4, 5], "fewer than asked for: all distinct ones"


def test_it_is_far_further_apart_than_a_random_one_and_quick_at_full_size() -> None:
    vectors = unit(1, 2000, 32)
    captions = [str(i) for i in range(len(vectors))]
    chosen = dissimilar_subset(vectors, captions, 100)
    assert len(chosen) == 100
    assert np.array_equal(chosen, dissimilar_subset(vectors, captions, 100))
    random = [cost(vectors, np.random.default_rng(i).choice(2000, 100, replace=False)) for i in range(20)]
    assert cost(vectors, chosen) < min(random)
