"""Names, folders, captions, tags and collections are found in one ranking with meanings."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from encoders.bundle.bundle import Bundle
from indexer.ingest.arrays import NewClip
from search.library import Library
from search.ranking.clip_scores import ClipScore
from search.ranking.text_matches import TextMatch, fused, words_of
from tests.search.conftest import made_motion

CLIPS = {
    "fights/HeroKick_01": "",
    "fights/HeroKick_02": "kicks high with the right leg",
    "fights/kick": "",
    "walks/slow/take_0016": "a person walks slowly",
    "walks/take_016": "",
    "Würfe/weit 7": "",
}


class Knowing(Bundle):
    """The tiny model, which knows the words of some movements."""

    calibration = {"words": np.array(sorted(["kick", "walk", "slow", "right", "leg", "high"]))}  # noqa: RUF012


@pytest.fixture(scope="module")
def library(tmp_path_factory: pytest.TempPathFactory, tiny_bundle: Path) -> Library:
    bundle = Knowing.load(tiny_bundle, threads=1)
    library = Library.open(tmp_path_factory.mktemp("named"), bundle=bundle, create=True)
    library.add_many(NewClip(path, made_motion(3, i), text) for i, (path, text) in enumerate(CLIPS.items()))
    library.mark("Würfe/weit 7", tags="ball games", collections="Reel 2026")
    return library


def found(library: Library, query: str, **filters: Any) -> list[tuple[str, tuple[str, ...]]]:
    """What has the words of a question, and where, as far as it comes first."""
    hits = library.search(query, 6, **filters)
    matched = [(hit.path, hit.matched) for hit in hits if hit.matched]
    assert len({hit.clip_id for hit in hits}) == len(hits)
    return matched


@pytest.mark.parametrize("path", CLIPS)
def test_a_clip_is_the_first_hit_for_its_name_and_path(library: Library, path: str) -> None:
    name = path.rpartition("/")[2]
    for query in (path, name, name.upper(), f" {name} ", f"#{library.find(path).id}"):
        hit = library.search(query, 1)[0]
        assert (hit.path, hit.matched[0]) == (path, "name"), query


@pytest.mark.parametrize(
    ("query", "expected"),
    [
        ("hero", [("fights/HeroKick_01", ("name",)), ("fights/HeroKick_02", ("name",))]),
        ("herok", [("fights/HeroKick_01", ("name",)), ("fights/HeroKick_02", ("name",))]),
        ("take_0016", [("walks/slow/take_0016", ("name",))]),
        ("fights 01", [("fights/HeroKick_01", ("folder",))]),
        ("wurfe", [("Würfe/weit 7", ("folder",))]),
        ("games ball", [("Würfe/weit 7", ("tag",))]),
        ("reel", [("Würfe/weit 7", ("collection",))]),
        ("Fights", [(f"fights/{name}", ("folder",)) for name in ("HeroKick_01", "HeroKick_02", "kick")]),
        ("somewhere else", []),
    ],
)
def test_what_is_no_description_is_looked_for_in_names_folders_tags_and_collections(
    library: Library, query: str, expected: list[tuple[str, tuple[str, ...]]]
) -> None:
    hits = library.search(query, 6)
    first = [(hit.path, hit.matched) for hit in hits[: len(expected)]]
    assert sorted(first) == expected
    assert not any(hit.matched for hit in hits[len(expected) :])


def test_a_description_is_found_in_captions_in_any_form_and_only_with_all_its_words(library: Library) -> None:
    assert ("fights/HeroKick_02", ("caption",)) in found(library, "a person is kicking with the right leg")
    assert found(library, "a person kicks with the left leg") == []
    assert ("walks/slow/take_0016", ("folder", "caption")) in found(library, "the man walks slow")
    assert {path for path, _ in found(library, "kick")} == {p for p in CLIPS if "ick" in p}


def test_filters_hold_for_what_is_found_by_name(library: Library) -> None:
    assert found(library, "hero", path="walks/*") == []
    assert found(library, "HeroKick_01", path="*_02") == []
    assert [path for path, _ in found(library, "hero", path="*_02")] == ["fights/HeroKick_02"]


def test_pages_are_parts_of_one_ranking(library: Library) -> None:
    everything = library.search("kick", 6)
    for k in range(1, 6):
        assert library.search("kick", k) == everything[:k]


@pytest.mark.parametrize("query", ['"', "AND", "kick OR", "NEAR(kick)", "kick*", "-kick", "(", "a b c d e f g " * 20])
def test_no_question_is_taken_for_an_expression(library: Library, query: str) -> None:
    if any(letter.isalnum() for letter in query):
        library.search(query, 3)


def test_a_weak_hit_that_was_found_by_name_is_a_match(library: Library) -> None:
    from dataclasses import replace

    hits = library.search("hero", 2)
    hits[:] = [replace(hit, strength="weak") for hit in hits]
    assert not hits.nothing_matches
    hits[:] = [replace(hit, matched=()) for hit in hits]
    assert hits.nothing_matches


def test_text_lifts_a_clip_by_as_much_as_it_says() -> None:
    meaning = [ClipScore(1, 0.9), ClipScore(2, 0.5), ClipScore(3, 0.45), ClipScore(4, 0.1)]
    matches = {3: TextMatch(("caption",), 0.1), 4: TextMatch(("name",), 0.1)}
    order = fused(iter(meaning), [meaning[2], meaning[3]], matches)
    assert [score.clip_id for score in order] == [1, 3, 2, 4]


def test_articles_and_subjects_are_no_words() -> None:
    assert words_of("A person waves, then walks to the (left).") == ["waves", "then", "walks", "left"]
    assert words_of("the man is a") == []
