"""Facets, stacks, marks and archives over HTTP."""

from __future__ import annotations

import io
import shutil
import zipfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from starlette.testclient import TestClient

from encoders.bundle.bundle import Bundle
from indexer.ingest import indexing
from search.server.app import create_app
from search.server.snapshot_library import SnapshotLibrary
from tests.search.conftest import made_motion

AT = "http://127.0.0.1:8420"


def client(folder: Path, bundle: Bundle, **options: Any) -> TestClient:
    return TestClient(create_app(SnapshotLibrary.open(folder, bundle=bundle), **options), base_url=AT)


@pytest.fixture(scope="module")
def folder(takes: Path, tmp_path_factory: pytest.TempPathFactory, bundle: Bundle) -> Path:
    """The takes with a mirrored copy of one."""
    folder = Path(shutil.copytree(takes, tmp_path_factory.mktemp("shelf") / takes.name))
    np.save(folder / "deep er" / "copy.npy", made_motion(8.0, 2).mirror().joints)
    (folder / "LICENSE.txt").write_text("Credit the dancers.")
    indexing.index(folder, bundle=bundle, jobs=1)
    return folder


@pytest.fixture(scope="module")
def editing(folder: Path, bundle: Bundle) -> Iterator[TestClient]:
    with client(folder, bundle, edit=True) as found:
        yield found


def test_facets_count_what_each_value_would_leave(editing: TestClient) -> None:
    found = editing.get("/api/facets").json()
    assert found["format"] == [{"value": "npy", "count": 5}, {"value": "bvh", "count": 1}]
    assert found["folder"] == [{"value": "deep er", "count": 2}]
    assert found["length"] == [
        {"from": 2.0, "to": 5.0, "count": 2}, {"from": 5.0, "to": 10.0, "count": 3},
        {"from": 10.0, "to": 30.0, "count": 1},
    ]  # fmt: skip
    given = editing.get("/api/facets", params={"format": "npy", "path": "deep er"}).json()
    assert given["format"] == [{"value": "bvh", "count": 1}, {"value": "npy", "count": 1}]
    assert given["folder"] == [{"value": "deep er", "count": 1}]


def test_stacks_are_found_in_the_background(editing: TestClient) -> None:
    for _ in range(600):
        found = editing.get("/api/stacks").json()
        if "stacks" in found:
            break
        assert 0 <= found["progress"] <= 1
    clips = {motion["path"]: motion["clip"] for motion in editing.get("/api/motions").json()["motions"]}
    first, second = sorted([clips["deep er/copy.npy"], clips["take 2.npy"]])
    assert found["stacks"] == [[[first, False], [second, True]]]


def test_clips_are_marked_and_found_at_once(editing: TestClient, folder: Path) -> None:
    done = editing.post("/api/marks", json={"clips": [1, 2], "star": True, "tags": ["fight"], "collections": ["reel"]})
    assert done.json()["clips"][0] == {"clip": 1, "starred": True, "tags": ["fight"], "collections": ["reel"]}
    assert editing.get("/api/marks").json() == {
        "starred": 2, "tags": {"fight": 2}, "collections": {"reel": 2}, "edit": True
    }  # fmt: skip
    hits = editing.get("/api/search", params={"q": "walks", "tag": "fight"}).json()["hits"]
    assert {hit["clip"] for hit in hits} <= {1, 2}
    assert all(hit["starred"] for hit in hits)
    assert editing.get("/api/facets").json()["tag"] == [{"value": "fight", "count": 2}]
    editing.post("/api/marks", json={"clips": [1], "star": False, "untag": ["fight"], "uncollect": ["reel"]})
    assert editing.get("/api/motions/1").json()["tags"] == []
    assert [m["clip"] for m in editing.get("/api/motions", params={"starred": True}).json()["motions"]] == [2]


@pytest.mark.parametrize(
    ("body", "code"),
    [({}, 422), ({"clips": []}, 422), ({"clips": [1] * 201, "star": True}, 422), ({"clips": [99], "star": True}, 404),
     ({"clips": [1], "tags": ["x" * 101]}, 422), ({"clips": [1], "tags": [" "]}, 422),
     ({"clips": ["1; DROP"], "star": True}, 422), ({"clips": [1], "stars": True}, 422)],
)  # fmt: skip
def test_a_change_that_makes_no_sense_is_refused(editing: TestClient, body: dict[str, Any], code: int) -> None:
    answer = editing.post("/api/marks", json=body)
    assert answer.status_code == code
    assert answer.json()["error"]


def test_nothing_is_written_without_edit_or_for_another_site(
    editing: TestClient, folder: Path, bundle: Bundle, tmp_path: Path
) -> None:
    change = {"clips": [3], "star": True}
    for headers in ({"Origin": "http://evil.example"}, {"Sec-Fetch-Site": "cross-site"}):
        assert editing.post("/api/marks", json=change, headers=headers).status_code == 403
    form = {"Content-Type": "text/plain"}
    assert editing.post("/api/marks", content='{"clips":[3],"star":true}', headers=form).status_code == 422
    with client(Path(shutil.copytree(folder, tmp_path / "takes")), bundle) as reading:
        answer = reading.post("/api/marks", json=change)
        assert answer.status_code == 403
        assert "--edit" in answer.json()["error"]
        assert reading.get("/api/marks").json()["edit"] is False
    assert not editing.get("/api/motions/3").json()["starred"]


def test_many_clips_are_downloaded_as_one_archive(editing: TestClient) -> None:
    answer = editing.get("/api/archive", params={"clip": ["1", "2:0.5:1.5", "1", "#3"], "format": "npy"})
    assert answer.headers["content-type"] == "application/zip"
    packed = zipfile.ZipFile(io.BytesIO(answer.content))
    assert packed.testzip() is None
    paths = [editing.get(f"/api/motions/{i}").json() for i in (1, 2, 3)]
    stems = [f"{m['root']}/{m['path'].rpartition('.')[0]}" for m in paths]
    expected = [f"{stems[0]}.npy", f"{stems[1]}_0.5-1.5.npy", f"{stems[0]} (2).npy", f"{stems[2]}.npy", "credits.txt"]
    assert packed.namelist() == expected
    assert np.load(io.BytesIO(packed.read(expected[1]))).shape == (20, 22, 3)
    assert b"Credit the dancers." in packed.read("credits.txt")


@pytest.mark.parametrize("clip", ["", "x", "1:2", "1:3:2", "../etc", "1:nan:2", "99"])
def test_an_archive_of_nothing_that_is_there_is_refused(editing: TestClient, clip: str) -> None:
    assert editing.get("/api/archive", params={"clip": clip}).status_code in (404, 422)
