"""Moment retrieval on a model whose answers are known."""

from __future__ import annotations

from dataclasses import replace

import pytest

from encoders.corpus.composition.long_takes import AnnotatedTake, Event, annotated_take
from search.evaluate.moment_retrieval import evaluate_moments
from tests.search.answers import SENTENCES, KnownAnswers, motion


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


class Questioned(KnownAnswers):
    """Remembers what it is asked to encode."""

    def __init__(self) -> None:
        super().__init__()
        self.asked: list[tuple[str, ...]] = []

    def encode_texts(self, sentences):
        self.asked.append(tuple(sentences))
        return super().encode_texts(["zero"] * len(sentences))


def test_the_papers_windows_are_asked_with_the_sentences_as_they_are() -> None:
    take = annotated_take(motion(0, 1, seconds=4.0), [Event("walks", (0.0, 4.0), frozenset({"walks"}))])
    as_search_does, as_the_paper_does = Questioned(), Questioned()
    evaluate_moments([take], as_search_does)
    evaluate_moments([take], as_the_paper_does, plain_windows=True)
    assert ("walks",) not in as_search_does.asked, "it asks with paraphrases"
    assert ("walks",) in as_the_paper_does.asked
