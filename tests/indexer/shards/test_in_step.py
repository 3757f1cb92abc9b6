"""A collection is brought in step with libraries: whatever is cut off, nothing is lost, doubled or half there."""

from __future__ import annotations

import shutil
from collections.abc import Callable, Iterator
from contextlib import closing, contextmanager
from pathlib import Path
from typing import Any

import numpy as np
import pytest

pytest.importorskip("milvus_lite")

from encoders.bundle.bundle import Bundle
from encoders.errors import ArgumentError, BundleMismatch, LibraryError, LibraryLocked
from indexer.ingest.indexing import index
from indexer.shards.in_step import bring_in_step, out_of_step
from indexer.shards.pose_files import PoseFiles
from indexer.shards.shard import WHOLE, Shard
from indexer.store.stored_library import StoredLibrary
from indexer.vectors.milvus.collection_schema import CLIPS, STATE, WINDOWS
from indexer.vectors.milvus.expressions import among
from indexer.vectors.milvus.milvus_address import MilvusAddress
from indexer.vectors.milvus.milvus_collection import MilvusCollection
from indexer.vectors.milvus.milvus_index import MilvusIndex
from indexer.vectors.milvus.milvus_server import MilvusServer
from tests.search.conftest import made_motion


@pytest.fixture(scope="module")
def bundle(tiny_bundle: Path) -> Bundle:
    return Bundle.load(tiny_bundle, threads=1)


@pytest.fixture
def archive(tmp_path: Path) -> Path:
    """Eight takes in two folders, one with a caption."""
    folder = tmp_path / "archive"
    for i in range(8):
        place = folder / f"day {i % 2}"
        place.mkdir(parents=True, exist_ok=True)
        np.save(place / f"take {i}.npy", made_motion(2.0 + i / 2, i).joints)
    (folder / "day 0" / "take 0.txt").write_text("a person walks\n", encoding="utf-8")
    return folder


@pytest.fixture
def file(tmp_path: Path) -> Path:
    return tmp_path / "vectors.db"


@contextmanager
def collection_of(file: Path, bundle: Bundle) -> Iterator[MilvusCollection]:
    made = (bundle.fingerprint, bundle.name, bundle.latent_size)
    with closing(MilvusCollection(MilvusAddress.of(file), create=made)) as found:
        yield found


def paths_in(file: Path, bundle: Bundle) -> list[str]:
    """The paths of all clips of a collection; none has windows that are not its own, and each has its own."""
    with collection_of(file, bundle) as collection:
        clips = list(collection.all_rows(CLIPS, "", ("clip", "version", "path")))
        windows = {(row["clip"], row["version"]) for row in collection.all_rows(WINDOWS, "", ("clip", "version"))}
        assert windows == {(row["clip"], row["version"]) for row in clips}
    return sorted(row["path"] for row in clips)


def paths_of(archive: Path) -> list[str]:
    return sorted(path.relative_to(archive).as_posix() for path in archive.rglob("*.npy"))


def run(archive: Path, file: Path, bundle: Bundle, shard: str | None = None, **options: Any) -> Any:
    return index(archive, bundle=bundle, vectors=file, shard=shard, jobs=1, **options)


def test_shards_fill_one_collection_and_a_second_run_sends_nothing(archive: Path, file: Path, bundle: Bundle) -> None:
    sent = [run(archive, file, bundle, f"{i}/3").sent for i in (1, 2, 3)]
    assert sum(sent) == 8
    assert all(sent)
    assert paths_in(file, bundle) == paths_of(archive)
    again = [run(archive, file, bundle, f"{i}/3") for i in (3, 1, 2)]
    assert [(summary.indexed, summary.sent, summary.withdrawn) for summary in again] == [(0, 0, 0)] * 3


def test_what_changes_in_the_archive_changes_in_the_collection(archive: Path, file: Path, bundle: Bundle) -> None:
    run(archive, file, bundle)
    (archive / "day 1" / "take 1.npy").unlink()
    (archive / "day 0" / "take 2.npy").rename(archive / "day 1" / "moved.npy")
    np.save(archive / "day 0" / "take 4.npy", made_motion(5.0, 99).joints)
    (archive / "day 1" / "take 3.txt").write_text("someone waves\n", encoding="utf-8")
    summary = run(archive, file, bundle)
    assert (summary.sent, summary.withdrawn) == (3, 2)
    assert paths_in(file, bundle) == paths_of(archive)
    with collection_of(file, bundle) as collection:
        captioned = collection.rows(CLIPS, "captioned == true", ("path",))
        assert {row["path"] for row in captioned} == {"day 0/take 0.npy", "day 1/take 3.npy"}


@pytest.mark.parametrize(("before", "after"), [(2, 4), (4, 3), (3, 1)])
def test_a_change_of_their_number_neither_loses_nor_doubles(
    archive: Path, file: Path, bundle: Bundle, before: int, after: int
) -> None:
    for i in range(1, before + 1):
        run(archive, file, bundle, f"{i}/{before}")
    want = paths_of(archive)
    for i in range(1, after + 1):
        run(archive, file, bundle, f"{i}/{after}", library=archive / ".motionseek" / "shards" / str(i))
        assert paths_in(file, bundle) == want  # at any time
    (archive / "day 1" / "take 5.npy").unlink()
    for i in range(1, after + 1):
        run(archive, file, bundle, f"{i}/{after}", library=archive / ".motionseek" / "shards" / str(i))
    assert paths_in(file, bundle) == paths_of(archive)


class Killed(BaseException):
    """Stands for SIGKILL: nothing catches it."""


def writes_clips(method: str, options: dict[str, Any]) -> bool:
    return method in ("upsert", "delete") and options.get("partition_name") != STATE


def makes_the_collection(method: str, options: dict[str, Any]) -> bool:
    return method.startswith(("create_", "load_")) or (method == "upsert" and options.get("partition_name") == STATE)


def calls_until_killed(
    monkeypatch: pytest.MonkeyPatch, left: int, counts: Callable[[str, dict[str, Any]], bool] = writes_clips
) -> None:
    """Let so many calls of a kind through, and end before the next."""
    call, state = MilvusServer.call, [left]

    def counted(self: MilvusServer, method: str, *given: Any, **options: Any) -> Any:
        if counts(method, options):
            if state[0] == 0:
                raise Killed
            state[0] -= 1
        return call(self, method, *given, **options)

    monkeypatch.setattr(MilvusServer, "call", counted)


@pytest.mark.parametrize("left", range(5))
def test_what_is_cut_off_is_old_or_new_for_readers_and_finished_by_the_next_run(
    archive: Path, file: Path, bundle: Bundle, monkeypatch: pytest.MonkeyPatch, left: int
) -> None:
    run(archive, file, bundle)
    with collection_of(file, bundle) as collection:
        old = {row["clip"]: row["version"] for row in collection.all_rows(CLIPS, "", ("clip", "version"))}
    np.save(archive / "day 0" / "take 4.npy", made_motion(5.0, 99).joints)
    np.save(archive / "day 1" / "new.npy", made_motion(3.0, 77).joints)
    (archive / "day 1" / "take 1.npy").unlink()
    with monkeypatch.context() as patched:
        calls_until_killed(patched, left)
        with pytest.raises(Killed):
            run(archive, file, bundle)
    with collection_of(file, bundle) as collection:
        query = np.ones((1, bundle.latent_size), np.float32)
        _, clips, _, _ = MilvusIndex(collection, CLIPS).search(query, 50)
        _, owners, _, _ = MilvusIndex(collection, WINDOWS).search(query, 500)
        there = set(clips[clips >= 0].tolist())
        assert set(owners[owners >= 0].tolist()) <= there  # never a window without its clip
        for clip in there:
            versions = {row["version"] for row in collection.rows(CLIPS, among("clip", [clip]), ("version",))}
            rows = MilvusIndex(collection, WINDOWS).rows_of(np.array([clip]))
            assert len(versions) == 1
            assert len(rows) > 0
        assert len(there | old.keys()) <= len(old) + 1
    run(archive, file, bundle)
    assert paths_in(file, bundle) == paths_of(archive)


@pytest.mark.parametrize("left", range(6))
def test_a_collection_that_is_half_made_is_finished_by_whoever_writes_next(
    file: Path, bundle: Bundle, monkeypatch: pytest.MonkeyPatch, left: int
) -> None:
    with monkeypatch.context() as patched:
        calls_until_killed(patched, left, makes_the_collection)
        with pytest.raises(Killed), collection_of(file, bundle):
            pass
    with pytest.raises(LibraryError):  # for readers there is none yet
        MilvusCollection(MilvusAddress.of(file))
    with collection_of(file, bundle) as collection:
        assert [collection.count(part) for part in (CLIPS, WINDOWS)] == [0, 0]
        assert MilvusIndex(collection, CLIPS).search(np.ones((1, bundle.latent_size), np.float32), 3)[1].max() < 0
    with closing(MilvusCollection(MilvusAddress.of(file))) as collection:
        assert (collection.fingerprint, collection.model) == (bundle.fingerprint, bundle.name)


def test_an_interrupted_run_removes_nothing(archive: Path, file: Path, bundle: Bundle) -> None:
    run(archive, file, bundle)
    half = archive.parent / "half" / archive.name
    shutil.copytree(archive / "day 0", half / "day 0")
    index(half, bundle=bundle, jobs=1)
    with StoredLibrary.open(half, bundle=bundle) as library, collection_of(file, bundle) as collection:
        assert bring_in_step(library, collection, WHOLE, complete=False).removed == 0
        assert bring_in_step(library, collection, WHOLE).removed == 4


def test_what_is_damaged_in_a_collection_is_named_and_mended(archive: Path, file: Path, bundle: Bundle) -> None:
    run(archive, file, bundle, poses=archive.parent / "poses")
    with StoredLibrary.open(archive, bundle=bundle) as library, collection_of(file, bundle) as collection:
        assert out_of_step(library, collection, WHOLE) == []
        clips = sorted(row["clip"] for row in collection.all_rows(CLIPS, "", ("clip",)))
        some = collection.rows(WINDOWS, among("clip", clips[:1]), ("key",))
        collection._call("delete", filter=among("key", [some[0]["key"]]), partition_name=WINDOWS)
        collection._call("delete", filter=among("clip", clips[1:2]), partition_name=CLIPS)
        faults = out_of_step(library, collection, WHOLE)
        assert len(faults) == 2
        assert {problem for _, problem in faults} == {
            "has other windows in the collection", "is not in the collection"
        }  # fmt: skip
        bring_in_step(library, collection, WHOLE, poses=PoseFiles(archive.parent / "poses"), thorough=True)
        assert out_of_step(library, collection, WHOLE) == []
    assert paths_in(file, bundle) == paths_of(archive)


def test_another_model_needs_another_collection(archive: Path, file: Path, bundle: Bundle) -> None:
    run(archive, file, bundle)
    with (
        pytest.raises(BundleMismatch, match="another collection"),
        closing(MilvusCollection(MilvusAddress.of(file), create=("other", "other", bundle.latent_size))),
    ):
        pass


def test_a_number_that_two_clips_share_is_an_error_that_names_the_second(
    archive: Path, file: Path, bundle: Bundle, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("indexer.shards.collection_rows.clip_number", lambda root, path: 7)
    summary = run(archive, file, bundle)
    assert summary.sent + len(summary.failed) == 8
    assert all("has by chance the number" in reason for _, reason in summary.failed)
    assert summary.failed


def test_arguments_are_checked_before_anything_is_read(archive: Path, bundle: Bundle) -> None:
    for wrong in (
        {"vectors": "http://host/x"}, {"vectors": "milvus://host"}, {"vectors": "milvus://u:p@host/x"},
        {"vectors": "milvus://host:port/x"}, {"vectors": "milvus://host/x-y"}, {"poses": "somewhere"}, {"shard": "3"},
    ):  # fmt: skip
        with pytest.raises(ArgumentError):
            index(archive, bundle=bundle, **wrong)  # type: ignore[arg-type]
    assert not (archive / ".motionseek").exists()


def test_a_server_that_is_not_there_is_one_plain_error_before_anything_is_read(archive: Path, bundle: Bundle) -> None:
    with pytest.raises(LibraryError, match="does not answer in time"):
        index(archive, bundle=bundle, vectors="milvus://127.0.0.1:9/mocap")
    assert not (archive / ".motionseek" / "library.sqlite").exists()


def test_a_server_of_another_version_is_refused(file: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    from pymilvus import MilvusClient

    for version, needed in (("v2.2.9", "2.4"), ("milvus_lite-2.4.10", "3.0"), ("something", "2.4")):
        monkeypatch.setattr(MilvusClient, "get_server_version", lambda self, version=version, **_: version)
        with pytest.raises(LibraryError, match=needed):
            MilvusServer(MilvusAddress.of(file))


def test_a_file_that_another_process_has_open_is_locked(
    file: Path, bundle: Bundle, monkeypatch: pytest.MonkeyPatch
) -> None:
    from milvus_lite.db import MilvusLite

    monkeypatch.setattr("indexer.vectors.milvus.milvus_server.TIMEOUT", 1.0)
    held = MilvusLite(str(file))
    try:
        with pytest.raises(LibraryLocked, match="milvus-lite server"):
            MilvusServer(MilvusAddress.of(file), timeout=1.0)
    finally:
        held.close()
    with collection_of(file, bundle):
        pass


def test_a_server_that_goes_away_is_an_error_in_time(file: Path, bundle: Bundle) -> None:
    from milvus_lite.server_manager import server_manager_instance

    with collection_of(file, bundle) as collection:
        collection._server._timeout = 2.0
        server_manager_instance.release_server(collection.address.uri)
        with pytest.raises(LibraryError, match="does not answer in time"):
            collection.count(CLIPS)


def test_a_shard_keeps_to_its_own_files_without_a_collection(archive: Path, bundle: Bundle) -> None:
    counts = [index(archive, bundle=bundle, jobs=1, shard=f"{i}/2").indexed for i in (1, 2)]
    assert sum(counts) == 8
    assert all(Shard(i, 2).has(path) for i in (1, 2) for path in _indexed(archive, i, bundle))


def _indexed(archive: Path, number: int, bundle: Bundle) -> list[str]:
    with StoredLibrary.open(archive / ".motionseek" / "shards" / str(number), bundle=bundle) as library:
        return [clip.path for clip in library.clips()]
