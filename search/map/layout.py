"""The map: a library's clips as points of a plane, similar clips close together, labelled with their nearest sentence.

A sample of clips is laid out by t-SNE, by openTSNE where it is installed (extra `map`), which takes a larger sample;
every other clip is placed between the sampled ones that it is most similar to.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from importlib.util import find_spec

import numpy as np
from numpy.typing import NDArray

from search.map.tsne import open_tsne, tsne

Array = NDArray[np.float32]

#: Clips that are laid out by t-SNE: by our own, which is quadratic, and by openTSNE (Poličar et al., 2024).
_SAMPLE, _LARGE_SAMPLE = 1000, 20_000
_BLOCK = 4096
#: Similarities to landmarks that are held at once.
_HELD = 4_000_000
#: The part of the work that is done when the sample is laid out, for progress.
_LAID_OUT = 0.9

Progress = Callable[[float], None]


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
    generation: int,
    clips: NDArray[np.int64],
    vectors: Array,
    texts: Sequence[str],
    text_vectors: Array,
    progress: Progress = lambda _: None,
) -> LibraryMap:
    """The map of clips with unit vectors (N, D), labelled with the nearest of `texts`, whose vectors are (M, D).

    `progress` is called with the part of the work that is done, 0 to 1.
    """
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
    return LibraryMap(generation, clips, lay_out(vectors, progress=progress), labels, position[label.reshape(-1)])


def lay_out(
    vectors: Array,
    *,
    sample: int | None = None,
    seed: int = 0,
    library: bool | None = None,
    progress: Progress = lambda _: None,
) -> Array:
    """Points (N, 2), 0 to 1, of unit vectors (N, D).

    `library`: by openTSNE, by default where it is installed and worth it.
    """
    if library is None:  # a small one is laid out faster by our own
        library = len(vectors) > _SAMPLE and find_spec("openTSNE") is not None
    chosen = np.random.default_rng(seed).permutation(len(vectors))[: sample or (_LARGE_SAMPLE if library else _SAMPLE)]
    landmarks = vectors[chosen].astype(np.float32)

    def laid_out(part: float) -> None:
        progress(_LAID_OUT * part)

    landmark_points = (open_tsne if library else tsne)(landmarks, progress=laid_out)
    points = np.empty((len(vectors), 2), np.float32)
    block = max(_HELD // len(landmarks), 1)
    for first in range(0, len(vectors), block):
        progress(_LAID_OUT + (1 - _LAID_OUT) * first / len(vectors))
        points[first : first + block] = _interpolate(vectors[first : first + block] @ landmarks.T, landmark_points)
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
