"""A training run from data to a model, validated on held-out synthetic and real clips."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from encoders.corpus.composition.facts import entailment_of_indices
from encoders.metrics import ranks
from encoders.tmr.model.network import TMR
from encoders.tmr.model.normaliser import Normaliser
from encoders.tmr.text.language_model import LanguageModel
from encoders.tmr.text.token_features import TokenTable
from encoders.tmr.training.batches import Batches
from encoders.tmr.training.embed import embed_motions, embed_texts
from encoders.tmr.training.loop import Trainer
from encoders.tmr.training.pairs import PairStore
from encoders.tmr.training.recipe import Recipe


@dataclass(frozen=True)
class Validation:
    """Pairs a model is validated on while it trains."""

    synthetic: PairStore
    real: PairStore | None
    tokens: TokenTable
    texts: dict[str, int]
    normaliser: Normaliser
    max_frames: int

    def __call__(self, model: TMR) -> dict[str, float]:
        """R@1 and R@10 on synthetic clips (every relevant clip is right), R@1/5/10 on real ones."""
        return {**self._synthetic(model), **(self._real(model) if self.real else {})}

    def _synthetic(self, model: TMR) -> dict[str, float]:
        store = self.synthetic
        motions = embed_motions(model, store, self.normaliser, self.max_frames)
        first = [self.texts[store.texts[captions[0]]] for captions in store.captions]
        similarity = embed_texts(model, self.tokens, first) @ motions.T
        meanings = [m[0] for m in store.meanings if m is not None]
        right = entailment_of_indices(meanings, [f or [] for f in store.facts], len(store.vocabulary))
        np.fill_diagonal(right, True)
        rank = ranks(similarity, right)
        strict = ranks(similarity)
        figures = {
            "synthetic_R@1": 100 * float(np.mean(rank < 1)),
            "synthetic_R@10": 100 * float(np.mean(rank < 10)),
            "strict_R@1": 100 * float(np.mean(strict < 1)),
            "strict_MedR": float(np.median(strict)) + 1,
        }
        changed = [i for i, row in enumerate(store.hard_negatives) if row[0] >= 0]
        if changed:
            negatives = [self.texts[store.texts[store.hard_negatives[i][0]]] for i in changed]
            wrong = embed_texts(model, self.tokens, negatives)
            correct = np.einsum("nd,nd->n", wrong, motions[changed]) < np.diagonal(similarity)[changed]
            figures["hard_negatives"] = 100 * float(correct.mean())
        return figures

    def _real(self, model: TMR) -> dict[str, float]:
        assert self.real is not None
        store = self.real
        motions = embed_motions(model, store, self.normaliser, self.max_frames)
        queries: dict[str, list[int]] = {}
        for i, captions in enumerate(store.captions):
            for caption in captions:
                queries.setdefault(store.texts[caption], []).append(i)
        right = np.zeros((len(queries), len(store)), bool)
        for row, clips in zip(right, queries.values(), strict=True):
            row[clips] = True
        similarity = embed_texts(model, self.tokens, [self.texts[t] for t in queries]) @ motions.T
        rank = ranks(similarity, right)
        return {f"real_R@{k}": 100 * float(np.mean(rank < k)) for k in (1, 5, 10)}


def prepare(
    recipe: Recipe,
    synthetic: PairStore,
    real: PairStore | None,
    validation_synthetic: PairStore,
    validation_real: PairStore | None,
    unrelated: Sequence[str],
    language: LanguageModel,
    cache: Path,
    normaliser: Normaliser | None = None,
) -> tuple[Batches, Validation, Normaliser]:
    """Token features, normaliser (where none is given, of these clips), and what draws batches and validates."""
    stores = [s for s in (synthetic, real, validation_synthetic, validation_real) if s is not None]
    texts = {text: i for i, text in enumerate(dict.fromkeys([*unrelated, *(t for s in stores for t in s.texts)]))}
    tokens = TokenTable(list(texts), language, cache, bf16=recipe.bf16)
    if normaliser is None:
        sources = [synthetic.features] if real is None else [synthetic.features, real.features]
        normaliser = Normaliser.of(np.concatenate([f[:: max(1, len(f) // 100_000)] for f in sources]))
    batches = Batches(synthetic, real, unrelated, tokens, texts, normaliser, recipe)
    return (
        batches,
        Validation(validation_synthetic, validation_real, tokens, texts, normaliser, recipe.max_frames),
        normaliser,
    )


def train(
    folder: Path,
    recipe: Recipe,
    batches: Batches,
    validate: Callable[[TMR], dict[str, float]],
    normaliser: Normaliser,
    *,
    start: TMR | None = None,
    every: int = 200,
    minutes: float = float("inf"),
    say: Callable[[str], None] = print,
) -> TMR:
    """Train, or resume, the run in `folder`; a new run begins with the weights of `start`."""
    trainer = Trainer(folder, recipe, batches, start)
    normaliser.save(folder)
    return trainer.run(evaluate=validate, every=every, minutes=minutes, say=say)
