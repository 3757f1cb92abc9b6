"""Which way is up in a file."""

from __future__ import annotations

from contextlib import closing
from pathlib import Path

import numpy as np
import pytest

import motionseek
from encoders.errors import ArgumentError
from encoders.skeleton import INDEX
from indexer.ingest.indexing import index
from indexer.ingest.load import load_motion
from indexer.store import schema
from indexer.store.captions import Stated, stated_option
from indexer.store.library_reader import FILE, FOLDER
from indexer.store.stored_library import StoredLibrary
from indexer.store.tables import digests
from indexer.take import UP_AXES
from search.library import Library
from search.references import source_of
from tests.indexer.folders import without_marks
from tests.indexer.performances import bvh, performance

#: Height of the head over the pelvis, in metres, by the files' own joints.
CASES = {
    "arrays-stood-upright/crawl.npy": 0.12,
    "arrays-stood-upright/crawl.npz": 0.12,
    "arrays-stood-upright/lie_on_back.npy": 0.0,
    "arrays-stood-upright/lie_on_back_263.npy": 0.0,
    "arrays-stood-upright/pushups.npy": 0.13,
    "arrays-stood-upright/handstand.npy": -0.65,
    "bvh-up-without-rest-or-floor/crawl_control.bvh": 0.14,
    "bvh-up-without-rest-or-floor/crawl_floor_at_1m.bvh": 0.14,
    "bvh-up-without-rest-or-floor/crawl_in_place.bvh": 0.14,
    "bvh-up-without-rest-or-floor/handstand_in_place.bvh": -0.62,
    "bvh-up-without-rest-or-floor/crawl_rest_along_x.bvh": 0.14,
    "bvh-up-without-rest-or-floor/lie_rest_along_x.bvh": 0.03,
    "own-export-upside-down/crawl.bvh": 0.14,
    "own-export-upside-down/handstand.bvh": -0.62,
}


@pytest.mark.parametrize("case", CASES)
def test_who_does_not_stand_is_not_stood_upright(shared: Path, case: str) -> None:
    joints = load_motion(shared / "cases" / "files" / case).joints
    height = joints[:, INDEX["head"], 1] - joints[:, INDEX["pelvis"], 1]
    assert float(np.mean(height)) == pytest.approx(CASES[case], abs=0.04)


def test_a_given_axis_is_up_whatever_the_movement_looks_like(tmp_path: Path) -> None:
    path = tmp_path / "take.bvh"
    path.write_text(bvh(performance()), encoding="utf-8")
    found = {axis: load_motion(path, up=axis).joints for axis in UP_AXES}
    height = {axis: float((joints[:, INDEX["head"]] - joints[:, 0])[:, 1].mean()) for axis, joints in found.items()}
    assert height["y"] > 0.5
    assert height["-y"] < -0.5
    assert abs(height["z"]) < 0.3
    with pytest.raises(ArgumentError, match="up='upwards' must be one of x, y, z"):
        load_motion(path, up="upwards")


def test_a_given_axis_is_remembered(tmp_path: Path) -> None:
    (tmp_path / "take.bvh").write_text(bvh(performance()), encoding="utf-8")
    index(tmp_path, jobs=1, up="z")
    index(tmp_path, jobs=1)
    with StoredLibrary.open(tmp_path) as library:
        (clip,) = library.clips()
        assert (clip.up, clip.up_reason) == ("z", "given")


def test_the_axis_of_a_captions_table_takes_precedence_and_is_remembered(tmp_path: Path) -> None:
    for name in ("a.bvh", "b.bvh"):
        (tmp_path / name).write_text(bvh(performance()), encoding="utf-8")
    table = tmp_path / "captions.csv"
    table.write_text("path,up\na.bvh,-z\n")
    index(tmp_path, jobs=1, up="z")
    assert index(tmp_path, jobs=1).unchanged == 2
    assert _ups(tmp_path) == {"a.bvh": ("-z", "given"), "b.bvh": ("z", "given")}
    table.write_text("path,up\na.bvh,\n")
    index(tmp_path, jobs=1)
    assert _ups(tmp_path) == {"a.bvh": ("y", "the rest pose stands"), "b.bvh": ("z", "given")}


def test_the_axis_of_a_part_of_a_file_is_not_ignored_without_a_word(tmp_path: Path) -> None:
    (tmp_path / "a.bvh").write_text(bvh(performance()), encoding="utf-8")
    (tmp_path / "captions.csv").write_text("path,up,fps\na.bvh#2,z,\na.bvh#3,,30\n")
    (warning,) = index(tmp_path, jobs=1).warnings
    assert "fps and up are of a file, not of 'a.bvh#2' (and of 1 more parts); name 'a.bvh' for them" in warning


def test_a_library_of_before_is_read_and_its_captions_stay_whole(tmp_path: Path) -> None:
    (tmp_path / "a.bvh").write_text(bvh(performance()), encoding="utf-8")
    (tmp_path / "captions.csv").write_text("path,text,fps\na.bvh,walks,30\n")
    index(tmp_path, jobs=1)
    file = tmp_path / FOLDER / FILE
    with closing(schema.connect(file, writable=True)) as db:
        row = 'id, side_file_id, root_id, path, clip_id, text_id, start, "end", fps, split'
        db.execute(f"UPDATE captions SET digest = digest({row})")
        db.execute("ALTER TABLE captions DROP COLUMN up")
        without_marks(db)
        db.execute("PRAGMA user_version = 5")
    with closing(schema.connect(file, writable=False)) as db:
        assert stated_option(db, 1, "a.bvh") == Stated(30.0, None)
    with closing(schema.connect(file, writable=True)) as db:
        schema.migrate(db)
        assert digests.damaged_rows(db, "captions") == []
        assert db.execute("SELECT count(*) FROM captions WHERE digest IS NULL").fetchone() == (0,)


@pytest.mark.parametrize("given", ["path", "array", "library"])
def test_a_question_takes_an_axis(tmp_path: Path, given: str) -> None:
    path = tmp_path / "take.bvh"
    path.write_text(bvh(performance()), encoding="utf-8")
    if given == "library":
        index(tmp_path, jobs=1)
        with Library.open(tmp_path) as library:
            library.export("take.bvh", tmp_path / "out.npz", up="z")
            assert library.describe("take.bvh", 1, up="z") == motionseek.describe(path, 1, up="z")
            with pytest.raises(ArgumentError, match="a Motion is Y up"):
                library.describe(load_motion(path), up="z")
        joints = np.load(tmp_path / "out.npz")["joints"]
    else:
        ref = path if given == "path" else load_motion(path).joints
        joints = source_of(ref, up="z").motion.joints
    assert abs(float((joints[:, INDEX["head"]] - joints[:, 0])[:, 1].mean())) < 0.3


def _ups(folder: Path) -> dict[str, tuple[str, str]]:
    with StoredLibrary.open(folder) as library:
        return {clip.path: (clip.up, clip.up_reason) for clip in library.clips()}
