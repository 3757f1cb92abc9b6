"""Where nothing in a library matches the steps of a sentence, it is looked for as one."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from encoders.bundle.bundle import Bundle
from search.hits import Hits
from search.library import Library

SENTENCE = "runs and then jumps"


@pytest.fixture
def library(indexed: Path, tiny_bundle: Path, monkeypatch: pytest.MonkeyPatch) -> Library:
    """A library whose hits are as strong as a test says of questions of steps and of one sentence."""
    found = Library.open(indexed, bundle=Bundle.load(tiny_bundle))
    monkeypatch.setattr(Library, "strengths", {"then": "weak", "alone": "strong"}, raising=False)

    def hits(self: Library, question: Any, *given: Any) -> Hits:
        strength = self.strengths[question.how]
        return Hits([Stub(question.sentences, strength)] if strength else [])

    monkeypatch.setattr(Library, "_moment_hits", hits)
    return found


class Stub:
    """What of a hit is looked at."""

    def __init__(self, sentences: tuple[str, ...], strength: str) -> None:
        self.sentences, self.strength, self.matched = sentences, strength, ()


@pytest.mark.parametrize(
    ("steps", "whole", "asked"),
    [
        ("plausible", "strong", ("runs", "jumps")),
        ("weak", "strong", (SENTENCE,)),
        ("", "plausible", (SENTENCE,)),  # none is strong enough
        ("weak", "weak", ("runs", "jumps")),
        ("weak", "", ("runs", "jumps")),
    ],
)
def test_the_sentence_is_looked_for_as_one_where_that_alone_matches(
    library: Library, monkeypatch: pytest.MonkeyPatch, steps: str, whole: str, asked: tuple[str, ...]
) -> None:
    monkeypatch.setattr(Library, "strengths", {"then": steps, "alone": whole})
    assert [hit.sentences for hit in library.moments(SENTENCE)] == [asked]


def test_steps_that_are_given_stay_steps(library: Library) -> None:
    assert library.moments("runs", then=["jumps"])[0].strength == "weak"
