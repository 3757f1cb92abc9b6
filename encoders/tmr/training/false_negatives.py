"""The false-negative mask: pairs of a batch whose caption is, or may be, true of a motion it was not written for."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from encoders.corpus.composition.facts import Underspecified, entailment_of_indices
from encoders.tmr.text.token_features import TokenTable
from encoders.tmr.training.pairs import PairStore, sides_conflict
from encoders.tmr.training.recipe import Recipe

Picks = Sequence[tuple[int, int]]
Members = list[list[int]]

#: Numbers of the stores that a batch is drawn from.
SYNTHETIC, REAL = 0, 1


class FalseNegativeMask:
    """Masks pairs by the facts that clips show and captions state, else by the similarity of the captions.

    `stores` are the synthetic pairs and, where there are any, the real ones.
    """

    def __init__(self, stores: Sequence[PairStore], tokens: TokenTable, recipe: Recipe) -> None:
        self._tokens, self._recipe, self._stores = tokens, recipe, stores
        vocabulary = list(dict.fromkeys(fact for store in stores for fact in store.vocabulary))
        index = {fact: i for i, fact in enumerate(vocabulary)}
        self._size, self._underspecified = len(vocabulary), Underspecified(vocabulary)
        self._stated = [_meanings(store, index) for store in stores]
        self._facts = [_facts(store, index) for store in stores]
        self._possible = [_possible(facts, vocabulary) if i == REAL else facts for i, facts in enumerate(self._facts)]

    def __call__(
        self, picks: Picks, chosen: Sequence[int], texts: Sequence[int], captions: Sequence[str]
    ) -> NDArray[np.bool_]:
        """Boolean (captions, motions), True for pairs to mask.

        Parameters
        ----------
        picks : the number of the store and the index of each motion
        chosen : which of its captions each motion comes with
        texts, captions : these captions, as rows of the token table and as they are written
        """
        ignore = np.zeros((len(picks), len(picks)), bool)
        rows = np.array([r for r, (s, i) in enumerate(picks) if self._stores[s].facts[i] is not None], np.int64)
        if len(rows):
            known = [(*picks[r], chosen[r]) for r in rows]
            meanings = [self._stated[s][i][c] for s, i, c in known]
            true = entailment_of_indices(meanings, [self._possible[s][i] for s, i, _ in known], self._size)
            if self._recipe.typical:
                true &= ~self._underspecified(meanings, [self._facts[s][i] for s, i, _ in known])
            ignore[np.ix_(rows, rows)] = true
        real = np.array([s == REAL for s, _ in picks])
        similar = similar_sentences(self._tokens.sentences[list(texts)], self._recipe.similarity)
        ignore |= similar & (real[:, None] | real[None, :]) & ~sides_conflict(captions)
        same = np.array(texts)[:, None] == np.array(texts)[None, :]
        return np.asarray(ignore | same, np.bool_)


def similar_sentences(embeddings: NDArray[np.float32], threshold: float = 0.8) -> NDArray[np.bool_]:
    """TMR's filter of false negatives: pairs (B, B) of sentences that say nearly the same.

    Parameters
    ----------
    embeddings : (B, E)
        Unit vectors of the captions.
    threshold : float
        On the (1 + cosine) / 2 scale; 0.8 is a cosine of 0.6. The diagonal is never True.
    """
    return (embeddings @ embeddings.T > 2 * threshold - 1) & ~np.eye(len(embeddings), dtype=np.bool_)


def _meanings(store: PairStore, index: Mapping[str, int]) -> list[Members]:
    """For each pair and caption the facts it states, by `index`; nothing where that is not known."""
    own = [index[fact] for fact in store.vocabulary]
    return [[[own[f] for f in meaning] for meaning in meanings or ()] for meanings in store.meanings]


def _facts(store: PairStore, index: Mapping[str, int]) -> Members:
    own = [index[fact] for fact in store.vocabulary]
    return [[own[f] for f in facts or ()] for facts in store.facts]


def _possible(facts: Members, vocabulary: Sequence[str]) -> Members:
    """Facts with all attributes of their actions that no caption states: people leave out most of what they see."""
    particulars: dict[str, list[tuple[str, int]]] = defaultdict(list)
    for i, fact in enumerate(vocabulary):
        action, _, particular = fact.partition(".")
        if particular and not set(action) & set("<+"):
            particulars[action].append((f"{action}.{particular.partition('=')[0]}", i))
    widened = []
    for members in facts:
        names = {vocabulary[f] for f in members}
        stated = {name.partition("=")[0] for name in names if "=" in name}
        unstated = [i for name in names for field, i in particulars.get(name, ()) if field not in stated]
        widened.append([*members, *unstated])
    return widened
