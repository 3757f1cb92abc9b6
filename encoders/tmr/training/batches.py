"""Batches: which motions and sentences a training step sees, how they are varied, and which pairs are no negatives."""

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
from encoders.tmr.training.false_negatives import FalseNegativeMask
from encoders.tmr.training.pairs import PairStore
from encoders.tmr.training.recipe import Recipe

#: Made clips that come together where alike ones are drawn, and among how many nearest they are chosen.
_TOGETHER, _NEAREST = 12, 48


@dataclass(frozen=True)
class Batch:
    """One step's rows of mixed lengths; texts beyond the motions' count are negatives only.

    Attributes
    ----------
    motions : rows (T, F), standardised
    texts : rows (L, width)
    ignore : boolean (texts, motions), True where a pair counts neither way
    swapped : (S,) for the S texts right after the motions' own: the motion of which each is nearly, yet not, true
    picked : (motions,) which pairs these are, the made ones counted first and the real ones on from there
    """

    motions: list[NDArray[np.float32]]
    texts: list[NDArray[np.float16]]
    ignore: Tensor
    swapped: Tensor
    picked: NDArray[np.int64]


class Batches:
    """Draws batches from made and real pairs."""

    def __init__(
        self,
        made: PairStore,
        real: PairStore | None,
        unrelated: Sequence[str],
        tokens: TokenTable,
        texts: dict[str, int],
        normaliser: Normaliser,
        recipe: Recipe,
    ) -> None:
        self.made, self.real, self.recipe, self.tokens, self.normaliser = made, real, recipe, tokens, normaliser
        self.rows = {id(store): np.array([texts[t] for t in store.texts]) for store in (made, real) if store}
        self.all_texts = list(texts)
        self.no_negatives = FalseNegativeMask(made, real, tokens, recipe)
        self.unrelated = np.array([texts[t] for t in unrelated])
        self.places: NDArray[np.float32] | None = None

    def place(self, model: TMR) -> NDArray[np.float32]:
        """Find where this model puts every made clip, (N, D): from now on some come with others that lie near them."""
        self.places = embed_motions(model, self.made, self.normaliser, self.recipe.max_frames)
        return self.places

    def draw(self, rng: np.random.Generator, *, hard: bool = True) -> Batch:
        """One batch; `hard`: with clips that are hard to tell apart and with changed twins of captions."""
        recipe = self.recipe
        n_real = round(recipe.batch * recipe.real_share) if self.real else 0
        picks = [(self.made, int(i)) for i in self._made(recipe.batch - n_real, rng, hard)]
        if self.real:
            picks += [(self.real, int(i)) for i in rng.integers(len(self.real), size=n_real)]
        chosen = [int(rng.integers(len(store.captions[i]))) for store, i in picks]
        own = [int(self.rows[id(store)][store.captions[i][c]]) for (store, i), c in zip(picks, chosen, strict=True)]
        swapped = [
            (row, int(self.rows[id(store)][twin]))
            for row, ((store, i), c) in enumerate(zip(picks, chosen, strict=True))
            if hard and (twin := store.swapped[i][c]) >= 0
        ][: recipe.hard_negatives]
        away = rng.choice(self.unrelated, size=recipe.unrelated) if recipe.unrelated else np.zeros(0, np.int64)
        motions = [self._motion(store, i, rng) for store, i in picks]
        texts = self._words([*own, *(t for _, t in swapped), *away.tolist()], rng)
        ignore = np.zeros((len(own) + len(swapped) + len(away), len(own)), bool)
        if recipe.filter == "facts":
            ignore[: len(own)] = self.no_negatives(picks, chosen, own, [self.all_texts[t] for t in own])
        for extra, (row, _) in enumerate(swapped):
            ignore[len(own) + extra] = True
            ignore[len(own) + extra, row] = False
        picked = np.array([i if store is self.made else len(self.made) + i for store, i in picks])
        twins = torch.tensor([row for row, _ in swapped]).long()
        return Batch(motions, texts, torch.from_numpy(ignore), twins, picked)

    def _made(self, count: int, rng: np.random.Generator, hard: bool) -> NDArray[np.int64]:
        """Indices of `count` made clips; with `hard` a share of them in groups that the model finds alike."""
        groups, total = round(self.recipe.alike * count / _TOGETHER), len(self.made)
        if self.places is None or not hard or total < _NEAREST + count:
            return rng.choice(total, size=count, replace=total < count)
        alone = rng.choice(total, size=count - groups * (_TOGETHER - 1), replace=False)
        nearness = self.places[alone[:groups]] @ self.places.T
        nearness[:, alone] = -np.inf
        near = np.argpartition(-nearness, _NEAREST, axis=1)[:, :_NEAREST]
        chosen = np.unique(rng.permuted(near, axis=1)[:, : _TOGETHER - 1])  # groups that overlap share clips
        others = rng.integers(total, size=count - len(alone) - len(chosen))
        return np.concatenate([alone, chosen, others])

    def _motion(self, store: PairStore, index: int, rng: np.random.Generator) -> NDArray[np.float32]:
        recipe = self.recipe
        x = store.motion(index).astype(np.float32)
        if recipe.yaw or recipe.tilt:
            x = random_rotation(x, rng, recipe.yaw, recipe.tilt)
        if recipe.posture:
            x = pose_jitter(x, rng, recipe.posture)
        x = (x - self.normaliser.mean) / self.normaliser.std
        limit = recipe.max_frames
        in_order = any("<" in store.vocabulary[f] for f in store.facts[index] or ())
        if rng.random() < recipe.crop and store is self.made and not in_order:
            limit = min(limit, max(12, int(len(x) * rng.uniform(0.3, 1))))
        if len(x) > limit:
            start = int(rng.integers(len(x) - limit + 1))
            x = x[start : start + limit]
        size = x.shape[1]
        offset = recipe.bias * rng.standard_normal(size, dtype=np.float32)
        return x + offset + recipe.noise * rng.standard_normal(x.shape, dtype=np.float32)

    def _words(self, indices: list[int], rng: np.random.Generator) -> list[NDArray[np.float16]]:
        """Token features of sentences, some of whose word pieces are lost; the first token always stays."""
        rows = self.tokens.rows(indices)
        kept = [rng.random(len(row)) >= self.recipe.words_lost for row in rows]
        return [row[keep | (np.arange(len(row)) == 0)] for row, keep in zip(rows, kept, strict=True)]
