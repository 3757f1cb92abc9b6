"""A server of a collection: the same routes, changes noticed, and errors that are plain."""

from __future__ import annotations

import shutil
from collections.abc import Iterator
from contextlib import closing
from pathlib import Path
from typing import Any

import pytest

pytest.importorskip("milvus_lite")
pytest.importorskip("fastapi")

from starlette.testclient import TestClient

from encoders.bundle.bundle import Bundle
from encoders.errors import LibraryError
from indexer.shards.in_step import bring_in_step
from indexer.shards.pose_files import PoseFiles
from indexer.shards.shard import WHOLE
from indexer.vectors.milvus.milvus_address import MilvusAddress
from indexer.vectors.milvus.milvus_collection import MilvusCollection
from search.library import Library
from search.server.app import create_app
from search.server.served.served_collection import ServedCollection


@pytest.fixture(scope="module")
def filled(indexed: Path, bundle: Bundle, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A file of milvus-lite with the indexed takes, their library beside, and their poses."""
    folder = tmp_path_factory.mktemp("collection")
    shutil.copytree(indexed, folder / indexed.name)
    send(folder, bundle, indexed.name)
    return folder


def send(folder: Path, bundle: Bundle, name: str) -> None:
    made = (bundle.fingerprint, bundle.name, bundle.latent_size)
    with (
        Library.open(folder / name, bundle=bundle) as library,
        closing(MilvusCollection(MilvusAddress.of(folder / "vectors.db"), create=made)) as collection,
    ):
        bring_in_step(library, collection, WHOLE, poses=PoseFiles(folder / "poses"))


@pytest.fixture(scope="module")
def served(filled: Path, bundle: Bundle) -> Iterator[ServedCollection]:
    library = ServedCollection(str(filled / "vectors.db"), bundle=bundle, poses=filled / "poses")
    yield library
    library.close()


@pytest.fixture(scope="module")
def far(served: ServedCollection) -> TestClient:
    return TestClient(create_app(served), base_url="http://127.0.0.1:8420", raise_server_exceptions=False)


def told(hit: dict[str, Any]) -> dict[str, Any]:
    return {name: value for name, value in hit.items() if name not in ("clip", "matched", "stale", "score")}


@pytest.mark.parametrize(
    "question", ["search?q=walks&k=4", "moments?q=waves&k=4", "search?q=walks&format=bvh", "search?q=walks&path=deep*"]
)
def test_answers_are_those_of_the_library(client: TestClient, far: TestClient, question: str) -> None:
    want, got = (asked.get(f"/api/{question}&min_strength=weak").json()["hits"] for asked in (client, far))
    assert want
    assert [*map(told, got)] == [*map(told, want)]


def test_a_clip_is_shown_as_the_library_shows_it(client: TestClient, far: TestClient) -> None:
    (near,) = client.get("/api/search?q=take 1.npy&k=1").json()["hits"]
    (distant,) = far.get("/api/search?q=take 1.npy&k=1").json()["hits"]
    for route in ("", "/joints", "/joints?start=1&end=2"):
        want = client.get(f"/api/motions/{near['clip']}{route}")
        got = far.get(f"/api/motions/{distant['clip']}{route}")
        assert got.status_code == want.status_code == 200
        if route:
            assert got.content == want.content
        else:
            assert got.json() | {"clip": 0} == want.json() | {"clip": 0}


def test_lists_and_counts_are_of_the_collection(far: TestClient) -> None:
    motions = far.get("/api/motions?limit=3").json()
    assert motions["total"] == 5
    assert len(motions["motions"]) == 3
    assert len(far.get("/api/clips").json()["clips"]) == 5
    stats = far.get("/api/stats").json()
    assert (stats["clips"], stats["formats"]["npy"]) == (5, 4)
    assert far.get("/healthz").json() == {"status": "ok"}
    while (answer := far.get("/api/map")).status_code == 202:
        pass
    assert len(answer.json()["clips"]) == answer.json()["total"] == 5
    assert far.get("/api/marks").json()["edit"] is False


def test_what_needs_the_library_says_so(far: TestClient) -> None:
    answer = far.get("/api/facets")
    assert answer.status_code == 422
    assert "needs the library itself" in answer.json()["error"]


def test_without_poses_figures_are_said_to_be_missing(served: ServedCollection, far: TestClient) -> None:
    clip = far.get("/api/search?q=walks&k=1&min_strength=weak").json()["hits"][0]["clip"]
    poses, served._poses = served._poses, None
    try:
        answer = far.get(f"/api/motions/{clip}/joints")
    finally:
        served._poses = poses
    assert answer.status_code == 422
    assert "poses" in answer.json()["error"]


def test_what_another_process_writes_is_noticed(
    filled: Path, served: ServedCollection, far: TestClient, bundle: Bundle, indexed: Path
) -> None:
    before = far.get("/api/search?q=walks&k=5&min_strength=weak").json()["hits"]
    assert not served.refresh()
    with Library.open(filled / indexed.name, bundle=bundle) as library:
        library.mark("take 0.npy", star=True)
    send(filled, bundle, indexed.name)
    assert served.refresh()
    after = far.get("/api/search?q=walks&k=5&min_strength=weak").json()["hits"]
    assert [hit["path"] for hit in after] == [hit["path"] for hit in before]
    assert {hit["path"] for hit in after if hit["starred"]} == {"take 0.npy"}


def test_while_milvus_is_away_the_server_says_so_and_goes_on_when_it_is_back(
    served: ServedCollection, far: TestClient, monkeypatch: pytest.MonkeyPatch
) -> None:
    def away() -> int:
        raise LibraryError("milvus://somewhere/x: does not answer in time")

    with monkeypatch.context() as patched:
        patched.setattr(served.collection, "generation", away)
        served.refresh()
        answer = far.get("/healthz")
        assert answer.status_code == 503
        assert "somewhere" not in answer.text
    served.refresh()
    assert far.get("/healthz").status_code == 200
