"""The map: a library's clips as points of a plane, near where they are alike, each with what it looks like most.

A sample of clips is laid out by t-SNE (van der Maaten and Hinton, 2008; exact, begun from the two principal axes), and
every other clip goes between the sampled ones it is most like.
"""

from __future__ import annotations

import json
import os
import tempfile
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float32]

#: Clips that are laid out against each other.
_SAMPLE = 1000
_PERPLEXITY = 20.0
_ROUNDS = 350
_BLOCK = 4096


@dataclass(frozen=True)
class Map:
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
        Which of the labels each clip is nearest to.
    """

    generation: int
    clips: NDArray[np.int64]
    points: Array
    labels: tuple[str, ...]
    label: NDArray[np.int64]

    def document(self) -> dict[str, object]:
        """As the server writes it."""
        return {
            "generation": self.generation,
            "clips": self.clips.tolist(),
            "x": self.points[:, 0].round(4).astype(float).round(4).tolist(),
            "y": self.points[:, 1].round(4).astype(float).round(4).tolist(),
            "labels": list(self.labels),
            "label": self.label.tolist(),
        }


def make(generation: int, clips: NDArray[np.int64], vectors: Array, texts: Sequence[str], text_vectors: Array) -> Map:
    """The map of clips with unit vectors (N, D), labelled with the nearest of `texts`, whose vectors are (M, D)."""
    if len(clips) == 0:
        return Map(generation, clips, np.empty((0, 2), np.float32), (), np.empty(0, np.int64))
    nearest = np.concatenate(
        [(vectors[i : i + _BLOCK] @ text_vectors.T).argmax(axis=1) for i in range(0, len(vectors), _BLOCK)]
    )
    used, label, counts = np.unique(nearest, return_inverse=True, return_counts=True)
    order = np.argsort(-counts, kind="stable")
    place = np.empty(len(order), np.int64)
    place[order] = np.arange(len(order))
    return Map(generation, clips, lay_out(vectors), tuple(texts[used[i]] for i in order), place[label.reshape(-1)])


def lay_out(vectors: Array, *, sample: int = _SAMPLE, seed: int = 0) -> Array:
    """Points (N, 2), 0 to 1, of unit vectors (N, D)."""
    chosen = np.random.default_rng(seed).permutation(len(vectors))[:sample]
    landmarks = vectors[chosen].astype(np.float32)
    placed = _tsne(landmarks)
    points = np.empty((len(vectors), 2), np.float32)
    for first in range(0, len(vectors), _BLOCK):
        points[first : first + _BLOCK] = _between(vectors[first : first + _BLOCK] @ landmarks.T, placed)
    points[chosen] = placed
    low, high = points.min(axis=0), points.max(axis=0)
    centre, reach = (low + high) / 2, max(float((high - low).max()), 1e-9)
    return np.asarray(0.5 + (points - centre) / reach, np.float32)


def _between(similarity: Array, placed: Array) -> Array:
    """Where vectors lie whose similarities to the landmarks are (N, L): the weighted middle of the nearest three."""
    count = min(3, similarity.shape[1])
    nearest = np.argpartition(-similarity, count - 1, axis=1)[:, :count]
    far = 2 - 2 * np.take_along_axis(similarity, nearest, axis=1)
    weights = 1 / np.maximum(far, 1e-4)
    weights /= weights.sum(axis=1, keepdims=True)
    middle: Array = np.einsum("nk,nkd->nd", weights, placed[nearest]).astype(np.float32)
    return middle


def _tsne(vectors: Array) -> Array:
    """Exact t-SNE of unit vectors (L, D), L up to a few thousand."""
    count = len(vectors)
    points = _principal(vectors)
    if count < 4:
        return points
    p = _affinities(2 - 2 * vectors @ vectors.T, min(_PERPLEXITY, (count - 1) / 3))
    points *= 1e-2 / max(float(points.std()), 1e-9)
    speed, gain = np.zeros_like(points), np.ones_like(points)
    rate = max(count / 12, 20.0)
    for round_ in range(_ROUNDS):
        early = round_ < _ROUNDS // 4
        slope = _gradient(p * 12 if early else p, points)
        gain = np.clip(np.where(np.sign(slope) != np.sign(speed), gain + 0.2, gain * 0.8), 0.01, None)
        speed = (0.5 if early else 0.8) * speed - rate * gain * slope
        points = points + speed
        points -= points.mean(axis=0)
    return np.asarray(points, np.float32)


def _gradient(p: Array, points: Array) -> Array:
    squares = (points**2).sum(axis=1)
    near = 1 / (1 + np.maximum(squares[:, None] + squares - 2 * points @ points.T, 0))
    np.fill_diagonal(near, 0)
    pull = (p - near / near.sum()) * near
    slope: Array = 4 * (pull.sum(axis=1)[:, None] * points - pull @ points)
    return slope


def _affinities(distances: Array, perplexity: float) -> Array:
    """Joint probabilities (L, L) of squared distances, each row's width found by bisection on its entropy."""
    distances = np.maximum(distances, 0)
    np.fill_diagonal(distances, np.inf)
    low, high = np.zeros(len(distances)), np.full(len(distances), np.inf)
    beta = np.ones(len(distances))
    least = distances.min(axis=1, keepdims=True)
    for _ in range(40):
        p = np.exp(-(distances - least) * beta[:, None])
        p /= p.sum(axis=1, keepdims=True)
        entropy = -(p * np.log(np.maximum(p, 1e-12))).sum(axis=1)
        wide = entropy > np.log(perplexity)
        low, high = np.where(wide, beta, low), np.where(wide, high, beta)
        beta = np.where(np.isinf(high), beta * 2, (low + high) / 2)
    joint: Array = ((p + p.T) / (2 * len(p))).astype(np.float32)
    return joint


def _principal(vectors: Array) -> Array:
    centred = vectors - vectors.mean(axis=0)
    _, axes = np.linalg.eigh(centred.T @ centred)
    return np.ascontiguousarray(centred @ axes[:, :-3:-1], np.float32)


def load(folder: Path, generation: int) -> Map | None:
    """The map kept for a generation, None where there is none that is sound."""
    try:
        with np.load(folder / _name(generation), allow_pickle=False) as kept:
            labels = tuple(json.loads(str(kept["labels"])))
            return Map(generation, kept["clips"], kept["points"], labels, kept["label"])
    except (OSError, ValueError, KeyError):
        return None


def save(folder: Path, made: Map) -> None:
    """Keep a map in place of older ones; where the folder cannot be written nothing is kept and nothing lost."""
    if not os.access(folder.parent, os.W_OK):
        return
    try:
        folder.mkdir(exist_ok=True)
        handle, name = tempfile.mkstemp(dir=folder, prefix=".map.")
        with os.fdopen(handle, "wb") as file:
            labels = np.array(json.dumps(made.labels))
            np.savez(file, clips=made.clips, points=made.points, labels=labels, label=made.label)
        os.replace(name, folder / _name(made.generation))
        for old in folder.glob("map.*.npz"):
            if old.name != _name(made.generation):
                old.unlink(missing_ok=True)
    except OSError:
        return


def _name(generation: int) -> str:
    return f"map.{generation}.npz"
