"""The map: a library's clips as points of a plane, similar clips close together, labelled with their nearest sentence.

A sample of clips is laid out by t-SNE; every other clip is placed between the sampled ones that it is most similar to.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from search.map.tsne import tsne

Array = NDArray[np.float32]

#: Clips that are laid out by t-SNE.
_SAMPLE = 1000
_BLOCK = 4096


@dataclass(frozen=True)
class LibraryMap:
    """Clips as points.

    Attributes
    ----------
    generation : int
        Of the library.
    clips : int64 array (N,)
        Ids.
    points : float32 array (N, 2)
        0 to 1 in both directions.
    labels : tuple of str
        The most frequent first.
    label : int64 array (N,)
        The index in `labels` of each clip's nearest sentence.
    """

    generation: int
    clips: NDArray[np.int64]
    points: Array
    labels: tuple[str, ...]
    label: NDArray[np.int64]

    def document(self) -> dict[str, object]:
        """The map as JSON content."""
        return {
            "generation": self.generation,
            "clips": self.clips.tolist(),
            "x": self.points[:, 0].round(4).astype(float).round(4).tolist(),
            "y": self.points[:, 1].round(4).astype(float).round(4).tolist(),
            "labels": list(self.labels),
            "label": self.label.tolist(),
        }


def make_map(
    generation: int, clips: NDArray[np.int64], vectors: Array, texts: Sequence[str], text_vectors: Array
) -> LibraryMap:
    """The map of clips with unit vectors (N, D), labelled with the nearest of `texts`, whose vectors are (M, D)."""
    if len(clips) == 0:
        return LibraryMap(generation, clips, np.empty((0, 2), np.float32), (), np.empty(0, np.int64))
    nearest = np.concatenate(
        [(vectors[i : i + _BLOCK] @ text_vectors.T).argmax(axis=1) for i in range(0, len(vectors), _BLOCK)]
    )
    used, label, counts = np.unique(nearest, return_inverse=True, return_counts=True)
    order = np.argsort(-counts, kind="stable")
    position = np.empty(len(order), np.int64)
    position[order] = np.arange(len(order))
    labels = tuple(texts[used[i]] for i in order)
    return LibraryMap(generation, clips, lay_out(vectors), labels, position[label.reshape(-1)])


def lay_out(vectors: Array, *, sample: int = _SAMPLE, seed: int = 0) -> Array:
    """Points (N, 2), 0 to 1, of unit vectors (N, D)."""
    chosen = np.random.default_rng(seed).permutation(len(vectors))[:sample]
    landmarks = vectors[chosen].astype(np.float32)
    landmark_points = tsne(landmarks)
    points = np.empty((len(vectors), 2), np.float32)
    for first in range(0, len(vectors), _BLOCK):
        points[first : first + _BLOCK] = _interpolate(vectors[first : first + _BLOCK] @ landmarks.T, landmark_points)
    points[chosen] = landmark_points
    low, high = points.min(axis=0), points.max(axis=0)
    centre, extent = (low + high) / 2, max(float((high - low).max()), 1e-9)
    return np.asarray(0.5 + (points - centre) / extent, np.float32)


def _interpolate(similarity: Array, landmark_points: Array) -> Array:
    """Points (N, 2) from cosine similarities (N, L) to the landmarks: the weighted mean of the nearest three."""
    count = min(3, similarity.shape[1])
    nearest = np.argpartition(-similarity, count - 1, axis=1)[:, :count]
    distances = 2 - 2 * np.take_along_axis(similarity, nearest, axis=1)
    weights = 1 / np.maximum(distances, 1e-4)
    weights /= weights.sum(axis=1, keepdims=True)
    points: Array = np.einsum("nk,nkd->nd", weights, landmark_points[nearest]).astype(np.float32)
    return points
