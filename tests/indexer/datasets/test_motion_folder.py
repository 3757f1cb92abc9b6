"""Motions of a data set: features as they are, joints through a feature kind; every fault has a name of its own."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from encoders.errors import DatasetError, MissingMotion, NotFinite, WrongFeatureSize, WrongFrameRate
from encoders.features.registry import FEATURE_KINDS
from indexer.datasets.motion_folder import MotionFolder
from indexer.datasets.timed_captions import CaptionedEntry, TimedCaption
from indexer.ingest.load import load_motion
from tests.search.conftest import made_motion

KIND = FEATURE_KINDS["humanml3d"]


def entry(path: str = "walk", start: float = 0.0, end: float = 3.0, duration: float = 3.0) -> CaptionedEntry:
    return CaptionedEntry(path, path, duration, (TimedCaption("walks", start, end),))


def clip(folder: Path, wanted: CaptionedEntry, *, fps: float | None = None) -> np.ndarray:
    return MotionFolder(folder, KIND, fps).clip(wanted, wanted.captions[0])


def test_a_clip_is_a_slice_of_the_features_with_both_ends_rounded_down(tmp_path: Path) -> None:
    features = np.random.default_rng(0).normal(size=(60, 263)).astype(np.float16)
    np.save(tmp_path / "walk.npy", features)
    np.testing.assert_array_equal(clip(tmp_path, entry(start=0.07, end=2.99)), features[1:59].astype(np.float32))
    assert clip(tmp_path, entry(start=0.5, end=9.0)).shape == (50, 263), "as published, no error where it ends early"
    assert clip(tmp_path, entry(start=1.0, end=1.0)).shape == (1, 263)


def test_of_joints_features_are_those_of_the_whole_motion(tmp_path: Path) -> None:
    np.save(tmp_path / "walk.npy", made_motion(5.0, 1).joints)
    whole = KIND.compute(load_motion(tmp_path / "walk.npy", fps=20))
    np.testing.assert_allclose(clip(tmp_path, entry(start=1.0, end=3.0), fps=20), whole[20:60], atol=1e-5)


def test_a_mirrored_motion_that_is_not_there_is_mirrored(tmp_path: Path) -> None:
    np.save(tmp_path / "walk.npy", made_motion(3.0, 1).joints)
    motion = load_motion(tmp_path / "walk.npy", fps=20)
    mirrored = KIND.compute(motion.mirror())
    np.testing.assert_allclose(clip(tmp_path, entry("M/walk"), fps=20), mirrored, atol=1e-5)
    np.save(tmp_path / "walk.npy", KIND.compute(motion))
    with pytest.raises(MissingMotion, match="cannot be mirrored"):
        clip(tmp_path, entry("M/walk"))


def test_the_axis_that_is_up_in_most_arrays_of_joints_is_up_in_all(golden: Path, tmp_path: Path) -> None:
    with np.load(golden / "humanml3d_features.npz") as arrays:
        for name in ("crawl_all_fours", "walk_forward", "sit_down"):
            np.save(tmp_path / f"{name}.npy", arrays[f"{name}/joints"])
        wanted = arrays["crawl_all_fours/features"]
    found = clip(tmp_path, entry("crawl_all_fours", end=60.0), fps=20)
    np.testing.assert_allclose(found, wanted, atol=1e-4)


def spoiled(features: np.ndarray) -> np.ndarray:
    features[7, 3] = np.nan
    return features


@pytest.mark.parametrize(
    ("array", "error", "reason"),
    [
        (None, MissingMotion, "is not there"),
        (np.zeros((60, 135)), WrongFeatureSize, "has 135 numbers a frame; 'humanml3d' features have 263"),
        (spoiled(np.zeros((60, 263))), NotFinite, "frame 7 holds values that are no numbers"),
        (spoiled(np.zeros((60, 135))), NotFinite, "no numbers"),
        (np.zeros((5, 263)), DatasetError, r"ends after 0.25 s, but walk starts at 1.00 s"),
        (np.array(["a"]), DatasetError, "is no motion"),
        (np.zeros((60, 5, 5)), DatasetError, "is no motion"),
    ],
)
def test_each_fault_has_its_name(tmp_path: Path, array: np.ndarray | None, error: type, reason: str) -> None:
    if array is not None:
        np.save(tmp_path / "walk.npy", array)
    with pytest.raises(error, match=reason) as raised:
        clip(tmp_path, entry(start=0.0 if array is None or len(array) > 5 else 1.0))
    assert type(raised.value) is error


def test_a_damaged_array_is_named(tmp_path: Path) -> None:
    (tmp_path / "walk.npy").write_bytes(b"\x93NUMPY\x01\x00")
    with pytest.raises(DatasetError, match=r"walk\.npy: no array that can be read"):
        clip(tmp_path, entry())


@pytest.mark.parametrize("rate", [12.5, 30.0, 120.0])
def test_another_frame_rate_shows_in_the_number_of_frames(tmp_path: Path, rate: float) -> None:
    seconds = {"a": 2.0, "b": 4.0, "c": 8.0}
    for name, duration in seconds.items():
        np.save(tmp_path / f"{name}.npy", np.zeros((round(duration * rate), 263), np.float32))
    entries = [entry(name, duration=duration) for name, duration in seconds.items()]
    with pytest.raises(WrongFrameRate, match=rf"{rate:.1f} frames for each second .* have 20"):
        MotionFolder(tmp_path, KIND).check_rate(entries)
    for name, duration in seconds.items():
        np.save(tmp_path / f"{name}.npy", np.zeros((round(duration * 20) - 1, 263), np.float32))
    MotionFolder(tmp_path, KIND).check_rate(entries)
