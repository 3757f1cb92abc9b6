"""Stars, tags and collections from Python and on the command line."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest

from encoders.bundle.bundle import Bundle
from encoders.errors import ArgumentError, LibraryError, UnknownClip
from indexer.store.marks.marks_table import NO_MARKS, Marks
from search.library import Library
from tests.search.conftest import Run


@pytest.fixture
def folder(indexed: Path, tmp_path: Path) -> Path:
    return Path(shutil.copytree(indexed, tmp_path / "takes"))


@pytest.fixture
def library(folder: Path, tiny_bundle: Path) -> Library:
    return Library.open(folder, bundle=Bundle.load(tiny_bundle, threads=1))


def test_clips_are_marked_by_any_reference_and_found_by_their_marks(library: Library, folder: Path) -> None:
    hits = library.search("walks", 5)
    first, last = hits[0].clip_id, hits[-1].clip_id
    assert library.mark(hits[0], star=True, tags=["Fight  scene", "fast"]) == 1
    assert library.mark([library.clip(last), f"#{first}", folder / hits[0].path], tags="fight scene") == 2
    assert library.mark(hits[2].path, collections="Auswahl für Größe") == 1
    assert library.marks(first) == Marks(True, ("Fight scene", "fast"))
    assert library.marks(last) == Marks(tags=("Fight scene",))
    assert library.mark_counts() == {
        "starred": 1, "tags": {"fast": 1, "Fight scene": 2}, "collections": {"Auswahl für Größe": 1}
    }  # fmt: skip

    assert {hit.clip_id for hit in library.search("walks", tag="FIGHT SCENE")} == {first, last}
    assert {hit.clip_id for hit in library.moments("walks", starred=True)} == {first}
    assert len(list(library.clips(starred=False))) == 4
    (collected,) = library.clips(collection="auswahl FÜR größe")
    assert collected.id == hits[2].clip_id
    assert library.search("walks", starred=True)[0].document()["tags"] == ["Fight scene", "fast"]

    assert library.unmark([f"#{first}", f"#{last}"], star=True, tags="FIGHT scene") == 2
    assert (library.marks(first), library.marks(last)) == (Marks(tags=("fast",)), NO_MARKS)


def test_all_clips_are_marked_or_none(library: Library, tmp_path: Path) -> None:
    unindexed = tmp_path / "other.npy"
    unindexed.write_bytes(b"")
    for refs in (["take 1.npy", "nowhere.npy"], ["take 1.npy", unindexed]):
        with pytest.raises(UnknownClip):
            library.mark(refs, star=True)
    with pytest.raises(ArgumentError):
        library.mark(["take 1.npy", 7], star=True)  # type: ignore[list-item]
    assert library.mark([], star=True) == 0
    assert library.mark_counts() == {"starred": 0, "tags": {}, "collections": {}}


@pytest.mark.parametrize("name", ["", "  ", "x" * 101, "a\0b", "\ud800", 5])
def test_a_name_that_cannot_be_shown_is_refused(library: Library, name: str) -> None:
    for argument in ("tags", "collections"):
        with pytest.raises(ArgumentError, match=argument):
            library.mark("take 1.npy", **{argument: [name]})


def test_marking_needs_a_mark_and_an_open_library(library: Library) -> None:
    with pytest.raises(ArgumentError, match="star=True"):
        library.mark("take 1.npy")
    library.close()
    with pytest.raises(LibraryError):
        library.mark("take 1.npy", star=True)


def test_marks_on_the_command_line(folder: Path, run: Run) -> None:
    at = ("--library", folder)
    assert "nothing is starred" in run("tag", *at).err
    done = run("tag", "take 1.npy", folder / "take 2.npy", "--star", "--add", "fight", "--collect", "reel", *at)
    assert done.code == 0
    assert [line.split("\t")[2:] for line in done.out.splitlines()] == [
        ["take 1.npy", "starred", "fight", "reel"], ["take 2.npy", "starred", "fight", "reel"],
    ]  # fmt: skip
    run("tag", "take 1.npy", "--unstar", "--remove", "fight", "--uncollect", "reel", *at)
    assert run("tag", *at, "--json").document == {"starred": 1, "tags": {"fight": 1}, "collections": {"reel": 1}}
    assert run("tag", *at).out.splitlines() == ["star\t\t1", "tag\tfight\t1", "collection\treel\t1"]
    (found,) = run("list", "--tag", "fight", *at, "--json").document["clips"]
    assert (found["path"], found["starred"], found["tags"]) == ("take 2.npy", True, ["fight"])
    assert [hit["path"] for hit in run("search", "x", "--starred", *at, "--json").document["hits"]] == ["take 2.npy"]


def test_wrong_usage_says_what_to_do(folder: Path, run: Run) -> None:
    at = ("--library", folder)
    assert "name a clip" in run("tag", "--star", *at).err
    run("tag", "take 1.npy", "--add", "fight", *at)
    assert "no clip passes tag='fihgt'; there are fight" in run("search", "x", "--tag", "fihgt", *at).err
    assert "no clip has a star" in run("list", "--starred", *at).err
    assert run("tag", "take 9.npy", "--star", *at).code == 1
