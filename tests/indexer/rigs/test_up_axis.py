"""Which way is up in a file."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from encoders.skeleton import INDEX
from indexer.ingest.load import load_motion

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
