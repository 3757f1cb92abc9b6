"""A library for concurrent readers: batches of searches, and changes on disk while it is served."""

from __future__ import annotations

import threading
import time
from pathlib import Path

import numpy as np
import pytest

from indexer.ingest import indexing
from search.query.question import Question
from search.server.served.served_library import SearchRequest
from search.server.snapshot_library import SnapshotLibrary
from tests.search.conftest import made_motion


def _wait_for(client, clips: int) -> None:
    until = time.monotonic() + 10
    while f"motionseek_clips {clips}\n" not in client.get("/metrics").text:
        assert time.monotonic() < until, "the change was not noticed"
        time.sleep(0.05)


def test_new_clips_are_found_without_a_restart(served, bundle, tmp_path: Path):
    client, folder = served(), tmp_path / "takes"
    before = client.get("/api/search", params={"q": "walks", "k": 20}).json()["hits"]
    np.save(folder / "new.npy", made_motion(5.0, 77).joints)
    indexing.index(folder, bundle=bundle, jobs=1)
    _wait_for(client, 6)
    after = client.get("/api/search", params={"q": "walks", "k": 20}).json()["hits"]
    assert {hit["path"] for hit in after} - {hit["path"] for hit in before} == {"new.npy"}
    assert client.get("/api/map").json()["generation"] == client.get("/api/stats").json()["generation"]


def test_removed_clips_are_found_no_more(served, bundle, tmp_path: Path):
    client, folder = served(), tmp_path / "takes"
    assert len(client.get("/api/search", params={"q": "walks"}).json()["hits"]) == 5
    (folder / "take 2.npy").unlink()
    indexing.index(folder, bundle=bundle, jobs=1)
    _wait_for(client, 4)
    hits = client.get("/api/search", params={"q": "walks"}).json()["hits"]
    assert "take 2.npy" not in [hit["path"] for hit in hits]


def _until(client, url: str, **parameters) -> object:
    """The response once its code is 200."""
    until = time.monotonic() + 10
    while (response := client.get(url, params=parameters)).status_code != 200:
        assert time.monotonic() < until, response.text
        time.sleep(0.05)
    return response


def _of_one_clip(folder: Path, bundle, name: str) -> Path:
    """A folder of one clip, indexed."""
    folder.mkdir()
    np.save(folder / f"{name}.npy", made_motion(5.0, 77).joints)
    indexing.index(folder, bundle=bundle, jobs=1)
    return folder


def _paths(client) -> set[str]:
    return {hit["path"] for hit in client.get("/api/search", params={"q": "walks", "k": 20}).json()["hits"]}


def test_a_library_exchanged_while_it_is_served_is_the_one_that_answers(served, bundle, tmp_path: Path):
    client, folder = served(), tmp_path / "takes"
    assert len(_paths(client)) == 5
    other = _of_one_clip(tmp_path / "other", bundle, "another")
    (folder / ".motionseek").rename(tmp_path / "put aside")
    (other / ".motionseek").rename(folder / ".motionseek")
    until = time.monotonic() + 10
    while _paths(client) != {"another.npy"}:  # an answer in the cache may be as old as the last look at the disk
        assert time.monotonic() < until
        time.sleep(0.05)
    assert client.get("/api/motions/1").json()["name"] == "another"
    (folder / ".motionseek").rename(tmp_path / "other again")
    (tmp_path / "put aside").rename(folder / ".motionseek")
    while len(_paths(client)) != 5:
        assert time.monotonic() < until + 10
        time.sleep(0.05)


def test_a_library_removed_while_it_is_served_is_missed_until_it_is_back(served, bundle, tmp_path: Path):
    client, folder = served(), tmp_path / "takes"
    (folder / ".motionseek").rename(tmp_path / "gone")
    for url in ("/api/search?q=walks", "/api/moments?q=walks", "/api/motions", "/api/stats", "/api/similar?clip=1"):
        response = client.get(url)
        assert response.status_code == 503, url
        assert response.json()["error"].startswith("the library is missing"), url
    until = time.monotonic() + 10
    while client.get("/healthz").status_code != 503:
        assert time.monotonic() < until
        time.sleep(0.05)
    (tmp_path / "gone").rename(folder / ".motionseek")
    _until(client, "/healthz")
    assert len(_paths(client)) == 5


def test_a_clip_removed_after_the_snapshot_is_left_out(served, bundle, tmp_path: Path):
    served()
    folder = tmp_path / "takes"
    with SnapshotLibrary.open(folder, bundle=bundle) as library:  # no watching thread
        (folder / "take 2.npy").unlink()
        indexing.index(folder, bundle=bundle, jobs=1)
        (found,) = library.search_all([SearchRequest(library.encode(Question.of("walks")), 10, {})])
    assert not isinstance(found, Exception)
    assert len(found) == 4


def test_indexing_goes_on_while_searches_are_answered(served, bundle, tmp_path: Path):
    client, folder = served(), tmp_path / "takes"
    for seed in range(6):
        np.save(folder / f"new {seed}.npy", made_motion(3.0, 100 + seed).joints)
    indexer = threading.Thread(target=indexing.index, args=(folder,), kwargs={"bundle": bundle, "jobs": 1})
    indexer.start()
    codes = set()
    while indexer.is_alive():
        codes.add(client.get("/api/search", params={"q": f"walks {time.monotonic()}"}).status_code)
    assert codes == {200}
    _wait_for(client, 11)


def test_a_library_of_another_model_is_no_longer_answered_from(served, bundle, monkeypatch):
    client = served()
    assert client.get("/healthz").status_code == 200
    monkeypatch.setattr(bundle, "fingerprint", "0" * 64)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(SnapshotLibrary, "generation", 10**6)
        until = time.monotonic() + 10
        while (response := client.get("/healthz")).status_code == 200:
            assert time.monotonic() < until
            time.sleep(0.05)
    assert response.status_code == 503
    assert "model" in client.get("/api/search", params={"q": "walks"}).json()["error"]


def test_cached_clips_survive_growth_and_are_read_again_when_they_change(served, bundle, tmp_path: Path):
    served()
    folder = tmp_path / "takes"
    with SnapshotLibrary.open(folder, bundle=bundle) as library:  # refreshed by hand
        clips = {clip.path: clip for clip in library.clips_by_id(library.ids()).values()}
        np.save(folder / "new.npy", made_motion(5.0, 77).joints)
        (folder / "take 2.npy").rename(folder / "renamed.npy")
        (folder / "take 1.txt").write_text("a person hops\n", encoding="utf-8")
        ids = {path: clip.id for path, clip in clips.items()}
        said = library.captions(ids["take 1.npy"])
        indexing.index(folder, bundle=bundle, jobs=1)
        assert library.refresh()
        now = library.clips_by_id(ids.values())
        assert now[ids["take 1.npy"]] is clips["take 1.npy"]
        assert now[ids["take 2.npy"]].path == "renamed.npy"
        assert library.captions(ids["take 1.npy"]) != said


def test_a_batch_of_searches_gives_what_each_alone_gives(indexed, bundle):
    with SnapshotLibrary.open(indexed, bundle=bundle) as library:
        walks, waves = (library.encode(Question.of(text)) for text in ("a person walks", "waves"))
        requests = [
            SearchRequest(walks, 3, {}),
            SearchRequest(waves, 2, {"min_duration": 5.0}),
            SearchRequest(waves, 2, {"min_duration": 5.0, "max_duration": 1.0}),
        ]
        first, second, wrong = library.search_all(requests)
        assert first == library.search("a person walks", 3)
        assert second == library.search("waves", 2, min_duration=5.0)
        assert "no clip can be both" in str(wrong)


def test_a_sentence_is_encoded_once(served, bundle, monkeypatch):
    client, encoded, encode_texts = served(), [], bundle.encode_texts
    monkeypatch.setattr(bundle, "encode_texts", lambda texts: encoded.extend(texts) or encode_texts(texts))
    urls = ("search", "search?k=3", "moments", "moments?clip=1", "curve?clip=1")
    for url in (f"/api/{url}{'&' if '?' in url else '?'}q=limping+sideways" for url in urls):
        assert client.get(url).status_code == 200
    assert encoded
    assert len(encoded) == len(set(encoded))
