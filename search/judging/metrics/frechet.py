"""The Frechet distance between two sets of vectors, each taken for a Gaussian (FID)."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]


def frechet_distance(generated: ArrayLike, real: ArrayLike) -> float:
    """|m1 - m2|^2 + Tr(C1 + C2 - 2 (C1 C2)^(1/2)) of the means m and covariances C (over N - 1) of two sets.

    Heusel et al., "GANs Trained by a Two Time-Scale Update Rule Converge to a Local Nash Equilibrium" (NeurIPS 2017),
    eq. 6; for motion since Guo et al., "Action2Motion" (ACM MM 2020). WAT's published code takes uncentred second
    moments for covariances: its figures are of another scale.

    Parameters
    ----------
    generated, real : array (N, D), (M, D)
        At least two vectors each. With fewer vectors than dimensions the covariance is singular, which is no trouble
        here, and the distance is biased upwards: compare only sets of equal sizes.

    Raises
    ------
    ValueError
        If shapes do not fit, a set has fewer than two vectors, or a number is not finite.
    """
    a, b = (_checked(vectors) for vectors in (generated, real))
    if a.shape[1] != b.shape[1]:
        raise ValueError(f"vectors of {a.shape[1]} and of {b.shape[1]} numbers cannot be compared")
    return gaussian_distance(a.mean(0), np.cov(a, rowvar=False).reshape(a.shape[1], -1),
                             b.mean(0), np.cov(b, rowvar=False).reshape(b.shape[1], -1))  # fmt: skip


def gaussian_distance(mean1: ArrayLike, covariance1: ArrayLike, mean2: ArrayLike, covariance2: ArrayLike) -> float:
    """The same of two Gaussians: means (D,) and covariances (D, D).

    The trace of (C1 C2)^(1/2) is the sum of the singular values of C1^(1/2) C2^(1/2), with square roots by
    eigen-decomposition: no root of a product that is not symmetric, hence no imaginary part to drop.
    """
    apart = np.asarray(mean1, np.float64) - np.asarray(mean2, np.float64)
    c1, c2 = np.asarray(covariance1, np.float64), np.asarray(covariance2, np.float64)
    overlap = np.linalg.svd(square_root(c1) @ square_root(c2), compute_uv=False).sum()
    return max(float(apart @ apart + np.trace(c1) + np.trace(c2) - 2 * overlap), 0.0)


def square_root(matrix: Array) -> Array:
    """The symmetric square root of a symmetric matrix (D, D) without negative eigenvalues but for rounding."""
    values, vectors = np.linalg.eigh((matrix + matrix.T) / 2)
    root: Array = (vectors * np.sqrt(np.maximum(values, 0))) @ vectors.T
    return root


def _checked(vectors: ArrayLike) -> Array:
    array = np.asarray(vectors, np.float64)
    if array.ndim != 2 or len(array) < 2:
        raise ValueError(f"vectors {array.shape} must be (N, D) with N >= 2")
    if not np.isfinite(array).all():
        raise ValueError("vectors must be finite")
    return array
