"""The public interface: what a program can do with `import motionseek` and nothing else of the project."""

from __future__ import annotations

import copy
import importlib.metadata
import inspect
import pickle
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import motionseek
from tests.search.conftest import made_motion
from tests.search.fakes import MeanEncoder


@pytest.fixture(scope="module")
def bundle(tiny_bundle: Path) -> motionseek.Encoder:
    return motionseek.Bundle.load(tiny_bundle, threads=1)


@pytest.fixture(scope="module")
def library(tmp_path_factory: pytest.TempPathFactory, bundle: motionseek.Encoder) -> motionseek.Library:
    """Clips added as arrays. Not to be changed."""
    library = motionseek.open(tmp_path_factory.mktemp("arrays"), bundle=bundle, create=True)
    library.add_many(
        [
            motionseek.NewClip("walks/slow", made_motion(4, 1), "a person walks"),
            motionseek.NewClip("walks/fast", made_motion(8, 2), ["a man strolls", motionseek.Caption("runs", 1, 3)]),
            motionseek.NewClip("wave", made_motion(6, 3).joints, fps=20),
        ]
    )
    return library


@pytest.fixture(scope="module")
def indexed(tmp_path_factory: pytest.TempPathFactory, bundle: motionseek.Encoder) -> motionseek.Library:
    """Two folders in one library, with a file of one name in each. Not to be changed."""
    place = tmp_path_factory.mktemp("library")
    for number, seconds in ((1, 4), (2, 9)):
        folder = tmp_path_factory.mktemp("shoot") / "takes"
        folder.mkdir()
        np.save(folder / "one.npy", made_motion(seconds, number).joints)
        motionseek.index(folder, library=place, bundle=bundle, jobs=1)
    return motionseek.open(place, bundle=bundle)


def test_nothing_but_the_public_names_is_there() -> None:
    public = {name for name in dir(motionseek) if not (name.startswith("__") and name.endswith("__"))}
    assert public == set(motionseek.__all__)
    assert motionseek.__version__ == importlib.metadata.version("motionseek")


def test_every_public_name_and_method_is_documented() -> None:
    for name in motionseek.__all__:
        assert inspect.getdoc(getattr(motionseek, name)), name
    for name, method in inspect.getmembers(motionseek.Library, inspect.isfunction):
        if not name.startswith("_"):
            assert inspect.getdoc(method), name


def test_an_encoder_is_any_object_with_its_members(tmp_path: Path) -> None:
    encoder: motionseek.Encoder = MeanEncoder()
    found = motionseek.moments(None, made_motion(5, 1), then=["x"], bundle=_Deaf(encoder))
    assert len(found) > 0


class _Deaf(MeanEncoder):
    """Hears the same in every sentence."""

    latent_size = 66

    def __init__(self, _: object) -> None:
        super().__init__()

    def encode_texts(self, sentences: object) -> np.ndarray:
        return np.eye(66, dtype=np.float32)[:1].repeat(len(list(sentences)), axis=0)


def test_a_library_is_made_of_arrays(tmp_path: Path, bundle: motionseek.Encoder) -> None:
    with motionseek.open(tmp_path / "new", bundle=bundle, create=True) as library:
        number = library.add("walk", made_motion(4, 1).joints, captions=["a person walks"], fps=20)
        assert [clip.id for clip in library.clips()] == [number]
        assert library.search("walks", 1)[0].clip_id == number
        numbers = library.add_many(motionseek.NewClip(f"clip {i}", made_motion(3, i)) for i in range(3))
        assert len(library) == 4
        library.remove("walk", "clip 0")
        assert [clip.id for clip in library.clips()] == numbers[1:]
        with pytest.raises(motionseek.UnknownClip):
            library.remove("walk")


def test_a_library_of_arrays_changes_its_model(tmp_path: Path, bundle: motionseek.Encoder) -> None:
    with motionseek.open(tmp_path, bundle=bundle, create=True) as library:
        library.add("walk", made_motion(4, 1), "a person walks")
    own: motionseek.Encoder = _Deaf(None)
    with pytest.raises(motionseek.BundleMismatch, match="rebuild=True"):
        motionseek.open(tmp_path, bundle=own)
    motionseek.index([], library=tmp_path, bundle=own, rebuild=True)
    with motionseek.open(tmp_path, bundle=own) as library:
        assert [hit.path for hit in library.search("a person walks")] == ["walk"]


def test_a_closed_library_can_not_be_written(tmp_path: Path, bundle: motionseek.Encoder) -> None:
    library = motionseek.open(tmp_path / "new", bundle=bundle, create=True)
    library.add("walk", made_motion(2, 1))
    library.close()
    for write in (lambda: library.add("a", made_motion(2, 1)), lambda: library.remove("walk")):
        with pytest.raises(motionseek.LibraryError, match="is closed"):
            write()


def test_threads_that_share_a_library_may_all_add(tmp_path: Path, bundle: motionseek.Encoder) -> None:
    with motionseek.open(tmp_path / "new", bundle=bundle, create=True) as library:
        with ThreadPoolExecutor(4) as pool:
            numbers = list(pool.map(lambda i: library.add(f"clip {i}", made_motion(2, i), f"walks {i}"), range(8)))
        assert sorted(clip.id for clip in library.clips()) == sorted(numbers)
        assert len(library.caption_vectors()[0]) == 8


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("path", 5),
        ("path", None),
        ("path", b"a.npy"),
        ("path", ""),
        ("fps", "25"),
        ("fps", float("nan")),
        ("fps", -5),
        ("fps", 1e9),
        ("fps", True),
        ("joint_map", 5),
        ("joint_map", {"tail": "Tail"}),
        ("joint_map", {"head": None}),
    ],
)
def test_arguments_of_load_are_refused_by_name(tmp_path: Path, name: str, value: object) -> None:
    np.save(tmp_path / "a.npy", made_motion(2, 1).joints)
    with pytest.raises(motionseek.ArgumentError, match=name):
        motionseek.load(**{"path": tmp_path / "a.npy", name: value})


def test_clips_are_listed_by_filters(library: motionseek.Library) -> None:
    assert [clip.path for clip in library.clips()] == ["walks/slow", "walks/fast", "wave"]
    assert [clip.path for clip in library.clips(path="walks/*", min_duration=np.float32(5))] == ["walks/fast"]


def test_hits_of_two_files_of_one_name_are_told_apart(indexed: motionseek.Library) -> None:
    found = indexed.search("walks")
    assert [hit.path for hit in found] == ["one.npy", "one.npy"]
    assert {hit.root for hit in found} == {"takes", "takes (2)"}
    for hit in found:
        assert hit.file is not None
        assert hit.file.is_absolute()
        assert hit.file.is_file()
        assert indexed.clip(hit.clip_id).file == hit.file
        assert (hit.document()["clip"], hit.document()["root"]) == (hit.clip_id, hit.root)
        assert str(hit.file.parent) not in str(hit.document()), "an absolute path is for Python only"
        assert indexed.find(indexed.reference(hit.root, hit.path)).id == hit.clip_id
    with pytest.raises(motionseek.UnknownClip, match=r"takes/one.npy \(#1\), takes \(2\)/one.npy \(#2\)$"):
        indexed.describe("one.npy")


def test_a_vector_is_a_query(library: motionseek.Library, bundle: motionseek.Encoder) -> None:
    vector = bundle.encode_motions([library.motion(2)])[0]
    assert library.similar(vector, 1)[0].clip_id == 2
    assert [hit.clip_id for hit in library.similar(8 * vector, 3)] == [h.clip_id for h in library.similar(vector, 3)]
    assert len(library.similar(vector, 2, moments=True)) > 0
    assert library.search(vector, 1)[0].clip_id == 2


def test_one_rule_for_vectors(library: motionseek.Library, bundle: motionseek.Encoder) -> None:
    vector = bundle.encode_motions([library.motion(2)])[0]
    for ask in (library.search, library.similar):
        known = ask(vector)
        for same in (vector[None], vector.tolist(), [vector.tolist()], 1e200 * vector.astype(np.float64)):
            assert [hit.clip_id for hit in ask(same)] == [hit.clip_id for hit in known]
        for wrong in (vector[:5], np.full_like(vector, np.nan), np.zeros_like(vector), [], [[1], [2, 3]], [["a"]]):
            with pytest.raises(motionseek.ArgumentError, match="vector"):
                ask(wrong)
    with pytest.raises(motionseek.ArgumentError, match="vector is given"):
        library.similar(vector, start=1)


def test_a_partial_calibration_is_enough(tmp_path: Path) -> None:
    own = _Deaf(None)
    own.calibration = {"motions": np.eye(66, dtype=np.float32)}
    assert isinstance(own, motionseek.Encoder)
    assert not isinstance("a model", motionseek.Encoder)
    with motionseek.open(tmp_path, bundle=own, create=True) as library:
        library.add("walk", made_motion(4, 1), "a person walks")
        assert library.search("a person walks")[0].strength == ""
        assert library.similar(made_motion(4, 1))[0].strength == ""
        assert library.describe("walk", 1)
        assert library.segment("walk", ["walk"])


@pytest.mark.parametrize("kind", ["path", "clip", "hit", "motion", "array"])
def test_one_motion_is_meant_in_many_ways(indexed: motionseek.Library, kind: str) -> None:
    clip = next(iter(indexed.clips()))
    hit = next(hit for hit in indexed.search("walks") if hit.clip_id == clip.id)
    motion = indexed.motion(clip.id)
    assert clip.file is not None
    ref = {"path": clip.file, "clip": clip, "hit": hit, "motion": motion, "array": np.load(clip.file)}[kind]
    fps = {"fps": 20} if kind == "array" else {}
    span = (hit.start, hit.end)
    [(text, score)], [(said, known_score)] = (
        indexed.describe(r, 1, *span, **f) for r, f in ((ref, fps), (f"#{clip.id}", {}))
    )
    assert text == said
    assert score == pytest.approx(known_score, abs=0.01)
    found, known = indexed.moments("walks", ref, 1, **fps)[0], indexed.moments("walks", f"#{clip.id}", 1)[0]
    assert (found.start, found.end) == (known.start, known.end)
    assert found.score == pytest.approx(known.score, abs=0.02)
    others = {hit.clip_id for hit in indexed.similar(ref, **fps)}
    assert (clip.id not in others) == (kind in {"path", "clip", "hit"}), "never the clip itself, where it is known"


def test_a_hit_stands_for_its_span_where_a_span_is_asked_for(library: motionseek.Library) -> None:
    hit = library.moments("walks", "walks/fast", 1)[0]
    assert library.describe(hit) == library.describe("walks/fast", start=hit.start, end=hit.end)
    assert library.similar(hit) == library.similar("walks/fast", start=hit.start, end=hit.end)


def test_a_motion_needs_no_library(tmp_path: Path, bundle: motionseek.Encoder) -> None:
    motion = made_motion(8, 1)
    np.save(tmp_path / "take.npy", motion.joints)
    found = motionseek.moments("walks", motion, 3, bundle=bundle)
    assert [hit.rank for hit in found] == list(range(1, len(found) + 1))
    assert found[0].clip_id == -1
    assert found[0].read is not None
    assert found[0].read().duration == pytest.approx(found[0].end - found[0].start, abs=0.06)
    assert motionseek.moments("walks", tmp_path / "take.npy", 1, bundle=bundle)[0].file == tmp_path / "take.npy"
    assert len(motionseek.describe(motion.joints, 3, fps=30, bundle=bundle)) == 3
    assert motionseek.describe(found[0], bundle=bundle) == motionseek.describe(
        motion, start=found[0].start, end=found[0].end, bundle=bundle
    )
    segments = motionseek.segment(motion, ["walk", "sit"], bundle=bundle)
    assert (segments[0].start, segments[-1].end) == (0, 8)


def test_a_library_does_what_the_command_line_does(library: motionseek.Library, tmp_path: Path) -> None:
    segments = library.segment("walks/fast", ["walk", "run"])
    assert (segments[0].start, segments[-1].end) == (0, 8)
    assert {segment.label for segment in segments} <= {"walk", "run", ""}
    assert {s.label for s in library.segment("wave", captions=True)} <= {"a person walks", "a man strolls", "runs", ""}
    cut = library.export("walks/fast", tmp_path / "cut.bvh", 1, 3)
    assert motionseek.load(cut).duration == pytest.approx(2, abs=0.1)
    with pytest.raises(motionseek.ArgumentError, match="exists"):
        library.export("walks/fast", cut)
    assert library.export("walks/fast", cut, overwrite=True) == cut
    assert library.render("wave", tmp_path / "wave.png", size=np.int64(64)).read_bytes().startswith(b"\x89PNG")


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("k", 0),
        ("k", -1),
        ("k", 2.5),
        ("k", True),
        ("min_duration", float("nan")),
        ("max_duration", "5"),
        ("captioned", "yes"),
        ("path", 3),
        ("rig", b"cmu"),
        ("minimum", 3),
    ],
)
def test_what_makes_no_sense_is_refused_by_name(library: motionseek.Library, name: str, value: object) -> None:
    for ask in (library.search, library.moments, lambda text, **given: library.similar("wave", **given)):
        with pytest.raises(motionseek.ArgumentError, match=name):
            ask("walks", **{name: value})


def test_spans_rates_and_lists_are_refused_by_name(library: motionseek.Library, tmp_path: Path) -> None:
    with pytest.raises(motionseek.ArgumentError, match="then"):
        library.moments("walks", then="waves")
    with pytest.raises(motionseek.ArgumentError, match="meanwhile"):
        motionseek.moments("walks", made_motion(2, 1), meanwhile="waves")
    with pytest.raises(motionseek.ArgumentError, match="start"):
        library.describe("wave", start=float("nan"))
    with pytest.raises(motionseek.ArgumentError, match="start=-1"):
        library.describe("wave", start=-1)
    with pytest.raises(motionseek.ArgumentError, match="end=1 must be after start=2"):
        library.similar("wave", start=2, end=1)
    with pytest.raises(motionseek.ArgumentError, match="fps"):
        library.describe(made_motion(2, 1).joints, fps=float("nan"))
    for name, value in (("fps", 0), ("fps", float("inf")), ("size", 3)):
        with pytest.raises(motionseek.ArgumentError, match=name):
            library.render("wave", tmp_path / "wave.gif", **{name: value})
    with pytest.raises(motionseek.ArgumentError, match="labels"):
        library.segment("wave", "walk")
    with pytest.raises(motionseek.ArgumentError, match="path"):
        library.moments("walks", "wave", path="walks/*")
    with pytest.raises(motionseek.ArgumentError, match="int"):
        library.describe(3)


NUL, LONG, SURROGATE = "a\0b", "x" * 5000, "\ud800"


@pytest.mark.parametrize(
    "ask",
    [
        lambda library, _: library.search("walks", 10**30),
        lambda library, _: library.search("walks", path=SURROGATE),
        lambda library, _: library.search("walks", min_duration=10**400),
        lambda library, _: library.search("walks", max_duration=10**5000),
        lambda library, _: library.search(SURROGATE),
        lambda library, _: library.segment("wave", [SURROGATE]),
        lambda library, _: library.segment("wave", captions="yes"),
        lambda library, _: library.moments("walks", split_steps="no"),
        lambda library, _: library.similar("wave", moments="no"),
        lambda library, _: library.export("wave", 5),
        lambda library, _: library.export("wave", NUL + ".bvh"),
        lambda library, folder: library.export("wave", folder / "missing" / "cut.bvh"),
        lambda library, folder: library.export("wave", folder, overwrite=True),
        lambda library, folder: library.export("wave", folder / "cut.bvh", overwrite="no"),
        lambda library, folder: library.render("wave", folder / "missing" / "wave.png"),
        lambda library, folder: library.render("wave", folder / "wave.png", size=10**9),
        lambda library, folder: library.render("wave", folder / "wave.png", size=1),
        lambda library, folder: library.render("wave", folder / "wave.gif", fps="x"),
        lambda library, _: library.nearest_clips(np.zeros((1, 3), np.float32), 5),
        lambda library, _: library.nearest_windows(library.bundle.encode_texts(["walks"])[0], 5),
        lambda library, _: library.nearest_clips(library.bundle.encode_texts(["walks"]), 0),
        lambda library, _: library.bundle.encode_texts("walk"),
        lambda library, _: library.bundle.encode_texts([5]),
        lambda library, _: library.bundle.encode_motions([np.zeros((10, 22, 3))]),
        lambda library, _: library.bundle.encode_motions(made_motion(2, 1)),
        lambda library, _: library.clip("wave"),
        lambda library, _: library.motion(1, float("nan")),
        lambda library, _: library.describe(NUL),
        lambda library, _: library.describe("wave", fps=-1),
        lambda library, _: library.describe("wave", 1, 10**400),
        lambda library, _: library.clips(foo=1),
        lambda _, __: motionseek.describe(made_motion(2, 1), bundle="model"),
        lambda _, __: motionseek.Bundle.load(5),
    ],
)
def test_wrong_arguments_are_argument_errors(library: motionseek.Library, tmp_path: Path, ask: Any) -> None:
    with pytest.raises(motionseek.ArgumentError):
        ask(library, tmp_path)


def test_names_that_no_file_can_have_are_unknown(library: motionseek.Library, tmp_path: Path) -> None:
    for name in (LONG, SURROGATE, LONG + "/a.bvh", "#" + "9" * 30, "\udcff.bvh"):
        with pytest.raises(motionseek.MotionSeekError):
            library.describe(name)
        with pytest.raises(motionseek.MotionSeekError):
            motionseek.describe(name)
    with pytest.raises(motionseek.MotionSeekError, match="cannot be written"):
        library.export("wave", tmp_path / (LONG + ".bvh"))


def test_numbers_of_numpy_are_numbers(library: motionseek.Library) -> None:
    found = library.search("walks", np.int64(2), min_duration=np.float32(5), captioned=np.bool_(True))
    assert found == library.search("walks", 2, min_duration=5.0, captioned=True)
    assert library.describe("wave", np.int32(2), np.float32(1), np.float64(3)) == library.describe("wave", 2, 1, 3)


def test_hits_can_be_compared_pickled_and_written(library: motionseek.Library) -> None:
    found = library.moments("walks, then sits down", "walks/fast")
    again = pickle.loads(pickle.dumps(found))
    assert again == found == copy.deepcopy(found)
    assert again.to_dicts() == found.to_dicts() == [hit.document() for hit in found]
    assert list(found.to_dicts()[0]) == [
        "rank", "path", "score", "strength", "start", "end", "duration", "caption", "steps", "clip", "root",
        "source_fps", "first_frame", "last_frame", "stale", "matched", "starred", "tags", "collections",
    ]  # fmt: skip


def test_motions_can_be_compared_and_printed() -> None:
    motion = made_motion(12, 1)
    same = motionseek.Motion(motion.joints.copy())
    assert motion == same
    assert hash(motion) == hash(same)
    assert motion != motionseek.Motion(motion.joints, 30)
    assert motion != motion.crop(0, 5)
    assert motion != 3
    assert repr(motion) == "Motion(240 frames, 12.0 s at 20 fps)"
    assert pickle.loads(pickle.dumps(motion)) == motion


def test_errors_say_their_cause(tmp_path: Path, library: motionseek.Library) -> None:
    with pytest.raises(motionseek.LibraryNotFound):
        motionseek.open(tmp_path)
    with pytest.raises(motionseek.UnknownClip):
        library.describe("no such clip")
    with pytest.raises(motionseek.UnreadableMotion):
        motionseek.describe(tmp_path / "missing.bvh")
    with pytest.raises(motionseek.QueryError, match="empty"):
        library.search("")
    for error in (motionseek.LibraryNotFound, motionseek.UnknownClip, motionseek.ArgumentError, motionseek.BundleError):
        assert issubclass(error, motionseek.MotionSeekError)
