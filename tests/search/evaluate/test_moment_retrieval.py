"""Figures of moments, by hand and on a model whose answers are known."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from encoders.corpus.composition.long_takes import AnnotatedTake, Event, annotated_take
from search.evaluate.moment_metrics import Overlaps
from search.evaluate.moment_retrieval import evaluate_moments
from search.evaluate.moment_tables import moment_tables
from search.evaluate.sequence_questions import sequence_overlap
from search.evaluate.window_cache import WindowCache
from tests.search.answers import SENTENCES, KnownAnswers, motion


@pytest.fixture
def overlaps() -> Overlaps:
    """Two questions: the first answered exactly, the second half right at the second try."""
    found = Overlaps()
    found.add([(0.0, 2.0), (5.0, 6.0)], [(0.0, 2.0)])
    found.add([(8.0, 9.0), (4.0, 6.0)], [(5.0, 6.0), (20.0, 30.0)])
    return found


def test_recall_counts_questions_with_a_right_answer_among_the_first(overlaps: Overlaps) -> None:
    assert overlaps.recall(1, 0.9) == 50.0
    assert overlaps.recall(2, 0.5) == 100.0
    assert overlaps.recall(2, 0.6) == 50.0


def test_the_first_answers_overlap(overlaps: Overlaps) -> None:
    assert overlaps.mean_iou() == 50.0


def test_average_precision_is_the_reciprocal_rank_of_the_first_right_answer(overlaps: Overlaps) -> None:
    assert overlaps.mean_ap() == pytest.approx(100 * (1 + 0.5 * 5 / 7) / 2)


def test_any_true_span_will_do() -> None:
    found = Overlaps()
    found.add([(20.0, 30.0)], [(5.0, 6.0), (20.0, 30.0)])
    assert found.figures()["accuracy at 0.9"] == 100.0


def test_no_answer_is_wrong() -> None:
    found = Overlaps()
    found.add([], [(0.0, 1.0)])
    assert found.mean_iou() == found.mean_ap() == found.recall(10, 0.1) == 0.0


def test_an_answer_where_nothing_is_true_is_wrong() -> None:
    found = Overlaps()
    found.add([(0.0, 1.0)], [])
    assert found.recall(10, 0.1) == 0.0


def taken(*kinds: int, seconds: float = 4.0) -> AnnotatedTake:
    """A take of one kind after the other, annotated with the sentences that name the kinds."""
    events = [
        Event(SENTENCES[kind], (seconds * i, seconds * (i + 1)), frozenset({SENTENCES[kind]}))
        for i, kind in enumerate(kinds)
    ]
    return annotated_take(motion(*kinds, seconds=seconds), events)


def test_a_model_that_knows_all_the_answers_finds_the_moments() -> None:
    found = evaluate_moments([taken(0, 1, 2, 0, 3)], KnownAnswers(), sequences=True)
    assert set(found) == {
        "motionseek",
        *(f"window of {size}" for size in (20, 40, 60)),
        "best of the three",
        "upper bound of the grid",
        "motionseek, all takes at once",
        "motionseek, all takes at once, its own take",
        "three steps in order",
    }
    assert found["motionseek"]["questions"] == 4.0
    assert found["motionseek"]["accuracy at 0.5"] == 100.0
    assert found["window of 20"]["mean IoU"] == pytest.approx(25.0), "one second of four"
    assert found["upper bound of the grid"]["mean IoU"] >= 80.0 - 1e-6
    assert found["three steps in order"] == {
        "questions": 2.0,
        "all at 0.3": 100.0,
        "all at 0.5": 100.0,
        "all at 0.7": 100.0,
    }


def test_a_moment_in_another_take_counts_where_it_is_true_but_not_as_the_own_take() -> None:
    found = evaluate_moments([taken(0, 1), taken(0, 2)], KnownAnswers())
    any_take = found["motionseek, all takes at once"]
    own = found["motionseek, all takes at once, its own take"]
    assert any_take["accuracy at 0.5"] == 100.0
    assert own["accuracy at 0.5"] == 75.0, "zero is true in both takes and found in one of them first"
    assert own["R@5 at 0.5"] == 100.0


def test_sentences_about_heldout_actions_are_counted_apart() -> None:
    known = taken(0, 1)
    held_out = AnnotatedTake(
        known.motion, (replace(known.annotations[0], held_out=True), known.annotations[1]), known.events
    )
    found = evaluate_moments([held_out], KnownAnswers())
    assert found["motionseek, held-out actions"]["questions"] == 1.0
    assert found["motionseek"]["questions"] == 2.0


def test_no_window_is_encoded_twice_for_many_sentences() -> None:
    one, several = KnownAnswers(), KnownAnswers()
    evaluate_moments([taken(0, 0, 1, 1, 0)], one)
    evaluate_moments([taken(0, 1, 2, 3, 4)], several)
    assert several.encoded < 1.2 * one.encoded


def test_a_cached_window_has_the_vector_of_the_encoder() -> None:
    model, features = KnownAnswers(), KnownAnswers().features(motion(0, 1, 2, seconds=2.0))
    cached = WindowCache(model)
    whole = cached.encode_windows(features, np.arange(40), 20)
    part = cached.encode_windows(features[7:], np.arange(0, 30, 2), 20)
    assert np.array_equal(part, whole[7:37:2])
    assert model.encoded == 40
    cached.keep_only(())
    assert np.array_equal(cached.encode_windows(features, np.arange(40), 20), whole)


def test_a_sequence_is_as_good_as_its_worst_step() -> None:
    truths = [[(0.0, 2.0)], [(2.0, 4.0)], [(4.0, 6.0)]]
    assert sequence_overlap([(0.0, 2.0), (2.0, 4.0), (4.0, 6.0)], truths) == 1.0
    assert sequence_overlap([(0.0, 2.0), (2.0, 3.0), (4.0, 6.0)], truths) == 0.5


def test_a_sequence_over_a_repeated_action_is_right_too_if_it_is_in_order() -> None:
    walk, sit = [(0.0, 2.0), (8.0, 10.0)], [(4.0, 6.0)]
    assert sequence_overlap([(0.0, 2.0), (4.0, 6.0), (8.0, 10.0)], [walk, sit, walk]) == 1.0
    assert sequence_overlap([(8.0, 10.0), (4.0, 6.0)], [walk, sit]) == 0.0


def test_tables_are_markdown() -> None:
    figures = evaluate_moments([taken(0, 1, 2)], KnownAnswers(), sequences=True)
    first, recall, steps = moment_tables(figures)
    assert first.splitlines()[0].startswith("| first answer, by IoU | questions | 0.1 |")
    assert "| motionseek | 3 | 100.0 |" in first
    assert "window of 20" not in recall
    assert steps.splitlines()[-1].startswith("| three steps in order | 1 | 100.0 |")
