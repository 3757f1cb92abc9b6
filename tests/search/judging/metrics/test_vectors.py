"""Figures of vectors: spread, agreement with sentences, recognition, repeats."""

import numpy as np
import pytest

from search.judging.metrics.agreement import batched_precision, multimodal_distance, precision, tmr_scores
from search.judging.metrics.recognition import accuracy
from search.judging.metrics.repeats import mean_and_interval
from search.judging.metrics.spread import diversity, multimodality


def test_diversity_of_two_points_is_half_their_distance() -> None:
    rng = np.random.default_rng(0)
    assert diversity([[0.0, 0.0], [3.0, 4.0]], rng, pairs=20_000) == pytest.approx(2.5, abs=0.05)
    with pytest.raises(ValueError, match="N >= 2"):
        diversity([[1.0]], rng)


def test_multimodality_pairs_different_motions_of_a_label_and_averages_over_labels() -> None:
    vectors = [[0.0], [3.0], [0.0], [1.0], [100.0]]
    labels = ["kick", "kick", "walk", "walk", "bow"]
    assert multimodality(vectors, labels, np.random.default_rng(0)) == pytest.approx((3 + 1) / 2)
    with pytest.raises(ValueError, match="no group"):
        multimodality(vectors[:2], ["kick", "walk"], np.random.default_rng(0))


def test_tmr_score_is_the_cosine_between_zero_and_one() -> None:
    ours, theirs = [[2.0, 0.0], [0.0, 1.0], [1.0, 0.0]], [[1.0, 0.0], [1.0, 0.0], [-3.0, 0.0]]
    assert tmr_scores(ours, theirs).tolist() == [1.0, 0.5, 0.0]
    with pytest.raises(ValueError, match="counterpart"):
        tmr_scores(ours, theirs[:2])


def test_multimodal_distance_is_to_the_own_sentence() -> None:
    assert multimodal_distance([[0.0, 0.0], [1.0, 0.0]], [[3.0, 4.0], [1.0, 1.0]]) == pytest.approx((5 + 1) / 2)


def test_precision_in_batches_of_32() -> None:
    motions = np.eye(40)
    texts = motions.copy()
    assert batched_precision(motions, texts, seed=3) == {1: 100.0, 2: 100.0, 3: 100.0}
    # Two of 32 have each other's sentence: the own one ties with 30 others, in the middle of the places 2 to 32.
    motions = np.eye(32)
    texts = motions[[1, 0, *range(2, 32)]]
    assert batched_precision(motions, texts, seed=3)[3] == pytest.approx(100 * 30 / 32)
    with pytest.raises(ValueError, match="fewer than one batch"):
        batched_precision(motions[:31], texts[:31], seed=3)


def test_precision_over_all_sentences() -> None:
    sentences = np.eye(4)
    motions = [[0.9, 0.1, 0, 0], [0.9, 0.1, 0, 0], [0, 0, 1, 0], [0.3, 0.2, 0.1, 0]]
    assert precision(motions, sentences, [0, 1, 2, 3]) == {1: 50.0, 2: 75.0, 3: 75.0}


def test_accuracy_counts_synonyms() -> None:
    labels = ["stand", "stand still", "kick", "bow", "run", "jump"]
    scores = [[0.2, 0.9, 0.1, 0, 0, 0], [0.1, 0.2, 0.3, 0.4, 0.5, 0.0]]
    assert accuracy(scores, labels, ["stand", "jump"]) == {1: 0.0, 5: 50.0}
    assert accuracy(scores, labels, ["stand", "jump"], [frozenset({"stand", "stand still"})]) == {1: 50.0, 5: 50.0}
    with pytest.raises(ValueError, match="'hop' is none of the 6 labels"):
        accuracy(scores, labels, ["stand", "hop"])


def test_an_interval_is_1_96_standard_errors() -> None:
    assert mean_and_interval([1.0, 2.0, 3.0]) == pytest.approx((2.0, 1.96 / np.sqrt(3)))
    assert np.isnan(mean_and_interval([1.0])[1])
