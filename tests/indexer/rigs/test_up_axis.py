"""Which way is up in a file."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from encoders.errors import ArgumentError
from encoders.skeleton import INDEX
from indexer.ingest.indexing import index
from indexer.ingest.load import load_motion
from indexer.store.stored_library import StoredLibrary
from indexer.take import UP_AXES
from tests.indexer.performances import bvh, performance

#: Height of the head over the pelvis, in metres.
CASES = {
    "arrays-stood-upright/crawl.npy": 0.12,
    "arrays-stood-upright/crawl.npz": 0.12,
    "arrays-stood-upright/lie_on_back.npy": 0.0,
    "arrays-stood-upright/lie_on_back_263.npy": 0.0,
    "arrays-stood-upright/pushups.npy": 0.13,
    "arrays-stood-upright/handstand.npy": -0.65,
    "bvh-up-without-rest-or-floor/crawl_control.bvh": 0.05,
    "bvh-up-without-rest-or-floor/crawl_floor_at_1m.bvh": 0.05,
    "bvh-up-without-rest-or-floor/crawl_in_place.bvh": 0.05,
    "bvh-up-without-rest-or-floor/handstand_in_place.bvh": -0.62,
    "bvh-up-without-rest-or-floor/crawl_rest_along_x.bvh": 0.05,
    "bvh-up-without-rest-or-floor/lie_rest_along_x.bvh": 0.09,
    "own-export-upside-down/crawl.bvh": 0.05,
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
