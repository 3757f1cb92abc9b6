"""A varied choice of clips."""

from __future__ import annotations

import numpy as np

from search.ranking.variety import varied


def _crowds(sizes: list[int]) -> tuple[np.ndarray, np.ndarray]:
    """Unit vectors around directions at right angles to each other, and which direction each is near."""
    rng = np.random.default_rng(3)
    kinds = np.repeat(np.arange(len(sizes)), sizes)
    vectors = np.eye(32)[kinds] + 0.05 * rng.normal(size=(len(kinds), 32))
    return (vectors / np.linalg.norm(vectors, axis=1, keepdims=True)).astype(np.float16), kinds


def test_a_few_of_a_crowded_archive_show_all_its_kinds():
    vectors, kinds = _crowds([300, 40, 40, 40, 40, 40])
    for seed in range(10):
        assert len(set(kinds[varied(vectors, seed)[:9]])) == 6
    at_random = [len(set(kinds[np.random.default_rng(seed).permutation(500)[:9]])) for seed in range(10)]
    assert np.mean(at_random) < 5


def test_every_clip_comes_once_and_each_seed_has_its_own_order():
    vectors, _ = _crowds([700, 300])
    orders = [varied(vectors, seed) for seed in (1, 1, 2)]
    assert all(sorted(order) == list(range(1000)) for order in orders)
    assert (orders[0] == orders[1]).all()
    assert (orders[0] != orders[2]).any()
    assert varied(vectors[:1], 0).tolist() == [0]
    assert varied(vectors[:0], 0).tolist() == []
