"""A sentence and a motion asked for together."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from encoders.errors import ArgumentError
from search.library import Library
from search.query.mixed import difference_of, mixed
from search.query.question import EncodedQuestion
from tests.search.conftest import Run


@pytest.mark.parametrize(
    ("sentence", "left"),
    [
        ("like this but slower", "slowly"),
        ("Like that one, but with the left hand", "with the left hand"),
        ("the same only faster", "fast"),
        ("a person walks like a robot", "a person walks like a robot"),
    ],
)
def test_what_shall_be_different_is_left_of_a_sentence(sentence: str, left: str) -> None:
    assert difference_of(sentence) == left


def test_the_weight_leads_from_the_motion_to_the_sentence(indexed: Path, tiny_bundle: Path) -> None:
    from encoders.bundle.bundle import Bundle

    with Library.open(indexed, bundle=Bundle.load(tiny_bundle)) as library:
        clip = next(library.clips())
        by_text = library.search("slowly", 100, like=clip, weight=1, min_strength="weak")
        by_motion = library.search("slowly", 100, like=clip, weight=0, min_strength="weak")
        expected = library.search(library.bundle.encode_motions([library.motion(clip.id)])[0], 100, min_strength="weak")
        others = [(hit.clip_id, hit.score) for hit in expected if hit.clip_id != clip.id]
        assert [hit.clip_id for hit in by_motion] == [number for number, _ in others]
        assert np.allclose([hit.score for hit in by_motion], [score for _, score in others], atol=1e-5)
        assert [hit.score for hit in by_text] != [hit.score for hit in by_motion]
        cut = library.search("slowly", 100, like=clip, start=0.5, end=1.5, weight=0, min_strength="weak")
        alike = library.bundle.encode_motions([library.motion(clip.id, 0.5, 1.5)])[0]
        expected = library.search(alike, 100, min_strength="weak")
        assert [hit.clip_id for hit in cut] == [hit.clip_id for hit in expected if hit.clip_id != clip.id]
        with pytest.raises(ArgumentError, match="start and end are a span of like"):
            library.search("slowly", start=0.5)
        with pytest.raises(ArgumentError, match="weight"):
            library.search("slowly", like=clip, weight=2)


def test_the_command_takes_a_clip_and_a_weight(run: Run, indexed: Path) -> None:
    found = run("search", "like this but slower", "--like", "take 2.npy", "--library", indexed, "--json", "--all")
    assert "take 2.npy" not in {hit["path"] for hit in found.document["hits"]}
    assert run("search", "walks", "--weight", "0.5", "--library", indexed).code == 2


@pytest.mark.parametrize(("weight", "kind"), [(0, "motion"), (0.5, "mixed"), (1, "sentence")])
def test_strength_is_not_said_by_a_curve_of_other_questions(weight: float, kind: str) -> None:
    assert mixed(EncodedQuestion(np.eye(1, 4, dtype=np.float32)), np.eye(4, dtype=np.float32)[1], weight).kind == kind
