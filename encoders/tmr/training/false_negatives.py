"""Which pairs of a batch are no negatives: the sentence is, or may well be, true of a motion it was not written for."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from encoders.corpus.composition.facts import Underspecified, entailment_of_indices
from encoders.tmr.text.token_features import TokenTable
from encoders.tmr.training.pairs import PairStore, sides_conflict
from encoders.tmr.training.recipe import Recipe

Picks = Sequence[tuple[PairStore, int]]
Members = list[list[int]]


class FalseNegativeMask:
    """Knows what clips show and sentences state, by facts where these are known and else by the sentences' likeness."""

    def __init__(self, made: PairStore, real: PairStore | None, tokens: TokenTable, recipe: Recipe) -> None:
        self.made, self.tokens, self.recipe = made, tokens, recipe
        vocabulary = list(dict.fromkeys([*made.vocabulary, *(real.vocabulary if real else ())]))
        index = {fact: i for i, fact in enumerate(vocabulary)}
        self.size, self.untold = len(vocabulary), Underspecified(vocabulary)
        self.stated = {id(store): _meanings(store, index) for store in (made, real) if store}
        self.facts = {id(store): _facts(store, index) for store in (made, real) if store}
        self.shown = {**self.facts, **({id(real): _possible(self.facts[id(real)], vocabulary)} if real else {})}

    def __call__(
        self, picks: Picks, chosen: Sequence[int], texts: Sequence[int], words: Sequence[str]
    ) -> NDArray[np.bool_]:
        """Boolean (sentences, motions) of pairs that count neither way.

        Parameters
        ----------
        picks : a store and an index of each motion
        chosen : which of its captions each motion comes with
        texts, words : the captions, as rows of the token table and as they are written
        """
        ignore = np.zeros((len(picks), len(picks)), bool)
        rows = np.array([r for r, (store, i) in enumerate(picks) if store.facts[i] is not None], np.int64)
        if len(rows):
            known = [(id(picks[r][0]), picks[r][1], chosen[r]) for r in rows]
            meanings = [self.stated[store][i][c] for store, i, c in known]
            true = entailment_of_indices(meanings, [self.shown[store][i] for store, i, _ in known], self.size)
            if self.recipe.typical:
                true &= ~self.untold(meanings, [self.facts[store][i] for store, i, _ in known])
            ignore[np.ix_(rows, rows)] = true
        made = np.array([store is self.made for store, _ in picks])
        involved = ~(made[:, None] & made[None, :])
        sentences = self.tokens.sentences[list(texts)]
        near = sentences @ sentences.T > 2 * self.recipe.similarity - 1
        ignore |= near & involved & ~sides_conflict(words)
        same = np.array(texts)[:, None] == np.array(texts)[None, :]
        return np.asarray(ignore | same, np.bool_)


def _meanings(store: PairStore, index: Mapping[str, int]) -> list[Members]:
    """For each pair and caption the facts it states, by `index`; nothing where that is not known."""
    own = [index[fact] for fact in store.vocabulary]
    return [[[own[f] for f in meaning] for meaning in meanings or ()] for meanings in store.meanings]


def _facts(store: PairStore, index: Mapping[str, int]) -> Members:
    own = [index[fact] for fact in store.vocabulary]
    return [[own[f] for f in facts or ()] for facts in store.facts]


def _possible(facts: Members, vocabulary: Sequence[str]) -> Members:
    """Facts with all particulars of their actions of which nothing is told: people leave out most of what they see."""
    particulars: dict[str, list[tuple[str, int]]] = defaultdict(list)
    for i, fact in enumerate(vocabulary):
        action, _, particular = fact.partition(".")
        if particular and not set(action) & set("<+"):
            particulars[action].append((f"{action}.{particular.partition('=')[0]}", i))
    widened = []
    for members in facts:
        names = {vocabulary[f] for f in members}
        told = {name.partition("=")[0] for name in names if "=" in name}
        untold = [i for name in names for field, i in particulars.get(name, ()) if field not in told]
        widened.append([*members, *untold])
    return widened
