"""What a question takes away goes down in search and moments, on every page, on the command line and over HTTP."""

from __future__ import annotations

from pathlib import Path

import pytest

from indexer.ingest.arrays import NewClip
from search.library import Library
from search.query.question import Question
from tests.search.answers import KnownAnswers, motion
from tests.search.conftest import Run


@pytest.fixture
def library(tmp_path: Path) -> Library:
    """Clips of one kind, with and without another."""
    library = Library.open(tmp_path / "library", bundle=KnownAnswers(), create=True)
    library.add_many(
        [
            NewClip("both", motion(1, 2, 1, 2, seconds=4)),
            NewClip("alone", motion(1, 4, 1, 4, seconds=4)),
            NewClip("neither", motion(3, 4, seconds=8)),
        ]
    )
    return library


@pytest.mark.parametrize("question", ["one -two", "one, not two", "one but not two"])
def test_clips_with_what_is_taken_away_come_after_those_without(library: Library, question: str) -> None:
    plain = {hit.path: hit.score for hit in library.search("one")}
    found = library.search(question)
    scores = {hit.path: hit.score for hit in found}
    assert plain["both"] == pytest.approx(plain["alone"], abs=1e-3)
    assert found[0].path == "alone"
    assert scores["both"] < scores["alone"] - 0.05


def test_pages_are_parts_of_one_ranking(library: Library) -> None:
    whole = library.search("one -two", 3)
    assert [library.search("one -two", k)[-1] for k in (1, 2, 3)] == list(whole)


def test_a_moment_is_where_only_what_is_asked_for_happens(library: Library) -> None:
    for hit in library.moments("one -two", "both", k=1):
        assert hit.end - hit.start < 5, "the second is left out"
    steps = library.moments(None, "both", then=["one -two", "two -one"])[0].steps
    assert steps[0].end <= steps[1].start + 1


def test_words_that_are_taken_away_are_in_no_name(library: Library) -> None:
    assert [hit.path for hit in library.search("alone -two") if hit.matched] == ["alone"]


def test_amounts_and_known_words_are_those_of_what_is_asked_for() -> None:
    question = Question.of("jumps, not three times").encode(KnownAnswers())
    assert question.wanted == ("jumps",)


def test_the_command_says_what_is_taken_away_and_how_a_minus_is_given(run: Run, indexed: Path) -> None:
    found = run("search", "walks -left", "--library", indexed, "--json")
    assert found.document["without"] == ["left"]
    assert "without" not in run("search", "walks left", "--library", indexed, "--json").document
    assert run("moments", "--library", indexed, "--json", "--", "-left kicks").document["without"] == ["left"]
    for given, said in ((["-left kicks"], 'search [OPTIONS] -- "-left kicks"'), (["kicks", "-left"], '"kicks -left"')):
        ran = run("search", *given, "--library", indexed)
        assert (ran.code, ran.err.count("\n")) == (2, 1)
        assert said in ran.err
    assert "'-q'" in run("search", "kicks", "-q", "--library", indexed).err, "one letter is an option"


def test_sentences_stay_what_they_are() -> None:
    assert Question.of("walks without turning, then sits -left").sentences == ("walks without turning", "sits -left")
