"""The library as its readers see it."""

import os
import sqlite3
import threading
from pathlib import Path

import numpy as np
import pytest

from encoders.errors import (
    ArgumentError,
    BundleMismatch,
    LibraryDamaged,
    LibraryError,
    LibraryNotFound,
    QueryError,
    UnknownClip,
)
from encoders.motion import Motion
from indexer.ingest import indexing, storing
from indexer.ingest.arrays import NewClip, add
from indexer.ingest.pool import Read
from indexer.read_motion import ReadMotion
from indexer.store import poses, schema
from indexer.store.library_reader import FILE, FOLDER
from indexer.store.stored_library import Caption, StoredLibrary
from tests.indexer.folders import SmallBundle, moving, write


@pytest.fixture
def bundle():
    return SmallBundle()


@pytest.fixture
def in_process(monkeypatch):
    """Reading without processes of its own: joints as they are."""

    def read_all(requests, jobs):
        for request in requests:
            yield request.key, Read((ReadMotion(Motion(np.load(request.path)), rig="rig"),))

    monkeypatch.setattr(storing, "read_all", read_all)


@pytest.fixture
def folder(tmp_path, bundle, in_process):
    root = tmp_path / "takes"
    for seed, name in enumerate(["walk.npy", "sub/turn.npy", "sub/wave hello ä.npy", "other/turn.npy"], start=1):
        write(root / name, seed, seconds=3 * seed)
    (root / "walk.txt").write_text("a person walks\nsomeone goes ahead\n")
    (root / "captions.csv").write_text("path,text,start,end\nsub/turn.npy,turns left,1,2\nwalk.npy,a person walks,,\n")
    indexing.index(root, bundle=bundle)
    return root


@pytest.fixture
def library(folder, bundle):
    with StoredLibrary.open(folder, bundle=bundle) as opened:
        yield opened


def test_a_library_is_opened_by_the_indexed_folder_or_by_its_own(folder, bundle):
    for place in (folder, str(folder), folder / FOLDER):
        with StoredLibrary.open(place) as library:
            assert len(library) == 4
            assert library.roots == [folder]


def test_opening_a_folder_without_a_library_says_what_to_do(tmp_path):
    with pytest.raises(LibraryNotFound, match=r"no library here; make one with motionseek.index or 'motionseek index "):
        StoredLibrary.open(tmp_path)


def test_an_empty_library_can_be_searched(tmp_path):
    with StoredLibrary.open(tmp_path / "new", create=True) as library:
        assert len(library) == 0
        assert library.ids().tolist() == []
        assert library.nearest_clips(np.zeros((1, 16), np.float32), 2)[1].tolist() == [[-1, -1]]
        assert library.nearest_windows(np.zeros((1, 16), np.float32), 2)[1].tolist() == [[-1, -1]]
        assert library.stats()["clips"] == 0


def test_a_clip_says_what_it_is(library, folder):
    clip = library.find("sub/wave hello ä.npy")
    assert (clip.path, clip.root, clip.name) == ("sub/wave hello ä.npy", folder, "wave hello ä")
    assert (clip.duration, clip.fps, clip.frames, clip.format, clip.rig) == (9.0, 20.0, 180, "npy", "rig")
    assert clip.file.is_file()
    assert library.clips_by_id([clip.id, 999, clip.id]) == {clip.id: clip}


def test_clips_are_found_by_path_name_and_number(library, folder, monkeypatch):
    walk = library.find("walk.npy")
    assert library.find(folder / "walk.npy") == walk
    assert library.find("walk") == walk
    assert library.find(f"#{walk.id}") == walk
    assert library.find("sub\\turn.npy").path == "sub/turn.npy"
    monkeypatch.chdir(folder / "sub")
    assert library.find("./turn.npy").path == "sub/turn.npy"


@pytest.mark.parametrize(
    ("ref", "reason"),
    [
        ("#77", "no clip of that number"),
        ("nothing.bvh", "no clip of that path or name"),
        ("turn", "2 clips are called so"),
        ("", "no clip of that path or name"),
        ("a\0b", "no clip of that path or name"),
        ("\ud800", "no clip of that path or name"),
        ("#" + "9" * 40, "no clip of that number"),
        ("#" + "9" * 9000, "no clip of that number"),
        ("#²", "no clip of that path or name"),
        ("x" * 9000, "no clip of that path or name"),
    ],
)
def test_what_is_not_one_clip_is_an_error(library, ref, reason):
    with pytest.raises(UnknownClip, match=reason):
        library.find(ref)


@pytest.mark.parametrize("ref", [5, None, b"walk", ["walk"], True])
def test_a_clip_is_named_by_a_string_or_a_path(library, ref):
    with pytest.raises(ArgumentError, match="ref="):
        library.find(ref)


@pytest.mark.parametrize("method", ["clip", "motion", "captions", "windows"])
def test_a_number_that_no_clip_has_is_an_error_of_every_method(library, method):
    for number in (999, 0, -1, 2**70, -(2**70)):
        with pytest.raises(UnknownClip, match=f"no clip #{number}"):
            getattr(library, method)(number)
    for number in ("1", 1.0, None, True, float("nan")):
        with pytest.raises(ArgumentError, match="id="):
            getattr(library, method)(number)
    assert library.clips_by_id([2**70]) == {}
    with pytest.raises(UnknownClip, match="very many digits"):
        library.clip(10**9000)
    with pytest.raises(ArgumentError, match="ids=5"):
        library.clips_by_id(5)


@pytest.mark.parametrize(
    ("where", "values"), [("nonsense (", []), ("clips.id = ?", [object()]), ("clips.id = ?", [2**70])]
)
def test_what_is_no_condition_is_an_error(library, where, values):
    with pytest.raises(QueryError, match="where="):
        library.ids(where, values)


def test_a_folder_of_too_long_a_name_is_no_library(tmp_path):
    with pytest.raises(LibraryNotFound):
        StoredLibrary.open(tmp_path / ("x" * 5000))
    with pytest.raises(LibraryError, match="cannot be written"):
        StoredLibrary.open(tmp_path / ("x" * 5000), create=True)


def test_a_folder_that_cannot_be_looked_into_is_not_said_to_hold_no_library(folder, monkeypatch):
    look = Path.stat

    def refused(path, **more):
        if path.parent.name == FOLDER:
            raise PermissionError(13, "Permission denied")
        return look(path, **more)

    monkeypatch.setattr(Path, "stat", refused)
    with pytest.raises(LibraryError, match="permission denied; ask its owner"):
        StoredLibrary.open(folder)


@pytest.mark.parametrize(
    ("name", "value"), [("start", float("nan")), ("end", float("inf")), ("start", "1"), ("end", True), ("end", 10**400)]
)
def test_a_span_is_of_finite_numbers(library, name, value):
    with pytest.raises(ArgumentError, match=f"{name}="):
        library.motion(1, **{name: value})


@pytest.mark.parametrize(
    ("name", "value"),
    [("folder", 5), ("folder", None), ("folder", ""), ("folder", b"x"), ("folder", "a\0b"), ("bundle", "x"),
     ("bundle", SmallBundle), ("bundle", object()), ("create", "yes"), ("create", None)],
)  # fmt: skip
def test_arguments_of_open_are_refused_by_name(tmp_path, name, value):
    with pytest.raises(ArgumentError, match=name):
        StoredLibrary.open(**{"folder": tmp_path / "new", "create": True, name: value})
    assert not (tmp_path / "new").exists()


@pytest.mark.parametrize(
    ("member", "value"),
    [("name", 3), ("name", ""), ("fingerprint", None), ("fingerprint", "\ud800"), ("fps", 0), ("fps", "20"),
     ("fps", float("nan")), ("max_frames", 1.5), ("latent_size", True), ("latent_size", 0), ("encode_texts", 5)],
)  # fmt: skip
def test_a_model_without_what_it_must_have_is_refused(tmp_path, member, value):
    wrong = SmallBundle()
    setattr(wrong, member, value)
    with pytest.raises(ArgumentError, match=f"bundle=.*missing or wrong: {member}"):
        StoredLibrary.open(tmp_path, bundle=wrong, create=True)


def test_threads_may_make_one_library(tmp_path):
    errors = []

    def make():
        try:
            with StoredLibrary.open(tmp_path / "new", create=True) as library:
                assert len(library) == 0
        except Exception as error:
            errors.append(error)

    threads = [threading.Thread(target=make) for _ in range(8)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert errors == []


def test_motions_come_back_to_within_a_millimetre(library):
    clip = library.find("other/turn.npy")
    motion = library.motion(clip.id)
    assert np.abs(motion.joints - moving(4, 12)).max() < 1e-3
    assert motion.fps == 20.0


@pytest.mark.parametrize("span", [(0, 1), (9.5, 10.5), (11.9, 12), (3.02, None), (None, 99), (10, 10.01)])
def test_a_span_of_a_motion_is_a_crop_of_it(library, span):
    clip = library.find("other/turn.npy")
    whole = library.motion(clip.id)
    want = whole.crop(span[0] or 0.0, span[1])
    np.testing.assert_array_equal(library.motion(clip.id, *span).joints, want.joints)


def test_reading_a_span_reads_only_its_chunks(library, monkeypatch):
    clip = library.find("other/turn.npy")
    asked = []
    monkeypatch.setattr("indexer.store.poses.unpack", lambda blob, unpack=poses.unpack: asked.append(1) or unpack(blob))
    library.motion(clip.id, 1, 2)
    assert len(asked) == 1


@pytest.mark.parametrize("span", [(12, 13), (3, 3), (4, 2)])
def test_a_span_outside_the_motion_is_an_error(library, span):
    with pytest.raises(QueryError, match="lies outside"):
        library.motion(library.find("other/turn.npy").id, *span)


def test_captions_keep_their_spans_and_appear_once(library):
    assert library.captions(library.find("sub/turn.npy").id) == [Caption("turns left", 1.0, 2.0)]
    walks = library.captions(library.find("walk").id)
    assert sorted(c.text for c in walks) == ["a person walks", "someone goes ahead"]


def test_caption_vectors_are_those_of_the_model(library, bundle):
    texts, ids, latents = library.caption_vectors()
    assert sorted(texts) == ["a person walks", "someone goes ahead", "turns left"]
    assert latents.dtype == np.float32
    np.testing.assert_allclose(latents, bundle.encode_texts(texts), atol=1e-3)
    assert ids[texts.index("turns left")] == library.find("sub/turn.npy").id


def test_every_clip_is_nearest_to_itself(library, bundle):
    ids = library.ids()
    queries = bundle.encode_motions([library.motion(i) for i in ids])
    scores, found = library.nearest_clips(queries, 1)
    assert found[:, 0].tolist() == ids.tolist()
    np.testing.assert_allclose(scores[:, 0], 1, atol=2e-3)


def test_every_window_is_nearest_to_itself_and_says_when_it_is(library, bundle):
    for clip_id in library.ids():
        features = bundle.features(library.motion(clip_id))
        for windows in library.windows(clip_id):
            at = len(windows.starts) // 2
            first, last = round(windows.starts[at] * 10), round(windows.ends[at] * 10)
            query = bundle.encode_features([features[first:last]])
            scores, ids, starts, ends = (array[0] for array in library.nearest_windows(query, 20))
            assert ids[0] == clip_id
            assert scores[0] > 0.998
            spans = list(zip(starts[ids == clip_id], ends[ids == clip_id], strict=True))
            assert (windows.starts[at], windows.ends[at]) in spans  # swinging arms make others like it


def test_windows_lie_inside_their_clip(library):
    for clip_id in library.ids():
        windows = library.windows(clip_id)
        duration = library.clip(clip_id).duration
        assert [w.length for w in windows] == [length for length in (1.6, 3.2, 6.4) if length <= duration]
        for w in windows:
            assert w.vectors.shape == (len(w.starts), 16)
            assert w.vectors.dtype == np.float16
            assert w.ends[-1] == pytest.approx(duration)


def test_allowed_clips_alone_are_found(library, bundle):
    walk, turn = library.find("walk").id, library.find("sub/turn.npy").id
    query = bundle.encode_motions([library.motion(walk)])
    assert library.nearest_clips(query, 3, allowed=np.array([turn]))[1].tolist() == [[turn, -1, -1]]
    assert set(library.nearest_windows(query, 50, allowed=np.array([turn]))[1][0]) == {turn, -1}


def test_conditions_on_clips_are_bound_and_never_pasted(library):
    assert {clip.name for clip in library.clips_by_id(library.ids("duration >= ?", [9])).values()} == {
        "wave hello ä",
        "turn",
    }
    assert len(library.ids("path GLOB ?", ["*/turn.npy"])) == 2
    assert library.ids("clips.name = ?", ["x' OR 1=1 --"]).tolist() == []
    assert len(library.ids("duration < ? OR duration > ?", [100, 100])) == 4


def test_another_model_is_refused_and_the_message_says_what_to_do(folder):
    with pytest.raises(BundleMismatch, match=r"made with the model small .* not with other .* rebuild=True"):
        StoredLibrary.open(folder, bundle=SmallBundle("other"))


def test_stats_and_failures_tell_what_is_there(library):
    stats = library.stats()
    assert (stats["clips"], stats["seconds"], stats["captions"], stats["failed"]) == (4, 30.0, 4, 0)
    assert stats["windows"] == sum(len(w.starts) for i in library.ids() for w in library.windows(i))
    assert stats["formats"] == {"npy": 4}
    assert stats["vector_index"] == {"clips": "every vector compared", "windows": "every vector compared"}
    assert stats["bytes"] > 0
    assert library.failures() == []


def test_what_is_written_elsewhere_is_seen_at_the_next_question(library, folder, bundle):
    query = bundle.encode_motions([Motion(moving(77).astype(np.float32))])
    before = library.generation
    assert library.nearest_clips(query, 9)[1][0, 4] == -1
    write(folder / "new.npy", 77)
    (folder / "walk.npy").unlink()
    indexing.index(folder, bundle=bundle)
    assert library.generation > before
    assert library.clip(library.nearest_clips(query, 1)[1][0, 0]).path == "new.npy"
    assert len(set(library.nearest_clips(query, 9)[1][0]) - {-1}) == len(library) == 4
    assert "walk.npy" not in {
        clip.path for clip in library.clips_by_id(library.nearest_windows(query, 99)[1][0]).values()
    }


def test_threads_can_share_a_library(library, bundle):
    query = bundle.encode_motions([library.motion(1)])
    found, errors = [], []

    def ask():
        try:
            found.append((library.nearest_clips(query, 2)[1].tolist(), library.find("walk").id, len(library.motion(2))))
        except Exception as error:
            errors.append(error)

    threads = [threading.Thread(target=ask) for _ in range(8)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert errors == []
    assert all(answer == found[0] for answer in found)


def test_vector_files_may_be_deleted_and_come_back(folder, bundle):
    with StoredLibrary.open(folder, bundle=bundle) as library:
        query = bundle.encode_motions([library.motion(1)])
        want = library.nearest_windows(query, 20)
    for path in sorted((folder / FOLDER / "vectors").rglob("*"), reverse=True):
        path.rmdir() if path.is_dir() else path.unlink()
    with StoredLibrary.open(folder, bundle=bundle) as library:
        for got, expected in zip(library.nearest_windows(query, 20), want, strict=True):
            np.testing.assert_array_equal(got, expected)
    assert len(list((folder / FOLDER / "vectors").iterdir())) == 1


def test_vector_files_of_a_library_that_lay_here_before_are_not_used(folder, bundle):
    for path in (folder / FOLDER).glob(f"{FILE}*"):
        path.unlink()
    write(folder / "walk.npy", 50)
    indexing.index(folder, bundle=bundle)
    with StoredLibrary.open(folder, bundle=bundle) as library:
        query = bundle.encode_motions([Motion(moving(50).astype(np.float32))])
        scores, ids = library.nearest_clips(query, 1)
        assert library.clip(ids[0, 0]).path == "walk.npy"
        assert scores[0, 0] > 0.998


def test_an_indexed_folder_can_be_renamed_with_its_library(folder, bundle):
    moved = folder.rename(folder.parent / "renamed")
    with StoredLibrary.open(moved, bundle=bundle) as library:
        assert library.roots == [moved]
        assert library.find("walk").file.is_file()
    assert indexing.index(moved, bundle=bundle).unchanged == 4


@pytest.mark.parametrize(
    ("content", "reason"),
    [
        (b"no database" * 100, "opened as a library.*motionseek check --repair "),
        (b"", "not finished: .*; run .motionseek index. again"),
    ],
)
def test_a_damaged_library_is_an_error_that_says_so(tmp_path, content, reason):
    (tmp_path / FILE).write_bytes(content)
    with pytest.raises(LibraryDamaged, match=reason):
        len(StoredLibrary.open(tmp_path))


def test_a_library_of_a_newer_program_is_refused(tmp_path):
    StoredLibrary.open(tmp_path, create=True).close()
    connection = schema.connect(tmp_path / FILE, writable=True)
    connection.execute("PRAGMA user_version = 99")
    connection.close()
    with pytest.raises(LibraryError, match="written by a newer motionseek"):
        len(StoredLibrary.open(tmp_path))


def test_migrations_run_once_and_in_order(tmp_path, monkeypatch):
    StoredLibrary.open(tmp_path, create=True).close()
    ran = []
    monkeypatch.setattr(schema, "MIGRATIONS", [*schema.MIGRATIONS, lambda db: ran.append("second")])
    for _ in range(2):
        connection = schema.connect(tmp_path / FILE, writable=True)
        schema.migrate(connection)
        connection.close()
    assert ran == ["second"]


def test_a_closed_library_fails(folder):
    library = StoredLibrary.open(folder)
    library.close()
    with pytest.raises(LibraryError, match="is closed"):
        len(library)


def test_names_and_captions_can_be_searched_as_text(library):
    found = library.connection.execute(
        "SELECT text FROM texts WHERE id IN (SELECT rowid FROM texts_fts WHERE texts_fts MATCH 'turns')"
    ).fetchall()
    assert found == [("turns left",)]


def test_a_log_that_cannot_be_read_is_not_left_out_without_a_word(tmp_path, monkeypatch):
    """SQLite cannot read a log in a read-only folder without its shared memory, and would ignore it as immutable."""
    add(tmp_path, [NewClip("a", moving(1))], SmallBundle())
    real = sqlite3.connect

    def connect(database, **options):
        if "mode=ro" in str(database):
            raise sqlite3.OperationalError("unable to open database file")
        return real(database, **options)

    monkeypatch.setattr("indexer.store.schema.sqlite3.connect", connect)
    monkeypatch.setattr("indexer.store.schema.os.access", lambda path, mode: mode != os.W_OK)
    with StoredLibrary.open(tmp_path) as library:
        assert len(library) == 1
    (tmp_path / "library.sqlite-wal").write_bytes(b"changes")
    with pytest.raises(LibraryError, match=r"library\.sqlite-wal.*copy the whole folder"):
        StoredLibrary.open(tmp_path).clip(1)


def test_a_library_in_a_folder_that_others_write_is_read_again_when_it_changes(tmp_path, monkeypatch):
    add(tmp_path, [NewClip("a", moving(1))], SmallBundle())
    real = schema._connect
    file = tmp_path / "library.sqlite"

    def frozen(path, mode):
        if mode != "ro":
            return real(path, mode)
        return sqlite3.connect(f"{file.as_uri()}?immutable=1", uri=True, factory=schema.FrozenConnection)

    monkeypatch.setattr(schema, "_connect", frozen)
    with StoredLibrary.open(tmp_path) as library:
        assert len(library) == 1
        add(tmp_path, [NewClip("b", moving(2))], SmallBundle())
        os.utime(file)
        assert len(library) == 2


def test_a_library_put_in_the_place_of_another_is_read(tmp_path):
    for name, count in (("one", 1), ("two", 2)):
        add(tmp_path / name, [NewClip(f"{i}", moving(i)) for i in range(count)], SmallBundle())
    with StoredLibrary.open(tmp_path / "one", bundle=SmallBundle()) as library:
        assert len(library) == 1
        (tmp_path / "one").rename(tmp_path / "aside")
        with pytest.raises(LibraryNotFound, match="cannot be reached any more"):
            len(library)
        (tmp_path / "two").rename(tmp_path / "one")
        assert len(library) == 2
        assert set(library.nearest_clips(np.eye(16, dtype=np.float32)[:1], 5)[1][0].tolist()) == {1, 2, -1}


def test_damage_in_the_middle_of_the_file_is_named(tmp_path):
    add(tmp_path, [NewClip(f"{i}", moving(i)) for i in range(20)], SmallBundle())
    file = tmp_path / "library.sqlite"
    data = bytearray(file.read_bytes())
    data[4096 : len(data) - 4096] = bytes(len(data) - 8192)
    file.write_bytes(data)
    with StoredLibrary.open(tmp_path) as library, pytest.raises(LibraryDamaged, match=r"library\.sqlite"):
        library.clips_by_id(range(20))
