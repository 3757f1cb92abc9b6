"""A library from arrays: added, replaced, removed, and left alone by the indexing of folders."""

import threading

import numpy as np
import pytest

from encoders.errors import ArgumentError, BundleError, BundleMismatch, LibraryLocked, UnknownClip
from encoders.motion import Motion
from indexer.ingest.arrays import NewClip, add, remove, to_motion
from indexer.ingest.indexing import index
from indexer.ingest.load import load_motion
from indexer.ingest.reencode import reencode
from indexer.store.clips import Caption
from indexer.store.library_reader import FOLDER
from indexer.store.lock import write_lock
from indexer.store.stored_library import StoredLibrary
from tests.indexer.folders import SmallBundle, moving, write


@pytest.fixture
def bundle():
    return SmallBundle()


@pytest.fixture
def place(tmp_path):
    return tmp_path / "library"


def motion(seed, seconds=4.0):
    return Motion(moving(seed, seconds).astype(np.float32))


def test_clips_are_added_without_files_and_found(place, bundle):
    numbers = add(
        place,
        [
            NewClip("walk", motion(1), "a person walks"),
            NewClip("day 1/turn.v2", motion(2), ["turns", Caption("turns left", 1, 2), "turns", " "]),
        ],
        bundle,
    )
    with StoredLibrary.open(place, bundle=bundle) as library:
        clips = library.clips_by_id(numbers)
        walk, turn = clips[numbers[0]], clips[numbers[1]]
        assert (walk.path, walk.name, walk.format, walk.file, walk.frames) == ("walk", "walk", "array", None, 80)
        assert (turn.path, turn.name) == ("day 1/turn.v2", "turn.v2")
        assert library.find("day 1/turn.v2") == turn
        assert library.find("turn.v2") == turn
        assert library.captions(turn.id) == [Caption("turns"), Caption("turns left", 1.0, 2.0)]
        assert library.roots == []
        assert library.stats()["formats"] == {"array": 2}
        np.testing.assert_allclose(library.motion(walk.id).joints, motion(1).joints, atol=2e-4)
        assert library.nearest_clips(bundle.encode_motions([motion(2)]), 1)[1].item() == turn.id
        texts, owners, vectors = library.caption_vectors()
        assert sorted(zip(owners.tolist(), texts, strict=True)) == [
            (walk.id, "a person walks"),
            (turn.id, "turns"),
            (turn.id, "turns left"),
        ]
        np.testing.assert_allclose(vectors, bundle.encode_texts(texts), atol=1e-3)


def test_the_axis_of_an_array_may_be_given(place, bundle):
    add(place, [NewClip(axis, moving(1, 4.0), up=axis) for axis in ("y", "z")], bundle)
    with StoredLibrary.open(place) as library:
        assert [(clip.path, clip.up, clip.up_reason) for clip in library.clips()] == [(a, a, "given") for a in "yz"]


def test_an_array_is_read_as_a_file_of_it_would_be(tmp_path):
    path = tmp_path / "a.npy"
    joints = moving(3, fps=30) * 100  # centimetres
    np.save(path, joints)
    np.testing.assert_array_equal(to_motion(joints, 30).motion.joints, load_motion(path, fps=30).joints)
    np.testing.assert_array_equal(to_motion(moving(3).tolist()).motion.joints, to_motion(moving(3)).motion.joints)


def test_a_motion_is_taken_as_it_is_at_twenty_frames_a_second():
    given = Motion(moving(1, fps=40), 40)
    taken = to_motion(given).motion
    assert taken.fps == 20
    np.testing.assert_array_equal(taken.joints, given.resample(20).joints)


def test_an_id_given_again_replaces_the_clip_and_its_captions(place, bundle):
    (first,) = add(place, [NewClip("a", motion(1), "walks")], bundle)
    with StoredLibrary.open(place, bundle=bundle) as library:
        assert library.nearest_clips(bundle.encode_motions([motion(1)]), 1)[0].item() > 0.999
        before = library.captions_generation
        assert add(place, [NewClip("a", motion(2), "sits")], bundle) == [first]
        assert library.captions(first) == [Caption("sits")]
        assert library.captions_generation > before
        assert len(library) == 1
        scores, found = library.nearest_clips(bundle.encode_motions([motion(2)]), 2)
        assert found.tolist() == [[first, -1]]
        assert scores[0, 0] > 0.999


def test_removed_clips_are_found_no_more_and_their_ids_are_free_again(place, bundle):
    first, second = add(place, [NewClip("a", motion(1), "walks"), NewClip("b", motion(2))], bundle)
    with StoredLibrary.open(place, bundle=bundle) as library:
        assert set(library.nearest_clips(np.ones((1, 16), np.float32), 2)[1][0].tolist()) == {first, second}
        remove(place, ["a"])
        assert library.nearest_clips(np.ones((1, 16), np.float32), 2)[1].tolist() == [[second, -1]]
        assert library.caption_vectors()[0] == []
        with pytest.raises(UnknownClip):
            library.find("a")
        (again,) = add(place, [NewClip("a", motion(3))], bundle)
        assert again not in (first, second)
        assert library.find("a").id == again


def test_clips_are_removed_all_or_not_at_all(place, bundle):
    add(place, [NewClip("a", motion(1)), NewClip("b", motion(2))], bundle)
    with pytest.raises(UnknownClip, match="'nothing': no clip of that id"):
        remove(place, ["a", "nothing", "b"])
    with StoredLibrary.open(place) as library:
        assert len(library) == 2


def test_folders_are_indexed_into_the_same_library_and_arrays_stay(tmp_path, bundle):
    root = tmp_path / "takes"
    write(root / "file.npy", 1)
    place = root / FOLDER
    (number,) = add(place, [NewClip("file.npy", motion(2), "walks")], bundle)
    for _ in range(2):
        summary = index(root, bundle=bundle, jobs=1)
        assert (summary.gone, summary.failed, summary.warnings) == (0, [], [])
        with StoredLibrary.open(place, bundle=bundle) as library:
            assert library.roots == [root]
            assert [clip.root.name for clip in library.clips()] == ["arrays", "takes"]
            assert library.captions(number) == [Caption("walks")]
    index([], library=place, bundle=bundle)  # the folders it has
    assert reencode(place, SmallBundle("other")) == []
    with StoredLibrary.open(place) as library:
        assert len(library) == 2


def test_batches_are_committed_as_they_fill(place, bundle, monkeypatch):
    def items():
        yield from (NewClip(f"{i}", motion(i, 400.0)) for i in range(2))
        with StoredLibrary.open(place) as library:
            assert len(library) == 2
        yield NewClip("", motion(9))

    with pytest.raises(ArgumentError, match="id ''"):
        add(place, items(), bundle)
    with StoredLibrary.open(place) as library:
        assert [clip.path for clip in library.clips()] == ["0", "1"]


@pytest.mark.parametrize(
    ("item", "reason"),
    [
        (NewClip("/abs", motion(1)), "id '/abs' must be a path"),
        (NewClip("#3", motion(1)), "not begin with #"),
        (NewClip("a/../b", motion(1)), "must be a path"),
        (NewClip("a//b", motion(1)), "must be a path"),
        (NewClip(7, motion(1)), "id 7 must be a string"),
        (NewClip("\ud800", motion(1)), "valid Unicode"),
        (NewClip("a", np.zeros((4, 21, 3))), r"a: .* joints.shape=\(4, 21, 3\)"),
        (NewClip("a", np.full((4, 22, 3), np.nan)), "must be finite"),
        (NewClip("a", np.zeros((4, 22, 3))), "a: .* same place"),
        (NewClip("a", "walk.bvh"), "a Motion or an array"),
        (NewClip(" ", motion(1)), "id ' ' must have no"),
        (NewClip("\ufeff", motion(1)), "must have no control characters"),
        (NewClip("a/ /b", motion(1)), "must have no control characters"),
        (NewClip("a", moving(1), fps=10**9000), "fps=int of very many digits"),
        (NewClip("a", motion(1), captions=Caption("walks", 0, 10**9000)), "end=int of very many digits"),
        (NewClip(" a", motion(1)), "id ' a' must have no"),
        (NewClip("a/b ", motion(1)), "id 'a/b ' must have no"),
        (NewClip("a\nb", motion(1)), r"id 'a\\nb' must have no control"),
        (NewClip("a\0b", motion(1)), r"id 'a\\x00b' must have no control"),
        (NewClip("a\u2028b", motion(1)), "must have no control"),
        (NewClip(b"a", motion(1)), "id b'a' must be a string"),
        (NewClip("a", moving(1).astype(complex)), "not of complex128"),
        (NewClip("a", moving(1).astype(str)), "not of <U"),
        (NewClip("a", moving(1).astype(object)), "not of object"),
        (NewClip("a", moving(1) > 0), "not of bool"),
        (NewClip("a", np.ma.masked_less(moving(1), 0)), "not of masked values"),
        (NewClip("a", None), "a Motion or an array"),
        (NewClip("a", [[1, 2], [3]]), "a Motion or an array"),
        (NewClip("a", moving(1), fps=True), "fps=True"),
        (NewClip("a", moving(1), fps=1e9), "fps=1000000000.0"),
        (NewClip("a", Motion(moving(1), 1e-300)), "motion.fps=1e-300"),
        (NewClip("a", motion(1), captions=b"walks"), "captions must be strings"),
        (NewClip("a", motion(1), captions={"walks": 1}), "captions must be strings"),
        (NewClip("a", motion(1), captions=Caption(None)), "captions must be strings"),
        (NewClip("a", motion(1), captions=Caption("walks", 0, float("inf"))), "end=inf"),
        (NewClip("a", motion(1), captions=Caption("walks", float("nan"), 1)), "start=nan"),
        (NewClip("a", motion(1), captions=Caption("walks", -1, 1)), "start=-1"),
        (NewClip("a", motion(1), captions=Caption("walks", 1, 1)), "start=1 and end=1"),
        (NewClip("a", motion(1), captions=Caption("walks", "0", 1)), "start='0'"),
        (NewClip("a", motion(1), captions=Caption("walks", False, 1)), "start=False"),
        (NewClip("a", motion(1), captions=Caption("walks", 1)), "start=1 and end=None"),
        (("a", motion(1)), "a list of NewClip, not of tuple"),
        (NewClip("a", moving(1), fps=float("nan")), "fps=nan"),
        (NewClip("a", moving(1), fps="20"), "fps='20'"),
        (NewClip("a", motion(1), fps=30), "not the motion's own 20"),
        (NewClip("a", motion(1), up="z"), "a Motion is Y up"),
        (NewClip("a", moving(1), up="upwards"), "must be one of x, y, z"),
        (NewClip("a", motion(1), captions=[3]), "captions must be strings"),
        (NewClip("a", motion(1), captions=3), "captions must be strings"),
        (NewClip("a", motion(1), captions="x" * 3000), "at most 2000 characters"),
        (NewClip("a", motion(1), captions=Caption("walks", 2, 1)), "start=2 and end=1"),
    ],
)
def test_what_makes_no_sense_is_refused_and_nothing_is_added(place, bundle, item, reason):
    with pytest.raises(ArgumentError, match=reason):
        add(place, [NewClip("good", motion(1)), item], bundle)
    with StoredLibrary.open(place) as library:
        assert len(library) == 0


def test_a_library_of_another_model_or_one_being_written_is_refused(place, bundle):
    add(place, [NewClip("a", motion(1))], bundle)
    with pytest.raises(BundleMismatch):
        add(place, [NewClip("b", motion(2))], SmallBundle("other"))
    with write_lock(place), pytest.raises(LibraryLocked):
        remove(place, ["a"])


def test_clips_come_in_order_of_their_numbers(place, bundle):
    numbers = add(place, [NewClip(f"clip {i}", motion(i, 0.5)) for i in range(70)], bundle)
    with StoredLibrary.open(place) as library:
        assert [clip.id for clip in library.clips()] == sorted(numbers)


@pytest.mark.parametrize("items", [None, 5, "a", NewClip("a", motion(1)), {"a": motion(1)}])
def test_clips_to_add_come_in_a_list(place, bundle, items):
    with pytest.raises(ArgumentError, match="must be a list of NewClip"):
        add(place, items, bundle)
    assert not place.exists()


@pytest.mark.parametrize("id", [["a"], 3, None, "\ud800"])
def test_what_is_removed_is_named_by_strings(place, bundle, id):
    add(place, [NewClip("a", motion(1))], bundle)
    with pytest.raises(ArgumentError, match="id "):
        remove(place, ["a", id])
    with StoredLibrary.open(place) as library:
        assert len(library) == 1


def test_threads_that_add_wait_for_each_other(place, bundle):
    errors = []

    def add_some(thread):
        try:
            for number in range(5):
                add(place, [NewClip(f"{thread}/{number}", motion(number, 0.5))], bundle)
                remove(place, [f"{thread}/{number}"]) if number % 2 else None
        except Exception as error:
            errors.append(error)

    threads = [threading.Thread(target=add_some, args=[number]) for number in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert errors == []
    with StoredLibrary.open(place) as library:
        assert len(library) == 12


def test_adding_while_clips_are_added_is_refused_and_not_waited_for(place, bundle):
    def items():
        add(place, [NewClip("inner", motion(1))], bundle)
        yield NewClip("outer", motion(2))

    with pytest.raises(LibraryLocked, match="being written by process"):
        add(place, items(), bundle)


class BadBundle(SmallBundle):
    """Gives vectors that something has been done to."""

    def __init__(self, change, texts=lambda vectors: vectors):
        super().__init__()
        self.change, self.texts = change, texts

    def encode_features(self, features):
        return self.change(super().encode_features(features))

    def encode_texts(self, sentences):
        return self.texts(super().encode_texts(sentences))


@pytest.mark.parametrize(
    "change",
    [
        lambda vectors: vectors[:, :8],
        lambda vectors: vectors * np.nan,
        lambda vectors: vectors * 2,
        lambda vectors: vectors * 0,
        lambda vectors: vectors[:-1],
        lambda vectors: vectors[0],
        lambda vectors: vectors.tolist(),
        lambda vectors: vectors.astype(complex),
        lambda vectors: vectors * np.where(np.arange(len(vectors)) < 1, 1, 3)[:, None],  # windows alone
    ],
)
def test_a_model_of_other_than_unit_vectors_is_refused_and_leaves_nothing(place, change):
    bad = BadBundle(change)
    with pytest.raises(BundleError, match=r"small: vectors of (motions|windows) must be"):
        add(place, [NewClip("a", motion(1), "walks")], bad)
    good = SmallBundle("another")  # the library is nobody's yet
    assert len(add(place, [NewClip("a", motion(1))], good)) == 1
    with pytest.raises(BundleError):
        reencode(place, bad)
    with StoredLibrary.open(place, bundle=good) as library:
        assert len(library) == 1


def test_captions_without_unit_vectors_are_refused_with_their_clips(place):
    with pytest.raises(BundleError, match="vectors of captions"):
        add(place, [NewClip("a", motion(1), "walks")], BadBundle(lambda v: v, lambda v: v * np.inf))
    with StoredLibrary.open(place) as library:
        assert len(library) == 0
        assert library.caption_vectors()[0] == []


def test_two_sizes_of_one_model_are_refused(place, bundle):
    add(place, [NewClip("a", motion(1))], bundle)
    with pytest.raises(BundleError, match=r"latent_size=8, but .* has vectors of 16 numbers"):
        add(place, [NewClip("b", motion(2))], SmallBundle(latent_size=8))
