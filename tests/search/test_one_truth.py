"""One truth: search, moments of a clip and moments across the library say the same of a clip."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

from encoders.errors import ArgumentError
from indexer.ingest.arrays import NewClip
from search.hits import Hit
from search.library import Library
from search.moments.one_motion import find
from search.query.question import EncodedQuestion
from search.ranking.answers import Answer, as_hits
from search.source import MotionSource
from search.spans import Moment
from tests.search.answers import SENTENCES, KnownAnswers, motion
from tests.search.fakes import MeanEncoder, queried, take

#: Strong from 0.7 on, plausible from 0.4.
CALIBRATION = {
    "motions": np.eye(len(SENTENCES), dtype=np.float16)[[0, 5] * 20],
    "sentence_coefficients": np.array([-4.0, 6.3, 0.0]),
    "motion_coefficients": np.array([-4.0, 6.3, 0.0]),
}


@pytest.fixture
def library(tmp_path: Path) -> Library:
    """Clips of one kind, of several after one another, and of none that is asked for."""
    library = Library.open(tmp_path / "library", bundle=KnownAnswers(CALIBRATION), create=True)
    library.add_many(
        [
            NewClip("whole", motion(1, seconds=6)),
            NewClip("ends with it", motion(2, 3, 1, seconds=5)),
            NewClip("in between", motion(4, 1, 4, 1, 2, seconds=4)),
            NewClip("something else", motion(2, 4, seconds=5)),
        ]
    )
    return library


def span(hit: Hit) -> tuple[str, float, float, str]:
    return hit.path, hit.start, hit.end, hit.strength


def test_a_hit_of_search_is_the_first_moment_of_its_clip(library: Library) -> None:
    hits = library.search("one", min_strength="weak")
    assert len(hits) == 4
    for hit in hits:
        assert span(hit) == span(library.moments("one", f"#{hit.clip_id}", min_strength="weak")[0])


def test_moments_across_the_library_are_those_of_their_clips(library: Library) -> None:
    found = library.moments("one", k=20, min_strength="weak")
    assert {hit.path for hit in found} == {"whole", "ends with it", "in between", "something else"}
    assert len({span(hit) for hit in found}) == len(found)
    for hit in found:
        assert span(hit) in map(span, library.moments("one", f"#{hit.clip_id}", 50, min_strength="weak"))


def test_weak_hits_are_listed_only_where_none_is_better_or_they_are_asked_for(library: Library) -> None:
    assert {hit.strength for hit in library.search("one")} == {"strong"}
    assert {hit.strength for hit in library.search("one", min_strength="weak")} == {"strong", "weak"}
    assert len(library.search("zero")) == 4, "all are weak"
    assert library.search("zero").nothing_matches
    assert library.search("zero", min_strength="plausible") == []
    with pytest.raises(ArgumentError, match="min_strength='good' must be one of weak, plausible, strong"):
        library.search("one", min_strength="good")


def test_the_list_does_not_depend_on_how_long_a_part_of_it_is_wanted() -> None:
    encoder, source = KnownAnswers(CALIBRATION), MotionSource.of_motion(motion(1, seconds=99))
    question = EncodedQuestion(encoder.encode_texts(["one"]), ("one",))
    peaks = np.random.default_rng(0).choice([0.1, 0.5, 0.9], 300, p=[0.7, 0.2, 0.1])
    peaks[0], looked_at = 0.9, []

    def answers() -> list[Answer]:
        return [Answer(source, Moment(i / 10, i / 10 + 1, peak), (peak,)) for i, peak in enumerate(peaks)]

    every = as_hits(encoder, question, answers(), 300)
    assert {hit.strength for hit in every} == {"strong", "plausible"}
    for k in (1, 3, 10):
        assert as_hits(encoder, question, answers(), k) == every[:k]
    as_hits(encoder, question, (looked_at.append(a) or a for a in answers()), 2)
    assert len(looked_at) < 40, "no more are refined than needed"


def test_no_moment_contains_another() -> None:
    for seed in range(5):
        found = [answer.moment for answer in find(queried(take(60, (5, 25, 1), (30, 34, 1), seed=seed), 1))]
        assert not any(a is not b and b.start <= a.start and a.end <= b.end for a in found for b in found)


@pytest.mark.parametrize(("weakest", "strength"), [(0.9, "strong"), (0.5, "plausible"), (0.1, "weak")])
def test_steps_are_as_strong_as_the_weakest(weakest: float, strength: str) -> None:
    encoder, source = KnownAnswers(CALIBRATION), MotionSource.of_motion(motion(1, seconds=9))
    question = EncodedQuestion(encoder.encode_texts(["one", "two", "three"]), ("one", "two", "three"), "then")
    answer = Answer(source, Moment(0, 9, 0.8), (0.95, weakest, 0.9))
    assert as_hits(encoder, question, [answer], 1)[0].strength == strength


@pytest.mark.parametrize("seconds", [5.03, 7.07, 9.09])
def test_steps_lie_inside_their_hit_and_the_motion(seconds: float) -> None:
    asked = queried(take(seconds, (0, 2, 1), (2, seconds, 2)), 1, 2, encoder=MeanEncoder())
    (answer,) = find(replace(asked, question=replace(asked.question, how="then")))
    hit = answer.source.hit(1, answer.moment, "", answer.steps)
    assert hit.start <= hit.steps[0].start
    assert hit.steps[-1].end <= hit.end <= asked.source.duration
    assert all(a.end <= b.start for a, b in pairwise(hit.steps))
