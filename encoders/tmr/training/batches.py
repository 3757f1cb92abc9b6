"""Batches: which motions and sentences a training step sees, how they are augmented, and which pairs are masked."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor

from encoders.tmr.model.network import TMR
from encoders.tmr.model.normaliser import Normaliser
from encoders.tmr.text.token_features import TokenTable
from encoders.tmr.training.augment import pose_jitter, random_rotation
from encoders.tmr.training.embed import embed_motions
from encoders.tmr.training.false_negatives import REAL, SYNTHETIC, FalseNegativeMask
from encoders.tmr.training.pairs import PairStore
from encoders.tmr.training.recipe import Recipe

#: Size of a group of similar synthetic clips, and the number of nearest neighbours it is drawn from.
_GROUP, _NEAREST = 12, 48


@dataclass(frozen=True)
class Batch:
    """One step's rows of mixed lengths; texts beyond the motions' count are negatives only.

    Attributes
    ----------
    motions : rows (T, F), standardised
    texts : rows (L, width)
    ignore : boolean (texts, motions), True where a pair is masked
    owners : (S,) for the S hard negatives, right after the motions' own captions: the motion of each
    picked : (motions,) indices of the pairs, synthetic ones first, real ones after them
    """

    motions: list[NDArray[np.float32]]
    texts: list[NDArray[np.float16]]
    ignore: Tensor
    owners: Tensor
    picked: NDArray[np.int64]


class Batches:
    """Draws batches from synthetic and real pairs."""

    def __init__(
        self,
        synthetic: PairStore,
        real: PairStore | None,
        unrelated: Sequence[str],
        tokens: TokenTable,
        texts: dict[str, int],
        normaliser: Normaliser,
        recipe: Recipe,
    ) -> None:
        self.synthetic, self.real, self.recipe, self.tokens = synthetic, real, recipe, tokens
        self.normaliser = normaliser
        self._stores = [synthetic] if real is None else [synthetic, real]
        self._rows = [np.array([texts[t] for t in store.texts]) for store in self._stores]
        self.all_texts = list(texts)
        self._false_negatives = FalseNegativeMask(self._stores, tokens, recipe)
        self._unrelated = np.array([texts[t] for t in unrelated])
        self.embeddings: NDArray[np.float32] | None = None

    def embed_synthetic(self, model: TMR) -> NDArray[np.float32]:
        """Embed every synthetic clip with a model, (N, D): from now on some are drawn with their nearest neighbours."""
        self.embeddings = embed_motions(model, self.synthetic, self.normaliser, self.recipe.max_frames)
        return self.embeddings

    def embed(self, model: TMR) -> NDArray[np.float32]:
        """Embeddings (N, D) of all clips, as `Batch.picked` counts them; see `embed_synthetic`."""
        synthetic = self.embed_synthetic(model)
        if not self.real:
            return synthetic
        return np.concatenate([synthetic, embed_motions(model, self.real, self.normaliser, self.recipe.max_frames)])

    def draw(self, rng: np.random.Generator, *, hard: bool = True) -> Batch:
        """One batch; `hard`: with groups of similar clips and with hard negatives."""
        recipe = self.recipe
        n_real = round(recipe.batch * recipe.real_share) if self.real else 0
        picks = [(SYNTHETIC, int(i)) for i in self._synthetic(recipe.batch - n_real, rng, hard)]
        if self.real:
            picks += [(REAL, int(i)) for i in rng.integers(len(self.real), size=n_real)]
        chosen = [int(rng.integers(len(self._stores[s].captions[i]))) for s, i in picks]
        own = [int(self._rows[s][self._stores[s].captions[i][c]]) for (s, i), c in zip(picks, chosen, strict=True)]
        negatives = [
            (row, int(self._rows[s][negative]))
            for row, ((s, i), c) in enumerate(zip(picks, chosen, strict=True))
            if hard and (negative := self._stores[s].hard_negatives[i][c]) >= 0
        ][: recipe.hard_negatives]
        away = rng.choice(self._unrelated, size=recipe.unrelated) if recipe.unrelated else np.zeros(0, np.int64)
        motions = [self._motion(s, i, rng) for s, i in picks]
        texts = self._tokens([*own, *(t for _, t in negatives), *away.tolist()], rng)
        ignore = np.zeros((len(own) + len(negatives) + len(away), len(own)), bool)
        if recipe.filter == "facts":
            ignore[: len(own)] = self._false_negatives(picks, chosen, own, [self.all_texts[t] for t in own])
        for extra, (row, _) in enumerate(negatives):
            ignore[len(own) + extra] = True
            ignore[len(own) + extra, row] = False
        picked = np.array([s * len(self.synthetic) + i for s, i in picks])
        owners = torch.tensor([row for row, _ in negatives]).long()
        return Batch(motions, texts, torch.from_numpy(ignore), owners, picked)

    def _synthetic(self, count: int, rng: np.random.Generator, hard: bool) -> NDArray[np.int64]:
        """Indices of `count` synthetic clips; with `hard` a share of them in groups of nearest neighbours."""
        groups, total = round(self.recipe.similar_share * count / _GROUP), len(self.synthetic)
        if self.embeddings is None or not hard or total < _NEAREST + count:
            return rng.choice(total, size=count, replace=total < count)
        alone = rng.choice(total, size=count - groups * (_GROUP - 1), replace=False)
        similarity = self.embeddings[alone[:groups]] @ self.embeddings.T
        similarity[:, alone] = -np.inf
        near = np.argpartition(-similarity, _NEAREST, axis=1)[:, :_NEAREST]
        chosen = np.unique(rng.permuted(near, axis=1)[:, : _GROUP - 1])  # groups that overlap share clips
        others = rng.integers(total, size=count - len(alone) - len(chosen))
        return np.concatenate([alone, chosen, others])

    def _motion(self, source: int, index: int, rng: np.random.Generator) -> NDArray[np.float32]:
        recipe, store = self.recipe, self._stores[source]
        x = store.motion(index).astype(np.float32)
        if recipe.yaw or recipe.tilt:
            x = random_rotation(x, rng, recipe.yaw, recipe.tilt)
        if recipe.pose_jitter:
            x = pose_jitter(x, rng, recipe.pose_jitter)
        x = (x - self.normaliser.mean) / self.normaliser.std
        limit = recipe.max_frames
        in_order = any("<" in store.vocabulary[f] for f in store.facts[index] or ())
        if rng.random() < recipe.crop and source == SYNTHETIC and not in_order:
            limit = min(limit, max(12, int(len(x) * rng.uniform(0.3, 1))))
        if len(x) > limit:
            start = int(rng.integers(len(x) - limit + 1))
            x = x[start : start + limit]
        size = x.shape[1]
        offset = recipe.bias * rng.standard_normal(size, dtype=np.float32)
        return x + offset + recipe.noise * rng.standard_normal(x.shape, dtype=np.float32)

    def _tokens(self, indices: list[int], rng: np.random.Generator) -> list[NDArray[np.float16]]:
        """Token features of sentences after token dropout; the first token always stays."""
        rows = self.tokens.rows(indices)
        kept = [rng.random(len(row)) >= self.recipe.token_dropout for row in rows]
        return [row[keep | (np.arange(len(row)) == 0)] for row, keep in zip(rows, kept, strict=True)]
