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
from indexer.store.files import File
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
        "take 2.npy": "",  # its content is as it was
        "take 3.npy": "",
        "deep er/bücken.bvh": "",
    }


def test_the_command_line_says_so_on_stderr(run: Run, folder: Path) -> None:
    found = run("search", "walks", "--library", folder)
    assert "take 1.npy is gone since it was indexed" in found.err
    assert "is gone" not in found.out
    hits = run("search", "walks", "--library", folder, "--json").document["hits"]
    assert {hit["path"]: hit["stale"] for hit in hits}["take 3.npy"] is None


#: Commands that answer from one clip, without those that have it as a hit.
TAKING = {
    "describe": ["describe", "{clip}"],
    "segment": ["segment", "{clip}", "--labels", "walk, wave"],
    "moments": ["moments", "walks", "{clip}"],
    "render": ["render", "{clip}", "{out}.png", "--size", "64"],
    "export": ["export", "{clip}", "{out}.npz"],
    "similar": ["similar", "{clip}"],
    "search": ["search", "slower", "--like", "{clip}"],
    "compose": ["compose", "--then", "walks", "2", "--after", "{clip}", "-o", "{out}.npz"],
}


def lines_on(clip: str, err: str) -> list[str]:
    return [line for line in err.splitlines() if line.removeprefix("motionseek: ").startswith(f"{clip} ")]


@pytest.mark.parametrize("command", TAKING)
def test_a_command_says_once_what_became_of_the_file_of_its_clip(
    run: Run, folder: Path, tmp_path: Path, command: str
) -> None:
    for number, state in enumerate(["has changed since it was indexed", "is gone since it was indexed", ""]):
        clip, out = f"take {number}.npy", tmp_path / str(number)
        given = [argument.format(clip=clip, out=out) for argument in TAKING[command]]
        ran = run(*given, "--library", folder)
        assert ran.code == 0, ran.err
        said = lines_on(clip, ran.err)
        assert len(said) == (1 if state else 0), ran.err
        assert all(state in line for line in said)
        again = [*given, "--force"] if "{out}" in " ".join(TAKING[command]) else given
        as_json = run(*again, "--library", folder, "--json")
        assert len(lines_on(clip, as_json.err)) == len(said)
        if command in ("describe", "segment", "render", "export"):
            assert as_json.document["stale"] == (state or None)


def test_a_file_of_another_time_is_read_once(folder: Path, tiny_bundle: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    os.utime(folder / "take 3.npy", ns=(1, 1))
    read: list[str] = []
    hash_of = File.hash
    monkeypatch.setattr(File, "hash", lambda file, root: read.append(file.path) or hash_of(file, root))
    with Library.open(folder, bundle=Bundle.load(tiny_bundle, threads=1)) as library:
        for _ in range(2):
            assert not any(hit.stale for hit in library.search("walks") if hit.path == "take 3.npy")
    assert sorted(set(read)) == sorted(read)
    assert "take 0.npy" not in read  # its size is another
    assert "take 3.npy" in read


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


def test_so_does_a_cached_description(server: TestClient, folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    clips = {clip["path"]: clip["clip"] for clip in server.get("/api/motions").json()["motions"]}
    url = f"/api/describe?clip={clips['take 3.npy']}"
    monkeypatch.setattr(responses, "_LOOK", 0.0)
    assert server.get(url).json()["stale"] is None
    (folder / "take 3.npy").unlink()
    assert server.get(url).json()["stale"] == "is gone since it was indexed"


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
