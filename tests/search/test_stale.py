"""Hits of a file that is no longer what was indexed say so."""

from __future__ import annotations

import os
import shutil
import warnings
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from starlette.testclient import TestClient

from encoders.bundle.bundle import Bundle
from encoders.errors import MotionSeekWarning
from search.library import Library
from search.server import responses
from search.server.app import create_app
from search.server.snapshot_library import SnapshotLibrary
from tests.search.conftest import Run, made_motion


@pytest.fixture
def folder(indexed: Path, tmp_path: Path) -> Path:
    """A copy of the indexed takes in which one file has changed, one has gone, and one has only been touched."""
    folder = Path(shutil.copytree(indexed, tmp_path / "takes"))
    np.save(folder / "take 0.npy", made_motion(3.0, 50).joints)
    (folder / "take 1.npy").unlink()
    os.utime(folder / "take 2.npy")
    return folder


def test_hits_say_what_became_of_their_files(folder: Path, tiny_bundle: Path) -> None:
    with Library.open(folder, bundle=Bundle.load(tiny_bundle, threads=1)) as library:
        stale = {hit.path: hit.stale for hit in library.search("walks", 10)}
        assert stale == {hit.path: hit.stale for hit in library.moments("walks", k=50)}
    assert stale == {
        "take 0.npy": "has changed since it was indexed",
        "take 1.npy": "is gone since it was indexed",
        "take 2.npy": "has changed since it was indexed",  # its content is not compared
        "take 3.npy": "",
        "deep er/bücken.bvh": "",
    }


def test_the_command_line_says_so_on_stderr(run: Run, folder: Path) -> None:
    found = run("search", "walks", "--library", folder)
    assert "take 1.npy is gone since it was indexed" in found.err
    assert "is gone" not in found.out
    hits = run("search", "walks", "--library", folder, "--json").document["hits"]
    assert {hit["path"]: hit["stale"] for hit in hits}["take 3.npy"] is None


@pytest.fixture
def server(folder: Path, tiny_bundle: Path) -> Iterator[TestClient]:
    library = SnapshotLibrary.open(folder, bundle=Bundle.load(tiny_bundle, threads=1))
    with TestClient(create_app(library), base_url="http://127.0.0.1:8420") as client:
        yield client


@pytest.mark.parametrize("url", ["/api/search?q=walks", "/api/moments?q=walks&k=50", "/api/similar?clip=4"])
def test_a_cached_answer_says_what_became_of_a_file_since(
    server: TestClient, folder: Path, url: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    def stale(path: str) -> str | None:
        return {hit["path"]: hit["stale"] for hit in server.get(url).json()["hits"]}[path]

    assert stale("deep er/bücken.bvh") is None
    made = (folder / "deep er" / "bücken.bvh").rename(folder / "elsewhere.bvh")
    assert stale("deep er/bücken.bvh") is None  # looked at a moment ago
    monkeypatch.setattr(responses, "_LOOK", 0.0)
    assert stale("deep er/bücken.bvh") == "is gone since it was indexed"
    made.rename(folder / "deep er" / "bücken.bvh")
    assert stale("deep er/bücken.bvh") is None


def test_an_export_over_http_says_that_its_source_is_not_what_was_indexed(server: TestClient) -> None:
    clips = {clip["path"]: clip["clip"] for clip in server.get("/api/motions").json()["motions"]}
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", MotionSeekWarning)
        said = {
            path: server.get(f"/api/export?clip={clip}&format=npz").headers.get("x-stale")
            for path, clip in clips.items()
        }
    assert said == {
        "take 0.npy": "has changed since it was indexed",
        "take 1.npy": "is gone since it was indexed",
        "take 2.npy": None,  # its content is as it was
        "take 3.npy": None,
        "deep er/bücken.bvh": None,
    }
