"""The Frechet distance against closed forms."""

import numpy as np
import pytest

from search.judging.metrics.frechet import frechet_distance, gaussian_distance, square_root


def test_one_dimension_by_hand() -> None:
    # Means 1 and 5, variances 2 and 8: 16 + 2 + 8 - 2 * sqrt(16).
    assert frechet_distance([[0.0], [2.0]], [[3.0], [7.0]]) == pytest.approx(18.0)


def test_covariances_along_the_axes_differ_by_their_deviations() -> None:
    means = np.array([1.0, 0.0, -2.0]), np.array([0.0, 0.0, 0.0])
    distance = gaussian_distance(means[0], np.diag([1.0, 4.0, 9.0]), means[1], np.diag([4.0, 0.0, 1.0]))
    assert distance == pytest.approx(5.0 + (1 - 2) ** 2 + 2**2 + (3 - 1) ** 2)


def test_covariances_that_do_not_commute() -> None:
    # Of 2 x 2 matrices the trace of a root is sqrt(trace + 2 sqrt(determinant)).
    c1, c2 = np.array([[2.0, 1.0], [1.0, 3.0]]), np.array([[4.0, -1.0], [-1.0, 1.0]])
    product = c1 @ c2
    root = np.sqrt(np.trace(product) + 2 * np.sqrt(np.linalg.det(product)))
    assert gaussian_distance([0, 0], c1, [0, 0], c2) == pytest.approx(np.trace(c1) + np.trace(c2) - 2 * root)


def test_a_set_has_no_distance_to_itself_with_fewer_vectors_than_dimensions() -> None:
    few = np.random.default_rng(0).normal(size=(60, 256))
    assert frechet_distance(few, few) == pytest.approx(0, abs=1e-6)
    assert frechet_distance(few, few + 0.5) == pytest.approx(0.25 * 256, rel=1e-6)


def test_a_root_squares_to_its_matrix() -> None:
    factor = np.random.default_rng(1).normal(size=(5, 8))
    matrix = factor.T @ factor  # of rank 5
    root = square_root(matrix)
    assert np.allclose(root @ root, matrix)
    assert np.allclose(root, root.T)


@pytest.mark.parametrize(
    ("generated", "message"),
    [(np.zeros((1, 2)), "N >= 2"), (np.full((3, 2), np.nan), "finite"), (np.zeros((3, 4)), "cannot be compared")],
)
def test_what_cannot_be_compared_is_refused(generated: np.ndarray, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        frechet_distance(generated, np.zeros((3, 2)))
