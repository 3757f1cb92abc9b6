"""Uploads: read like indexed files, under limits on size, time and memory."""

from __future__ import annotations

import io
import time
from collections.abc import Iterator

import anyio
import numpy as np
import pytest
from starlette.exceptions import HTTPException
from starlette.requests import Request

from indexer.read_motion import ReadMotion
from search.cli.commands.demo import DATA
from search.export import bvh_writer, joints_binary
from search.server.uploads import sandboxed_reader
from search.server.uploads.upload_store import UploadLimits, UploadStore
from tests.search.conftest import made_motion


@pytest.fixture(scope="module")
def dance() -> bytes:
    """A motion file of three seconds."""
    file = io.BytesIO()
    bvh_writer.write(file, made_motion(3.0, 5))
    return file.getvalue()


def test_an_upload_is_described(client, dance):
    response = client.post("/api/describe", params={"name": "C:\\my takes\\dance.bvh", "k": 3}, content=dance)
    assert response.status_code == 200
    found = response.json()
    assert found["path"] == "C:\\my takes\\dance.bvh"
    assert len(found["sentences"]) == 3
    assert found["clip"].startswith("u")


def test_an_upload_finds_what_is_similar(client, dance):
    found = client.post("/api/similar", params={"name": "dance.bvh", "k": 2}, content=dance).json()
    assert (found["query"], len(found["hits"])) == ("dance.bvh", 2)
    assert all(isinstance(hit["clip"], int) for hit in found["hits"])


def test_a_span_of_an_upload_is_asked_about(client, dance):
    params = {"name": "dance.bvh", "start": 1, "end": 2, "moments": True}
    assert client.post("/api/similar", params=params, content=dance).status_code == 200
    outside = client.post("/api/describe", params={"name": "dance.bvh", "start": 50}, content=dance)
    assert outside.status_code == 422


def test_an_upload_is_a_clip_from_then_on(client, ask, dance):
    clip = client.post("/api/describe", params={"name": "dance.bvh"}, content=dance).json()["clip"]
    motion = ask(f"/api/motions/{clip}")
    assert (motion["clip"], motion["path"], motion["name"], motion["format"]) == (clip, "dance.bvh", "dance", "bvh")
    drawn, _ = joints_binary.unpack(client.get(f"/api/motions/{clip}/joints").content)
    assert len(drawn) == motion["frames"] == 60
    assert ask("/api/curve", clip=clip, q="walks")["clip"] == clip
    assert ask("/api/moments", clip=clip, q="walks")["hits"][0]["clip"] == clip
    assert ask("/api/describe", clip=clip)["clip"] == clip
    assert ask("/api/similar", clip=clip, start=1, end=2)["query"] == "dance.bvh"
    cut = client.get("/api/export", params={"clip": clip, "end": 1, "format": "npy"}).content
    assert np.load(io.BytesIO(cut), allow_pickle=False).shape == (20, 22, 3)


@pytest.mark.parametrize(
    ("name", "content"),
    [
        ("x.bvh", b""),
        ("x.npy", b"\0" * 1000),
        ("x.json", b'{"q": "walks"'),
        ("x", b"HIERARCHY\nROOT a\n"),
        ("../../../etc/passwd.npy", b"\x93NUMPY\x01\x00\xff\xff{"),
        ("a\0b.amc", b"\x80\x04\x95K."),
        ("x.zip", b"PK\x03\x04"),
    ],
)
def test_what_is_no_motion_is_an_error(client, name, content):
    response = client.post("/api/describe", params={"name": name}, content=content)
    assert (response.status_code, list(response.json())) == (422, ["error"])


def test_a_pickled_array_is_not_unpickled(client, tmp_path):
    class Bad:
        def __reduce__(self):
            return (open, (str(tmp_path / "made"), "w"))

    file = io.BytesIO()
    np.save(file, np.array([Bad()]), allow_pickle=True)
    assert client.post("/api/describe", params={"name": "x.npy"}, content=file.getvalue()).status_code == 422
    assert not (tmp_path / "made").exists()


def test_a_header_with_a_false_size_allocates_no_memory(client):
    header = b"{'descr': '<f4', 'fortran_order': False, 'shape': (10000000000, 22, 3), }"
    file = b"\x93NUMPY\x01\x00" + len(header).to_bytes(2, "little") + header + b"\0" * 64
    assert client.post("/api/describe", params={"name": "x.npy"}, content=file).status_code == 422


def test_an_upload_announced_as_too_large_is_not_read(served):
    client = served(limits=UploadLimits(bytes=1000))
    response = client.post("/api/describe", params={"name": "x.bvh"}, content=b"x" * 1001)
    assert (response.status_code, list(response.json())) == (413, ["error"])


def test_an_upload_of_unknown_size_is_counted(served):
    client = served(limits=UploadLimits(bytes=1000))
    sent = 0

    def endless() -> Iterator[bytes]:
        nonlocal sent
        while sent < 10_000_000:
            sent += 500
            yield b"x" * 500

    response = client.post("/api/similar", params={"name": "x.bvh"}, content=endless())
    assert response.status_code == 413


async def _received(uploads: UploadStore, chunks: Iterator[tuple[float, bytes]], more: bool = True) -> None:
    """A request whose body comes in chunks, each after a pause in seconds."""

    async def receive():
        pause, body = next(chunks)
        await anyio.sleep(pause)
        return {"type": "http.request", "body": body, "more_body": more}

    await uploads.receive(Request({"type": "http", "method": "POST", "headers": []}, receive), "x.bvh")


def test_a_slow_upload_times_out():
    uploads = UploadStore(UploadLimits(seconds=0.1))
    slow = iter([(0.04, b"x")] * 1000)
    began = time.monotonic()
    with pytest.raises(HTTPException) as refused:
        anyio.run(_received, uploads, slow)
    assert refused.value.status_code == 408
    assert time.monotonic() - began < 2


def test_a_closed_connection_frees_its_slot():
    uploads = UploadStore(UploadLimits(at_once=1))

    async def broken_off():
        async def receive():
            return {"type": "http.disconnect"}

        await uploads.receive(Request({"type": "http", "method": "POST", "headers": []}, receive), "x.bvh")

    for _ in range(3):
        with pytest.raises(HTTPException) as refused:
            anyio.run(broken_off)
        assert refused.value.status_code == 400


def test_only_some_uploads_are_read_at_once(monkeypatch):
    async def two() -> list[int]:
        uploads, codes = UploadStore(UploadLimits(at_once=1)), []
        monkeypatch.setattr(uploads, "_read", lambda *_: [time.sleep(0.3)])

        async def one() -> None:
            try:
                await _received(uploads, iter([(0.0, b"x")]), more=False)
                codes.append(200)
            except HTTPException as refused:
                codes.append(refused.status_code)

        async with anyio.create_task_group() as group:
            group.start_soon(one)
            group.start_soon(one)
        return codes

    assert sorted(anyio.run(two)) == [200, 503]


def test_uploads_that_are_received_take_only_so_much_space():
    async def all_of(count: int) -> list[int]:
        uploads, codes = UploadStore(UploadLimits(seconds=0.3, receiving_bytes=10_000)), []

        async def one() -> None:
            with pytest.raises(HTTPException) as refused:
                await _received(uploads, iter([(0.0, b"x" * 3000), (9.0, b"")]))
            codes.append(refused.value.status_code)

        async with anyio.create_task_group() as group:
            for _ in range(count):
                group.start_soon(one)
        return codes

    assert sorted(anyio.run(all_of, 5)) == [408, 408, 408, 503, 503]


@pytest.mark.parametrize(
    ("target", "reason"), [("hangs", "took more than"), ("crashes", "crashed"), ("eats", "more memory")]
)
def test_a_hostile_file_only_ends_its_reader(served, dance, monkeypatch, target, reason):
    client = served(limits=UploadLimits(patience=1.0))
    monkeypatch.setattr(
        "search.server.uploads.upload_store.READ", f"tests.search.server.uploads.hostile_readers:{target}"
    )
    response = client.post("/api/describe", params={"name": "x.bvh"}, content=dance)
    assert response.status_code == 422
    assert reason in response.json()["error"]
    monkeypatch.undo()
    assert client.post("/api/describe", params={"name": "x.bvh"}, content=dance).status_code == 200


def test_the_oldest_uploads_are_evicted(served, dance):
    client = served(limits=UploadLimits(kept=2))
    clips = [client.post("/api/describe", params={"name": "x.bvh"}, content=dance).json()["clip"] for _ in range(3)]
    assert [client.get(f"/api/motions/{clip}").status_code for clip in clips] == [404, 200, 200]


def test_nothing_is_left_on_disk(served, dance, tmp_path, monkeypatch):
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path))
    client = served()
    before = sorted(tmp_path.iterdir())
    client.post("/api/describe", params={"name": "x.bvh"}, content=dance)
    client.post("/api/describe", params={"name": "x.bvh"}, content=b"nonsense")
    client.get("/api/export", params={"clip": 1})
    assert sorted(tmp_path.iterdir()) == before


def test_the_longest_upload_is_two_hours(monkeypatch):
    monkeypatch.setattr("indexer.ingest.load.read_motions", lambda *_: [ReadMotion(made_motion(3.0, 5))])
    monkeypatch.setattr(sandboxed_reader, "limit_resources", lambda: None)
    assert len(sandboxed_reader.read("x.bvh")[0].motion) == 60
    monkeypatch.setattr(sandboxed_reader, "MAX_FRAMES", 59)
    with pytest.raises(MemoryError):
        sandboxed_reader.read("x.bvh")


def test_a_motion_is_read_with_the_files_it_needs(client):
    motion, skeleton = ((DATA / f"session_01.{ending}").read_bytes() for ending in ("amc", "asf"))
    names = [("name", "shoot/session_01.amc"), ("name", "session_01.asf")]
    sizes = [("size", len(motion)), ("size", len(skeleton))]
    found = client.post("/api/uploads", params=names + sizes, content=motion + skeleton)
    assert found.status_code == 200, found.text
    (document,) = found.json()["motions"]
    assert (document["path"], document["format"], document["source_fps"]) == ("shoot/session_01.amc", "amc", 120.0)
    assert client.get(f"/api/motions/{document['clip']}").json() == document
    chosen = client.get("/api/motions", params=[("clip", document["clip"]), ("clip", 1), ("clip", 999)]).json()
    assert [motion["clip"] for motion in chosen["motions"]] == [document["clip"], 1]


def test_all_motions_of_a_file_are_read(client, tmp_path):
    joints = np.stack([made_motion(2.0, seed).joints for seed in (1, 2)])
    np.savez(tmp_path / "two.npz", joints=joints, fps=20)
    found = client.post("/api/uploads", params={"name": "two.npz"}, content=(tmp_path / "two.npz").read_bytes())
    assert [motion["path"] for motion in found.json()["motions"]] == ["two.npz#1", "two.npz#2"]


@pytest.mark.parametrize(
    "params",
    [
        [("name", "x.bvh"), ("name", "y.bin")],
        [("name", "x.bvh"), ("name", "x.bvh"), ("size", 1), ("size", 3)],
        [("name", "x.bvh"), ("size", 3)],
        [("name", "x.bvh"), ("size", 5)],
        [("name", "x.bvh"), ("name", ".."), ("size", 2), ("size", 2)],
        [],
    ],
)
def test_files_that_do_not_fit_their_sizes_and_names_are_refused(client, params):
    response = client.post("/api/uploads", params=params, content=b"HIER")
    assert response.status_code == 422
    assert "Expecting" not in response.json()["error"]
