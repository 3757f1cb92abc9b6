"""Data sets in TMR's layout: found, filtered as published, and the published loader's items."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from encoders.errors import DatasetError, MissingMotion, MissingSplit
from encoders.features.registry import FEATURE_KINDS
from indexer.datasets.captioned_dataset import CaptionedDataset, is_dataset
from indexer.datasets.text_embeddings import StoredSentences, StoredTokens
from tests.indexer.datasets.toy_dataset import write_dataset

KIND = FEATURE_KINDS["humanml3d"]
CAPTIONS = {
    "000001": [("a man walks", 0.0, 3.0), ("he walks on", 0.0, 1.9)],
    "M000001": [("a man walks", 0.0, 3.0)],
    "000002": [("a long dance", 0.0, 12.0)],
}
KEYS = [*CAPTIONS, "000009"]


@pytest.fixture
def datasets(tmp_path: Path) -> Path:
    return write_dataset(tmp_path, CAPTIONS, {"train": KEYS, "test": KEYS, "val": ["000002"]})


def test_train_keeps_captions_about_2_to_10_seconds_and_test_keeps_all(datasets: Path) -> None:
    dataset = CaptionedDataset.open(datasets, KIND)
    assert dataset.name == "toy"
    train, test = dataset.split("train"), dataset.split("test")
    assert [entry.key for entry in test] == list(CAPTIONS), "keys without annotations are left out"
    assert [(e.key, [c.text for c in e.captions]) for e in train] == [
        ("000001", ["a man walks"]),
        ("M000001", ["a man walks"]),
    ]
    with pytest.raises(MissingSplit, match="no motion of the split 'val' has a caption that counts"):
        dataset.split("val")
    assert len(dataset.split("val", all_durations=True)) == 1


def test_the_folder_above_the_annotations_and_both_folders_alone_are_found(datasets: Path, tmp_path: Path) -> None:
    inside = datasets / "annotations" / "toy"
    assert CaptionedDataset.open(inside, KIND).motions.folder == datasets / "motions" / "guoh3dfeats"
    (datasets / "motions").rename(tmp_path / "elsewhere")
    with pytest.raises(MissingMotion, match=r"no folder of motions .*--motions"):
        CaptionedDataset.open(inside, KIND)
    moved = CaptionedDataset.open(inside, KIND, motions=tmp_path / "elsewhere" / "guoh3dfeats")
    assert len(moved.motions.clip(*(lambda e: (e, e.captions[0]))(moved.split("test")[0]))) == 60


def test_of_several_data_sets_one_must_be_named(datasets: Path) -> None:
    write_dataset(datasets, {}, {}, name="other")
    with pytest.raises(DatasetError, match=r"several data sets; name one: .*other, .*toy"):
        CaptionedDataset.open(datasets, KIND)


def test_a_folder_without_annotations_is_no_data_set(tmp_path: Path) -> None:
    assert not is_dataset(tmp_path)
    with pytest.raises(DatasetError, match="holds no data set"):
        CaptionedDataset.open(tmp_path, KIND)


def test_babels_own_files_are_splits(tmp_path: Path) -> None:
    label = {"raw_label": "turn", "start_t": 0.0, "end_t": 2.5}
    value = {"dur": 4.0, "feat_p": "KIT/KIT/1_poses.npz", "seq_ann": None, "frame_ann": {"labels": [label]}}
    (tmp_path / "val.json").write_text(json.dumps({"1": value}), "utf-8")
    (tmp_path / "motions").mkdir()
    dataset = CaptionedDataset.open(tmp_path, KIND)
    assert [entry.path for entry in dataset.split("val")] == ["KIT/1_poses"]
    with pytest.raises(MissingSplit, match="'train'"):
        dataset.split("train")


def test_the_published_loaders_items(golden: Path) -> None:
    torch = pytest.importorskip("torch")
    dataset = CaptionedDataset.open(golden / "published_dataset", KIND)
    tokens, sentences = StoredTokens.open(dataset.folder), StoredSentences.open(dataset.folder)
    assert tokens is not None
    assert sentences is not None
    assert dataset.stats is not None
    mean, std = (torch.load(dataset.stats / f"{name}.pt").numpy() for name in ("mean", "std"))
    wanted = json.loads((golden / "published_dataset_items.json").read_text())
    for split, items in wanted.items():
        entries = dataset.split(split)
        dataset.motions.check_rate(entries)
        assert [entry.key for entry in entries] == [item["keyid"] for item in items]
        assert [[c.text for c in entry.captions] for entry in entries] == [item["texts"] for item in items]
        for entry, item in zip(entries, items, strict=True):
            if "motion_sum" not in item:
                continue
            clip = (dataset.motions.clip(entry, entry.captions[0]) - mean) / (std + 1e-12)
            rows = tokens.rows([item["text"]])[0]
            assert (len(clip), len(rows)) == (item["motion_length"], item["token_length"])
            np.testing.assert_allclose(clip[0, :4], item["motion_first_frame_first4"], rtol=1e-6)
            sums = [clip.sum(dtype=float), rows.sum(dtype=float), sentences.rows([item["text"]]).sum(dtype=float)]
            wanted_sums = [item["motion_sum"], item["token_sum"], item["sent_sum"]]
            np.testing.assert_allclose(sums, wanted_sums, rtol=1e-6, atol=1e-4)
