"""What is written is read back as it was, whatever it is: motions in every format, captions, clips from memory."""

from __future__ import annotations

import csv
import json
import tempfile
from collections.abc import Iterator
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from hypothesis import Phase, given, settings
from hypothesis import strategies as st

from encoders.corpus.actions.programs import programs
from encoders.corpus.composition.scene_clips import make_clip
from encoders.corpus.scene import ActionStep, Scene
from encoders.motion import FPS, Motion
from indexer.ingest.arrays import NewClip, add, remove
from indexer.ingest.caption_files import read_lines, read_table
from indexer.ingest.load import load_motion
from indexer.rigs.rebuild import rebuild
from indexer.store.clips import Caption
from indexer.store.poses import STEP
from indexer.store.stored_library import StoredLibrary
from search.export.cut import WRITERS, write_cut
from search.source import MotionSource
from tests.indexer.folders import SmallBundle

#: Text that a caption may hold: all but surrogates, which are no Unicode.
TEXT = st.text(st.characters(exclude_categories=["Cs"]), min_size=1, max_size=60).filter(lambda text: text.split())
SECONDS = st.floats(0, 1e6, allow_nan=False)


@cache
def acted(action: str, seed: int) -> Motion:
    """A synthetic motion of a body whose bones keep their lengths."""
    clip = make_clip(Scene(((ActionStep(action),),)), np.random.default_rng(seed))
    return rigid(clip.joints)


def rigid(joints: np.ndarray) -> Motion:
    """Joints (T, 22, 3) at 20 frames a second with the bones of the target skeleton."""
    return Motion(rebuild(joints.astype(np.float64), 1.0).astype(np.float32))


@st.composite
def motions(draw: st.DrawFn) -> Motion:
    """Any action of the corpus, cut anywhere, turned any way about the vertical and put anywhere on the floor."""
    whole = acted(draw(st.sampled_from(sorted(programs()))), draw(st.integers(0, 3)))
    first = draw(st.integers(0, len(whole) - 20))
    last = draw(st.integers(first + 20, len(whole)))
    angle, place = draw(st.floats(-np.pi, np.pi)), draw(st.tuples(st.floats(-9, 9), st.floats(-9, 9)))
    turn = np.array([[np.cos(angle), 0, np.sin(angle)], [0, 1, 0], [-np.sin(angle), 0, np.cos(angle)]])
    joints = whole.joints[first:last] @ turn.T + [place[0], 0, place[1]]
    return Motion(joints.astype(np.float32), whole.fps)


@settings(max_examples=8, deadline=None, derandomize=True, phases=[Phase.generate])
@given(motion=motions(), fps=st.sampled_from([None, 10.0, 24.0, 60.0, 120.0]))
def test_a_motion_that_is_written_is_read(motion: Motion, fps: float | None) -> None:
    for ending in WRITERS:
        with tempfile.TemporaryDirectory() as folder:
            file = Path(folder, f"x{ending}")
            wanted = None if ending == ".npy" else fps
            frames, rate = write_cut(MotionSource.of_motion(motion), file, fps=wanted)
            found = load_motion(file, up="y")
        written = motion if wanted is None else motion.resample(wanted)
        assert (frames, rate) == (len(written), written.fps)
        expected = rigid(written.resample(FPS).joints)  # between the frames of another rate bones would be shorter
        assert abs(len(found) - len(expected)) <= 1
        both = found.crop(0, expected.duration), expected.crop(0, found.duration)
        # A rate whose frames lie between those of 20 a second is interpolated twice, which a fast limb shows.
        np.testing.assert_allclose(*map(from_pelvis, both), atol=0.005 if rate % FPS == 0 else 0.1)
        np.testing.assert_allclose(*map(way, both), atol=0.01)


def way(motion: Motion) -> np.ndarray:
    """How the pelvis travels over the floor (T, 2)."""
    travelled: np.ndarray = motion.joints[:, 0, [0, 2]] - motion.joints[0, 0, [0, 2]]
    return travelled


def from_pelvis(motion: Motion) -> np.ndarray:
    joints: np.ndarray = motion.joints - motion.joints[:, :1]
    return joints


@st.composite
def captions(draw: st.DrawFn) -> Caption:
    """A caption of a whole motion or of a span."""
    start = draw(st.none() | SECONDS)
    length = draw(st.floats(0.01, 1e3))
    text = " ".join(draw(TEXT).split())
    return Caption(text) if start is None else Caption(text, start, start + length)


@settings(max_examples=60, deadline=None, derandomize=True)
@given(rows=st.lists(captions(), min_size=1, max_size=5), kind=st.sampled_from(["csv", "tsv", "jsonl"]))
def test_a_table_of_captions_that_is_written_is_read(rows: list[Caption], kind: str) -> None:
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder, f"captions.{kind}")
        write_table(file, rows)
        found = read_table(file, "", pytest.fail)
    assert [(row.text, row.start, row.end) for row in found] == [(row.text, row.start, row.end) for row in rows]
    assert {row.path for row in found} == {"a walk.bvh"}


def write_table(file: Path, rows: list[Caption]) -> None:
    records = [{"path": "a walk.bvh", "text": row.text, "start": row.start, "end": row.end} for row in rows]
    with file.open("w", encoding="utf-8", newline="") as out:
        if file.suffix == ".jsonl":
            out.writelines(json.dumps(record, ensure_ascii=False) + "\n" for record in records)
            return
        table = csv.DictWriter(out, list(records[0]), delimiter="\t" if file.suffix == ".tsv" else ",")
        table.writeheader()
        table.writerows(records)


@settings(max_examples=60, deadline=None, derandomize=True)
@given(texts=st.lists(TEXT, min_size=1, max_size=5), timed=st.booleans())
def test_lines_of_captions_that_are_written_are_read(texts: list[str], timed: bool) -> None:
    lines = [" ".join(text.split()) for text in texts]
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder, "walk.txt")
        file.write_text("".join(f"{line}#words#1.5#2.25\n" if timed else f"{line}\n" for line in lines), "utf-8")
        found = read_lines(file, pytest.fail)
    assert found == [(line, 1.5, 2.25) if timed else (line, None, None) for line in lines]


@pytest.fixture(scope="module")
def library(tmp_path_factory: pytest.TempPathFactory) -> Iterator[StoredLibrary]:
    folder = tmp_path_factory.mktemp("library")
    with StoredLibrary.open(folder, bundle=SmallBundle(), create=True) as opened:
        yield opened


WORDS = st.text(st.characters(categories=["L", "N", "S"]), min_size=1, max_size=12)
IDS = st.lists(WORDS, min_size=1, max_size=3).flatmap(lambda words: st.sampled_from(["/".join(words), " ".join(words)]))


@settings(max_examples=8, deadline=None, derandomize=True, phases=[Phase.generate])
@given(motion=motions(), ids=st.lists(IDS, min_size=1, max_size=3, unique=True), said=st.data())
def test_clips_that_are_added_are_read(
    library: StoredLibrary, motion: Motion, ids: list[str], said: st.DataObject
) -> None:
    given_captions = {
        id: said.draw(st.lists(captions(), max_size=3, unique_by=lambda c: (c.text, c.start))) for id in ids
    }
    numbers = add(library.folder, [NewClip(id, motion, given_captions[id]) for id in ids], library.bundle)
    assert len(library) == len(ids)
    for id, number in zip(ids, numbers, strict=True):
        clip = library.clip(number)
        assert (clip.path, clip.frames, clip.fps) == (id, len(motion), FPS)
        np.testing.assert_allclose(library.motion(number).joints, motion.joints, atol=STEP)
        assert sorted(library.captions(number), key=repr) == sorted(given_captions[id], key=repr)
    remove(library.folder, ids)
    assert len(library) == 0
