"""The answer cache: growth invalidates stale answers, and no others."""

from __future__ import annotations

import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from starlette.testclient import TestClient

from encoders.bundle.bundle import Bundle
from indexer.ingest import indexing
from search.library import Library
from search.server.answer_cache import AnswerCache, StaleCriterion
from search.server.app import create_app
from search.server.responses import JsonAnswer
from search.server.snapshot_library import SnapshotLibrary
from tests.search.conftest import made_motion

EAST, NORTH = np.array([1, 0], np.float32), np.array([0, 1], np.float32)


def highest(added: list[list[float]]) -> Callable[[np.ndarray], np.ndarray]:
    """The highest score of clips with these vectors."""
    return lambda queries: np.max([np.full(len(queries), -np.inf), *(queries @ row for row in added)], axis=0)


def two_answers() -> AnswerCache:
    """Two answers of generation 1, to a query east and to one north."""
    answers = AnswerCache(1)
    answers.put("east", JsonAnswer("e"), StaleCriterion(EAST, 0.6), 1)
    answers.put("north", JsonAnswer("n"), StaleCriterion(NORTH, 0.6), 1)
    return answers


@pytest.mark.parametrize(
    ("added", "valid"),
    [([], "en"), ([[0.5, 0.5]], "en"), ([[0.6, 0.1]], "n"), ([[0.1, 0.2], [0.0, 1.0]], "e"), ([[1, 0], [0, 1]], "")],
)
def test_an_added_clip_that_scores_as_much_as_the_last_hit_invalidates(added: list[list[float]], valid: str) -> None:
    answers = two_answers()
    answers.grow(2, highest(added), lambda words: False)
    assert [name for name in ("east", "north") if answers.get(name)] == [
        name for name in ("east", "north") if name[0] in valid
    ]


def test_an_answer_of_an_older_generation_is_not_cached() -> None:
    answers = two_answers()
    answers.grow(2, highest([]), lambda words: False)
    answers.put("late", JsonAnswer("l"), StaleCriterion(EAST, 0.0), 1)
    assert answers.get("late") is None
    assert len(answers) == 2


def test_a_clip_that_was_added_under_a_name_with_the_words_invalidates(
    indexed: Path, bundle: Bundle, tmp_path: Path
) -> None:
    folder = Path(shutil.copytree(indexed, tmp_path / "takes"))
    library = SnapshotLibrary.open(folder, bundle=bundle)
    library.start = lambda: None  # type: ignore[method-assign]  # refreshed by hand
    with TestClient(create_app(library), base_url="http://127.0.0.1:8420") as client:

        def named(query: str) -> list[dict[str, Any]]:
            hits = client.get("/api/search", params={"q": query, "k": 20}).json()["hits"]
            return [hit for hit in hits if hit["matched"]]

        def names(query: str) -> list[str]:
            return [hit["path"] for hit in named(query)]

        assert names("zorros") == names("limping captains") == []
        np.save(folder / "Zorro_01.npy", made_motion(3.0, 44).joints)
        np.save(folder / "other.npy", made_motion(3.0, 45).joints)
        (folder / "other.txt").write_text("the captain limps\n")
        indexing.index(folder, bundle=bundle, jobs=1)
        library.refresh()
        assert (names("zorros"), names("limping captains")) == (["Zorro_01.npy"], ["other.npy"])
        library.mark("Zorro_01.npy", tags="masks", star=True)
        library.refresh()
        assert names("masks") == ["Zorro_01.npy"]
        assert named("zorros")[0]["starred"]


def test_the_least_recently_used_are_evicted() -> None:
    answers = AnswerCache(1, size=2)
    for key in ("a", "b"):
        answers.put(key, JsonAnswer(""), StaleCriterion(EAST, 0.0), 1)
    answers.get("a")
    answers.put("c", JsonAnswer(""), StaleCriterion(EAST, 0.0), 1)
    assert [key for key in "abc" if answers.get(key) is not None] == ["a", "c"]


def test_cached_answers_are_those_of_a_fresh_search(indexed: Path, bundle: Bundle, tmp_path: Path) -> None:
    folder = tmp_path / "takes"
    shutil.copytree(indexed, folder)
    library = SnapshotLibrary.open(folder, bundle=bundle)
    library.start = lambda: None  # type: ignore[method-assign]  # refreshed by hand
    questions = [f"{subject} {verb}" for subject in ("", "a person", "someone") for verb in ("walks", "jumps", "sits")]
    valid = []
    with TestClient(create_app(library), base_url="http://127.0.0.1:8420") as client:

        def answers() -> dict[str, list[dict[str, object]]]:
            return {q: client.get("/api/search", params={"q": q, "k": 2}).json()["hits"] for q in questions}

        before = answers()
        # Captions of clips that are not there yet invalidate nothing.
        rows = "".join(f"new {seed}.npy\tsomeone moves\n" for seed in range(5))
        (folder / "captions.tsv").write_text(f"path\ttext\n{rows}", encoding="utf-8")
        for seed in range(5):
            np.save(folder / f"new {seed}.npy", made_motion(3.0 + seed, 200 + seed).joints)
            if seed == 3:
                (folder / "new 2.npy").unlink()  # the newest of the clips
            if seed == 4:
                (folder / "take 1.txt").write_text("a person hops\n", encoding="utf-8")
            indexing.index(folder, bundle=bundle, jobs=1)
            assert library.refresh()
            valid.append(len(library.answer_cache))
            after = answers()
            with Library.open(folder, bundle=bundle) as fresh:
                assert after == {q: fresh.search(q, 2).to_dicts() for q in questions}
    assert before != after
    assert max(valid) > 0
    assert valid[3] == 0  # the removed clip may have displaced another
    assert valid[-1] == 0  # a caption of an older clip has changed


@pytest.mark.parametrize(
    "later",
    [
        ["take 2.npy\tsomeone turns", "take 0.npy\tsomeone bends"],
        ["take 0.npy\tsomeone bends", "take 2.npy\tsomeone turns"],
        ["take 0.npy\tsomeone turns", "take 2.npy\tsomeone bows"],
    ],
)
def test_swapped_captions_invalidate(indexed: Path, bundle: Bundle, tmp_path: Path, later: list[str]) -> None:
    folder = tmp_path / "takes"
    shutil.copytree(indexed, folder)

    def say(rows: list[str]) -> None:
        (folder / "captions.tsv").write_text("\n".join(["path\ttext", *rows]), encoding="utf-8")
        indexing.index(folder, bundle=bundle, jobs=1)

    say(["take 0.npy\tsomeone turns", "take 2.npy\tsomeone bends"])
    library = SnapshotLibrary.open(folder, bundle=bundle)
    library.start = lambda: None  # type: ignore[method-assign]  # refreshed by hand
    with TestClient(create_app(library), base_url="http://127.0.0.1:8420") as client:
        for _ in range(2):
            hits = client.get("/api/search", params={"q": "walks"}).json()["hits"]
            with Library.open(folder, bundle=bundle) as fresh:
                assert hits == fresh.search("walks").to_dicts()
            say(later)
            assert library.refresh()
