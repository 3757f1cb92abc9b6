"""The protocol of captioned archives, on a model whose answers are known."""

from __future__ import annotations

import pytest

from encoders.corpus.composition.captioned_motion import CaptionedSpan, CaptionedTake
from encoders.errors import QueryError
from search.evaluate.captioned_archive import evaluate_captions
from tests.search.answers import KnownAnswers, motion


def take(kind: int, description: str, *captions: str) -> CaptionedTake:
    spans = (CaptionedSpan(captions, 0.0, 1.0),) if captions else ()
    return CaptionedTake(f"{kind}.bvh", str(kind), motion(kind), description, spans)


def test_rank_of_the_best_file_with_the_description() -> None:
    takes = [take(0, "zero"), take(1, "zero"), take(2, "two", "two", "one"), take(3, "unknown"), take(4, "")]
    report = evaluate_captions(takes, KnownAnswers())
    assert report.files == 5
    assert report.ranks == {"zero": [0.0], "two": [0.0, 2.5]}, "four files tie behind the first for 'one'"
    assert report.recall(1) == pytest.approx(100 * (1 + 0.5) / 2), "each description counts once"
    assert report.recall(5) == 100.0
    assert report.as_dict()["ranks"] == {"zero": [1.0], "two": [1.0, 3.5]}


def test_a_caption_of_several_files_is_one_query() -> None:
    takes = [take(0, "zero", "zero", "one"), take(0, "zero", "one")]
    assert len(evaluate_captions(takes, KnownAnswers()).ranks["zero"]) == 2


@pytest.mark.parametrize("takes", [[], [take(0, "unknown")]])
def test_an_archive_without_descriptions_is_an_error(takes: list[CaptionedTake]) -> None:
    with pytest.raises(QueryError, match="has a description"):
        evaluate_captions(takes, KnownAnswers())


def test_the_first_sentence_for_a_motion_is_counted_by_description() -> None:
    takes = [take(0, "zero"), take(1, "two"), take(2, "two"), take(3, "three")]
    report = evaluate_captions(takes, KnownAnswers())
    assert report.motion_to_sentence == pytest.approx(100 * (0.5 + 1 + 1) / 3), "one file of 'two' is like no sentence"
    assert report.motion_to_sentence_by_cosine == report.motion_to_sentence
