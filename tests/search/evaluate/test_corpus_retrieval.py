"""Retrieval among synthetic clips, on a model whose answers are known."""

from __future__ import annotations

import numpy as np
import pytest

from encoders.corpus.composition.synthetic_pairs import SyntheticClip
from encoders.corpus.scene import ActionStep, Scene
from search.evaluate import corpus_retrieval
from search.evaluate.corpus_retrieval import evaluate_corpus
from tests.search.answers import SENTENCES, KnownAnswers


def clip(shown: int, captioned: int, *negatives: int) -> SyntheticClip:
    """A clip of one kind whose caption names another, perhaps; each kind is an action of its own."""
    rows = np.tile(np.eye(len(SENTENCES), dtype=np.float32)[shown], (10, 1))
    scene = Scene(((ActionStep(f"kind{captioned}"),),))
    meaning = frozenset({f"kind{captioned}"})
    return SyntheticClip(
        rows, scene, ((0.0, 1.0),), (SENTENCES[captioned],), (meaning,), tuple(SENTENCES[s] for s in negatives)
    )


def test_a_model_that_knows_all_the_answers() -> None:
    clips = [clip(i % 5, i % 5, (i + 1) % 5) for i in range(40)]
    figures = evaluate_corpus(clips, KnownAnswers())
    assert figures["hard negatives"] == {"accuracy": 100.0, "pairs": 40.0}
    same = figures["same sentence, text -> motion"]
    assert same["R@1"] == 0.0, "eight equal clips tie at rank (8 - 1) / 2, as published code counts"
    assert same["R@5"] == 100.0
    assert same["MedR"] == 4.5
    assert figures["relevant clips, text -> motion"] == same
    assert figures["batches of 32, text -> motion"]["R@10"] == 100.0


def test_a_model_that_confuses_kinds() -> None:
    clips = [clip((i + 1) % 5, i % 5, (i + 1) % 5) for i in range(40)]
    figures = evaluate_corpus(clips, KnownAnswers())
    assert figures["hard negatives"]["accuracy"] == 0.0
    assert figures["same sentence, text -> motion"]["R@10"] == 0.0


def test_clips_of_which_the_sentence_is_also_true_count() -> None:
    walks = frozenset({"walk"})
    one_walk = SyntheticClip(
        np.eye(6, dtype=np.float32)[[2]], Scene(((ActionStep("walk"),),)), (), ("one",), (walks,), ()
    )
    left = SyntheticClip(
        np.eye(6, dtype=np.float32)[[1]], Scene(((ActionStep("walk", direction="left"),),)), (), ("four",), (walks,), ()
    )
    clips = [one_walk, left, *(clip(0, 0, 1) for _ in range(30))]
    figures = evaluate_corpus(clips, KnownAnswers())
    share = 1 / 32
    true, same = figures["relevant clips, text -> motion"]["R@1"], figures["same sentence, text -> motion"]["R@1"]
    assert true - same == pytest.approx(100 * share)


def test_heldout_paraphrases_are_right_for_every_clip_that_shows_the_action(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    heldout = {"kind0": (SENTENCES[0], SENTENCES[1]), "another": (SENTENCES[2],)}
    monkeypatch.setattr(corpus_retrieval, "paraphrase_queries", lambda: heldout)
    clips = [clip(shown, 0) for shown in (0, 0, 3, 4)] + [clip(1, 1), clip(2, 2)]
    figures = evaluate_corpus(clips, KnownAnswers())
    assert figures["held-out paraphrases, text -> motion"]["R@1"] == 50.0, "what no clip shows is no query"


def test_figures_that_need_more_clips_are_left_out() -> None:
    figures = evaluate_corpus([clip(i, i) for i in range(3)], KnownAnswers())
    assert set(figures) == {
        "same sentence, text -> motion",
        "same sentence, motion -> text",
        "relevant clips, text -> motion",
    }
    assert all(np.isfinite(list(row.values())).all() for row in figures.values())
