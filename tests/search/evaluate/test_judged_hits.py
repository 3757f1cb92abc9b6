"""Hits whose right answers are known: of all motions, and of an archive without the right ones."""

from __future__ import annotations

import numpy as np
import pytest

from encoders.corpus.composition.captioned_motion import CaptionedSpan, CaptionedTake
from indexer.datasets.questioned_archives import QuestionedArchive, questioned_takes
from search.evaluate.judged_hits import judged_hits
from tests.search.answers import KnownAnswers, motion

UNRELATED = np.eye(6)[[4, 5]]


def test_each_question_is_asked_of_all_motions_and_of_those_that_are_not_right() -> None:
    archive = QuestionedArchive(
        [motion(1, seconds=4), motion(2, seconds=4), motion(2, seconds=4)], ["one", "two", "two"], [("two", "two")]
    )
    hits = judged_hits(KnownAnswers(), archive, UNRELATED)
    assert hits.right.tolist() == [True, True, False, False]
    assert hits.left_out.tolist() == [False, False, False, True]
    assert set(hits.clip[:2].tolist()) == {1, 2}
    assert hits.clip[3] == 0
    assert hits.peaks == pytest.approx([1, 1, 0, 0], abs=1e-3)
    assert hits.statistics[0] == pytest.approx([1, 1 / 1e-3], abs=1)  # nothing unrelated scores anything


def test_takes_of_one_description_answer_its_captions_and_unknown_ones_are_not_asked() -> None:
    def take(about: str, *captions: str) -> CaptionedTake:
        return CaptionedTake("a.bvh", "1", motion(1), about, (CaptionedSpan(captions, 0.0, 1.0),))

    archive = questioned_takes([take("one", "a", "b"), take("unknown", "c"), take("one", "b")])
    assert archive.questions == [("one", "a"), ("one", "b"), ("one", "one")]
    assert archive.right.tolist() == [[True, False, True]] * 3
