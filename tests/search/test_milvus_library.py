"""A collection of Milvus answers as the library that filled it, from a process that has nothing of that library."""

from __future__ import annotations

import shutil
from collections.abc import Iterator
from contextlib import closing
from pathlib import Path
from typing import Any

import numpy as np
import pytest

pytest.importorskip("milvus_lite")

from encoders.bundle.bundle import Bundle
from encoders.errors import ArgumentError, BundleMismatch, LibraryError, LibraryNotFound, QueryError, UnknownClip
from indexer.shards.in_step import bring_in_step
from indexer.shards.pose_files import PoseFiles
from indexer.shards.shard import WHOLE
from indexer.vectors.milvus.milvus_address import MilvusAddress
from indexer.vectors.milvus.milvus_collection import MilvusCollection
from search.hits import Hits
from search.library import Library
from search.milvus_library import MilvusLibrary


@pytest.fixture(scope="module")
def bundle(tiny_bundle: Path) -> Bundle:
    return Bundle.load(tiny_bundle, threads=1)


@pytest.fixture(scope="module")
def local(indexed: Path, bundle: Bundle, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Library]:
    """The library on disk; two of its clips are marked."""
    folder = tmp_path_factory.mktemp("local") / indexed.name
    shutil.copytree(indexed, folder)
    with Library.open(folder, bundle=bundle) as library:
        library.mark("take 1.npy", star=True, tags=["Kämpfe"])
        library.mark("take 3.npy", tags=["kämpfe", "reel"], collections=["Best of"])
        yield library


@pytest.fixture(scope="module")
def place(local: Library, bundle: Bundle, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A file of milvus-lite, filled from it, and a folder of poses beside."""
    folder = tmp_path_factory.mktemp("far away")
    made = (bundle.fingerprint, bundle.name, bundle.latent_size)
    with closing(MilvusCollection(MilvusAddress.of(folder / "vectors.db"), create=made)) as collection:
        sent = bring_in_step(local, collection, WHOLE, poses=PoseFiles(folder / "poses"))
    assert (sent.put, sent.removed, sent.refused) == (5, 0, [])
    return folder


@pytest.fixture(scope="module")
def distant(place: Path, bundle: Bundle) -> Iterator[MilvusLibrary]:
    """The same library, out of the collection alone."""
    with MilvusLibrary(str(place / "vectors.db"), bundle=bundle, poses=place / "poses") as library:
        yield library


def shown(hits: Hits) -> list[Any]:
    """All that a hit says but the number and the file, which a collection has in its own way."""
    return [
        (hit.path, round(hit.score, 4), hit.strength, round(hit.start, 4), round(hit.end, 4), hit.duration, hit.caption,
         hit.root, hit.source_fps, hit.first_frame, hit.last_frame, hit.marks, [step.text for step in hit.steps])
        for hit in hits
    ]  # fmt: skip


@pytest.mark.parametrize("sentence", ["a person walks", "someone waves with both hands", "turns left", "take 3"])
def test_a_sentence_finds_the_same_clips(local: Library, distant: MilvusLibrary, sentence: str) -> None:
    want = local.search(sentence, k=5, min_strength="weak")
    assert len(want) == 5
    assert shown(distant.search(sentence, k=5, min_strength="weak")) == shown(want)


@pytest.mark.parametrize("sentence", ["a person walks", "walks, then sits down, then waves"])
def test_it_finds_the_same_moments(local: Library, distant: MilvusLibrary, sentence: str) -> None:
    want = local.moments(sentence, k=8, min_strength="weak")
    assert want
    assert shown(distant.moments(sentence, k=8, min_strength="weak")) == shown(want)


@pytest.mark.parametrize("moments", [False, True])
def test_it_finds_the_same_similar_motion(local: Library, distant: MilvusLibrary, moments: bool) -> None:
    ref = "deep er/bücken.bvh"
    want = local.similar(ref, k=4, moments=moments, min_strength="weak")
    assert len(want) == 4
    assert ref not in [hit.path for hit in want]
    assert shown(distant.similar(ref, k=4, moments=moments, min_strength="weak")) == shown(want)


FILTERS: list[dict[str, Any]] = [
    {"min_duration": 6.0},
    {"max_duration": 4.0},
    {"min_duration": 3.9, "max_duration": 8.1},
    {"format": "npy"},
    {"captioned": True},
    {"captioned": False},
    {"starred": True},
    {"starred": False},
    {"tag": "KÄMPFE"},
    {"tag": "reel", "min_duration": 1.0},
    {"collection": "best of"},
    {"path": "deep er"},
    {"path": "deep er/"},
    {"path": "deep er/bücken.bvh"},
    {"path": "DEEP ER/*"},
    {"path": "take ?.npy"},
    {"path": "*.bvh"},
    {"clips": ["take 1.npy", "bücken"]},
    {"split": "test"},
    {"path": 'take" or clip > 0 or "'},
    {"tag": 'x", "y'},
    {"path": "take%"},
    {"path": "take_1.npy"},
]


@pytest.mark.parametrize("filters", FILTERS, ids=str)
def test_filters_let_the_same_clips_through(local: Library, distant: MilvusLibrary, filters: dict[str, Any]) -> None:
    want = {clip.path for clip in local.clips(**filters)}
    assert {clip.path for clip in distant.clips(**filters)} == want
    found = {hit.path for hit in distant.search("a person walks", k=5, min_strength="weak", **filters)}
    assert found == want


def test_a_path_may_begin_with_the_name_of_its_root(distant: MilvusLibrary) -> None:
    assert {clip.path for clip in distant.clips(path="größe & takes/deep*")} == {"deep er/bücken.bvh"}


def test_a_wrong_filter_is_refused_as_everywhere(distant: MilvusLibrary) -> None:
    with pytest.raises(ArgumentError, match="no filter"):
        distant.search("walks", colour="red")  # type: ignore[call-arg]
    with pytest.raises(ArgumentError, match="min_duration"):
        distant.search("walks", min_duration=9, max_duration=1)


def test_clips_are_named_in_the_same_ways(local: Library, distant: MilvusLibrary) -> None:
    for ref in ("take 1.npy", "bücken", "Größe & Takes/take 2.npy"):
        assert distant.find(ref).path == local.find(ref if "Größe" not in ref else "take 2.npy").path
    clip = distant.find("take 1.npy")
    assert distant.find(f"#{clip.id}") == clip
    assert clip.id < 2**53
    assert clip.file is None
    with pytest.raises(UnknownClip, match="nowhere"):
        distant.find("nowhere.bvh")


def test_what_is_known_of_a_clip_is_the_same(local: Library, distant: MilvusLibrary) -> None:
    for clip in local.clips():
        far = distant.find(clip.path)
        assert distant.captions(far.id) == local.captions(clip.id)
        assert distant.marks(far.id) == local.marks(clip.id)
        assert far.document() | {"id": 0} == clip.document() | {"id": 0}
        for got, want in zip(distant.windows(far.id), local.windows(clip.id), strict=True):
            np.testing.assert_array_equal(got.vectors, want.vectors)
            np.testing.assert_array_equal(got.starts, want.starts)
            np.testing.assert_array_equal(got.ends, want.ends)
            assert got.length == want.length


def test_poses_come_from_their_folder(local: Library, distant: MilvusLibrary) -> None:
    here, there = local.find("take 3.npy"), distant.find("take 3.npy")
    for span in ((None, None), (0.0, 1.0), (9.0, 12.5), (18.0, None)):
        want, got = local.motion(here.id, *span), distant.motion(there.id, *span)
        np.testing.assert_array_equal(got.joints, want.joints)


def test_without_a_place_of_poses_they_are_said_to_be_missing(place: Path, bundle: Bundle, tmp_path: Path) -> None:
    with MilvusLibrary(str(place / "vectors.db"), bundle=bundle) as library:
        clip = library.find("take 1.npy")
        assert library.search("walks", min_strength="weak")
        with pytest.raises(QueryError, match="--poses"):
            library.motion(clip.id)
        library._poses = PoseFiles(tmp_path)
        with pytest.raises(QueryError, match="the poses of clip"):
            library.motion(clip.id)


def test_an_object_store_serves_poses_as_a_folder_does(local: Library) -> None:
    pytest.importorskip("fsspec")
    store, clip = PoseFiles("memory://poses"), local.find("take 3.npy")
    chunks = local.pose_chunks(clip.id, 0, 99)
    store.write(7, chunks)
    assert store.has(7)
    assert store.read(7) == chunks
    store.remove(7)
    assert not store.has(7)
    with pytest.raises(QueryError):
        store.read(7)
    with pytest.raises(LibraryError, match="cannot be opened"):
        PoseFiles("nosuch://place")


def test_what_needs_the_library_itself_says_so(distant: MilvusLibrary) -> None:
    for ask in (
        lambda: distant.duplicates(),
        lambda: distant.mark("take 1.npy", star=True),
        lambda: distant.add("x", np.zeros((40, 22, 3))),
        lambda: distant.remove("x"),
        lambda: distant.connection,
    ):
        with pytest.raises(QueryError, match="needs the library itself"):
            ask()


def test_another_model_is_refused(place: Path, bundle: Bundle) -> None:
    class Other:
        fingerprint, name, latent_size = "other", "other", bundle.latent_size

    with pytest.raises(BundleMismatch, match=bundle.name):
        MilvusLibrary(str(place / "vectors.db"), bundle=Other())  # type: ignore[arg-type]


def test_a_place_without_a_collection_is_not_found(tmp_path: Path) -> None:
    with pytest.raises(LibraryNotFound, match="motionseek index"):
        MilvusLibrary(str(tmp_path / "empty.db"))
