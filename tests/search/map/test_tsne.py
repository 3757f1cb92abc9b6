"""Exact t-SNE, and the neighbours that openTSNE is given."""

from __future__ import annotations

import numpy as np
import pytest

from search.map.tsne import neighbours, tsne


def test_clusters_stay_apart() -> None:
    rng = np.random.default_rng(0)
    cluster = np.repeat(np.arange(4), 15)
    vectors = rng.standard_normal((4, 32))[cluster] + 0.2 * rng.standard_normal((60, 32))
    points = tsne((vectors / np.linalg.norm(vectors, axis=1, keepdims=True)).astype(np.float32))
    means = np.stack([points[cluster == i].mean(axis=0) for i in range(4)])
    nearest = ((points[:, None] - means) ** 2).sum(axis=-1).argmin(axis=1)
    assert (nearest == cluster).all()


@pytest.mark.parametrize("count", [1, 2, 3, 4, 5])
def test_few_vectors_have_points_too(count: int) -> None:
    points = tsne(np.eye(count, 16, dtype=np.float32))
    assert points.shape == (count, 2)
    assert np.isfinite(points).all()


def test_neighbours_are_the_nearest_of_all_with_their_distances() -> None:
    vectors = np.random.default_rng(0).standard_normal((700, 8)).astype(np.float32)
    vectors /= np.linalg.norm(vectors, axis=1, keepdims=True)
    told: list[float] = []
    found, distances = neighbours(vectors, 12, told.append)
    for i in (0, 511, 512, 699):
        away = np.linalg.norm(vectors - vectors[i], axis=1)
        away[i] = np.inf
        assert set(found[i]) == set(np.argsort(away)[:12])
        np.testing.assert_allclose(distances[i], np.sort(away)[:12], atol=1e-3)
    assert len(told) == 2
