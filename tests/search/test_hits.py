"""Hits: what they say of themselves, and how they show themselves in a notebook."""

from __future__ import annotations

import dataclasses
import pickle
from pathlib import Path

import pytest

from encoders.bundle.bundle import Bundle
from search.hits import Hit, Hits
from search.library import Library
from search.spans import Moment


@pytest.fixture
def library(indexed: Path, tiny_bundle: Path) -> Library:
    return Library.open(indexed, bundle=Bundle.load(tiny_bundle, threads=1))


def test_every_question_answers_with_hits_that_show_themselves(library: Library) -> None:
    with library:
        for found in (
            library.search("walks", 3),
            library.moments("walks", k=3),
            library.moments("walks", "take 2", 3),
            library.similar("take 1", 3),
        ):
            assert isinstance(found[:2], Hits)
            html = found[:3]._repr_html_()
            assert html is not None
            assert html.count("data-motionseek=") == len(found) > 0
            assert html.count("<script>") == 1


def test_a_hit_shows_its_own_span(library: Library) -> None:
    with library:
        hit = library.source("take 3").hit(1, Moment(2.0, 5.5, 0.4), "")
        assert hit.read is not None
        assert hit.read().duration == pytest.approx(hit.end - hit.start, abs=0.06)
        html = hit._repr_html_()
    assert html is not None
    assert f"{hit.start:.1f}–{hit.end:.1f} s" in html


def test_after_the_library_is_closed_only_text_is_left(library: Library) -> None:
    with library:
        found = library.search("walks", 2)
    assert found[0]._repr_html_() is None
    assert Hits(found)._repr_html_() is None


def test_a_hit_of_nothing_that_can_be_read_is_text() -> None:
    hit = Hit(1, "a.bvh", 0.5, "", 0, 1, 1)
    assert hit._repr_html_() is None
    assert "read" not in repr(hit)


def test_hits_are_equal_when_they_say_the_same(library: Library) -> None:
    with library:
        assert library.search("walks", 2) == library.search("walks", 2)
        assert dataclasses.asdict(library.search("walks", 1)[0])["rank"] == 1


def test_a_long_list_says_how_many_it_leaves_out(library: Library) -> None:
    with library:
        html = Hits(library.search("walks", 1) * 30)._repr_html_()
    assert html is not None
    assert html.count("data-motionseek=") == 24
    assert "and 6 more" in html


def test_two_files_of_one_name_are_told_apart_by_number_and_root(library: Library) -> None:
    with library:
        hit = library.search("walks", 1)[0]
        clip = library.clip(hit.clip_id)
    assert (hit.path, hit.root, hit.file) == (clip.path, clip.root.name, clip.file)
    assert hit.document()["clip"] == hit.clip_id
    assert hit.document()["root"] == hit.root


def test_the_document_of_a_motion_that_is_not_indexed_names_no_clip() -> None:
    document = Hit(1, "a.bvh", 0.5, "", 0, 1, 1).document()
    assert document["clip"] is None
    assert document["root"] is None


def test_a_pickled_hit_says_the_same_and_reads_nothing(library: Library) -> None:
    with library:
        found = library.moments("walks, then sits", k=2)
        again = pickle.loads(pickle.dumps(found))
    assert again == found
    assert isinstance(again, Hits)
    assert again[0].read is None
    assert hash(again[0]) == hash(found[0])


def test_hits_become_dicts_and_a_table(library: Library) -> None:
    with library:
        found = library.search("walks", 3)
    assert found.to_dicts() == [hit.document() for hit in found]
    pandas = pytest.importorskip("pandas")
    table = found.to_pandas()
    assert isinstance(table, pandas.DataFrame)
    assert table["path"].tolist() == [hit.path for hit in found]
    empty = Hits([]).to_pandas()
    assert (len(empty), list(empty.columns)) == (0, list(table.columns))


def test_nothing_matches_where_all_hits_are_weak() -> None:
    weak, plausible = (Hit(1, "a.bvh", 0.5, strength, 0, 1, 1) for strength in ("weak", "plausible"))
    assert Hits([weak, weak]).nothing_matches
    assert not Hits([plausible, weak]).nothing_matches
    assert not Hits().nothing_matches
