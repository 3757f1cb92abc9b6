"""HumanML3D's and KIT-ML's own folders as data sets."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from encoders.errors import DatasetError, MissingSplit, MotionSeekWarning
from encoders.features.registry import FEATURE_KINDS
from indexer.datasets.captioned_dataset import CaptionedDataset, is_dataset
from tests.search.conftest import made_motion

KIND = FEATURE_KINDS["humanml3d"]


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    for name in ("texts", "new_joint_vecs", "new_joints"):
        (tmp_path / name).mkdir()
    rng = np.random.default_rng(0)
    for key, frames in (("000001", 199), ("M000001", 199), ("000002", 60)):
        np.save(tmp_path / "new_joint_vecs" / f"{key}.npy", rng.normal(size=(frames, 263)).astype(np.float32))
        np.save(tmp_path / "new_joints" / f"{key}.npy", made_motion(frames / 20, 1).joints)
    captions = "a man walks#a/DET man/NOUN walk/VERB#0.0#0.0\nhe waves#he/PRON wave/VERB#1.0#3.5\n"
    (tmp_path / "texts" / "000001.txt").write_text(captions)
    (tmp_path / "texts" / "M000001.txt").write_text("a man walks#a/DET man/NOUN walk/VERB#nan#nan\n")
    (tmp_path / "texts" / "000002.txt").write_text("")
    (tmp_path / "test.txt").write_text("000001\nM000001\n000002\n000009\n")
    return tmp_path


def test_each_listed_motion_has_its_captions_and_what_is_not_there_is_passed_over(folder: Path) -> None:
    dataset = CaptionedDataset.open(folder, KIND)
    entries = dataset.split("test")
    assert [entry.key for entry in entries] == ["000001", "M000001"]
    assert [(c.text, c.start, round(c.end, 6)) for c in entries[0].captions] == [
        ("a man walks", 0.0, 9.95),
        ("he waves", 1.0, 3.5),
    ]
    assert [len(dataset.motions.clip(entries[0], caption)) for caption in entries[0].captions] == [199, 50]


def test_no_frame_of_a_whole_motion_is_lost(folder: Path) -> None:
    dataset = CaptionedDataset.open(folder, KIND)
    for frames in range(1, 400, 3):
        np.save(folder / "new_joint_vecs" / "M000001.npy", np.zeros((frames, 263), np.float32))
        (whole,) = dataset.split("test")[1].captions
        assert int(whole.end * KIND.fps) == frames


def test_a_model_that_reads_other_features_takes_the_joints(folder: Path) -> None:
    assert CaptionedDataset.open(folder, KIND).motions.folder.name == "new_joint_vecs"
    dataset = CaptionedDataset.open(folder, FEATURE_KINDS["body"])
    assert dataset.motions.folder.name == "new_joints"
    assert dataset.split("test")[0].duration == pytest.approx(9.95, abs=0.06)


def test_what_is_wrong_with_it_has_a_name(folder: Path) -> None:
    assert is_dataset(folder)
    dataset = CaptionedDataset.open(folder, KIND)
    with pytest.raises(MissingSplit, match=r"has no split 'tset' \(tset.txt\); there: test"):
        dataset.split("tset")
    (folder / "test.txt").write_text("../000001\n")
    with pytest.raises(DatasetError, match=r"'../000001' is no id"):
        dataset.split("test")
    (folder / "test.txt").write_text("000001\n")
    (folder / "texts" / "000001.txt").write_text("a man walks#x#5.0#2.0\n")
    with (
        pytest.warns(MotionSeekWarning, match=r"000001.txt, line 1: .*the end after the start.* the line is left out"),
        pytest.raises(MissingSplit, match="has a caption that counts"),
    ):
        dataset.split("test")
