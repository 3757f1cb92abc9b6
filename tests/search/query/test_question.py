"""Questions: how sentences go together, and what cannot be asked."""

from __future__ import annotations

import pytest

from encoders.errors import QueryError
from search.query.question import Question


def test_a_question_says_how_its_sentences_go_together() -> None:
    assert Question.of("a person waves").how == "alone"
    assert Question.of("walks, then sits") == Question(("walks", "sits"), "then", "walks, then sits")
    assert Question.of("walks, then sits", split_steps=False).how == "alone"
    assert Question.of(None, ["walks", "sits"]).sentences == ("walks", "sits")
    assert Question.of("walks", meanwhile=["waves"]) == Question(("walks", "waves"), "while")


@pytest.mark.parametrize("sentence", ["", "  ", "?!", None])
def test_an_empty_question_cannot_be_asked(sentence: str | None) -> None:
    with pytest.raises(QueryError, match="empty"):
        Question.of(sentence)


@pytest.mark.parametrize("name", ["steps", "meanwhile"])
def test_one_string_is_no_list_of_sentences(name: str) -> None:
    with pytest.raises(QueryError, match="list of sentences"):
        Question.of("walks", **{name: "waves"})


def test_a_sentence_is_text() -> None:
    with pytest.raises(QueryError, match="string"):
        Question.of(3)


@pytest.mark.parametrize("name", ["sentence", "steps", "meanwhile"])
def test_a_question_has_a_greatest_length(name: str) -> None:
    long = "walks " * 400
    given = long if name == "sentence" else [long]
    with pytest.raises(QueryError, match="2400 characters; ask in at most 2000"):
        Question.of(**{"sentence": "walks", name: given})  # type: ignore[arg-type]
    assert Question.of("walks and " * 200).sentences


def test_a_question_has_few_sentences() -> None:
    with pytest.raises(QueryError, match="101 sentences are more than 100"):
        Question.of(None, ["walks"] * 101)
