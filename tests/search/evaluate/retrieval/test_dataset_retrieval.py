"""A model whose answers are known by hand, on a data set in the published layout; and the report in every form."""

from __future__ import annotations

import csv
import io
import re
from pathlib import Path

import numpy as np
import pytest

from encoders.errors import BundleError, MissingMotion
from encoders.features.registry import FEATURE_KINDS
from indexer.datasets.captioned_dataset import CaptionedDataset
from search.evaluate.retrieval import retrieval_tables
from search.evaluate.retrieval.dataset_retrieval import (
    EvaluatedModel,
    RetrievalReport,
    SentenceSimilarity,
    evaluate_dataset,
)
from tests.indexer.datasets.toy_dataset import write_dataset

KEYS = [f"{i:06d}" for i in range(4)]
CAPTIONS = ("walks", "walks", "jumps", "sits")
#: The first number of a caption's motion, and the axis of its sentence.
AXES = {"walks": 0, "jumps": 1, "sits": 2}


@pytest.fixture
def dataset(tmp_path: Path) -> CaptionedDataset:
    captions = {key: [(text, 0.0, 3.0)] for key, text in zip(KEYS, CAPTIONS, strict=True)}
    write_dataset(tmp_path, captions, {"test": KEYS[::-1], "nsim_test": [KEYS[0], KEYS[2], "000099"]})
    for key, text in zip(KEYS, CAPTIONS, strict=True):
        features = np.zeros((60, 263), np.float32)
        features[:, AXES[text]] = 1 + int(key)
        np.save(tmp_path / "motions" / "guoh3dfeats" / "SYN" / f"{key}.npy", features)
    return CaptionedDataset.open(tmp_path, FEATURE_KINDS["humanml3d"])


def model(bias: float = 0.0) -> EvaluatedModel:
    def captions(texts: list[str]) -> np.ndarray:
        return np.eye(3, dtype=np.float32)[[AXES[text] for text in texts]]

    return EvaluatedModel("a_model", lambda clips: np.stack([clip[0, :3] + bias for clip in clips]), captions)


def sentences() -> SentenceSimilarity:
    return SentenceSimilarity("orthogonal", lambda texts: np.eye(3, dtype=np.float32)[[AXES[text] for text in texts]])


def evaluated(dataset: CaptionedDataset) -> RetrievalReport:
    return evaluate_dataset(dataset, "test", model(), sentences())


def test_every_protocol_that_the_data_allow(dataset: CaptionedDataset) -> None:
    report = evaluated(dataset)
    assert (report.dataset, report.split, report.sentence_model) == ("toy", "test", "orthogonal")
    assert report.subset == "published list nsim_test"
    rows = {(row.protocol, row.footing): row for row in report.rows}
    assert [(*place, row.gallery) for place, row in rows.items()] == [
        ("all", "strict", 4),
        ("all", "credit for duplicates", 4),
        ("all with threshold 0.95", "similar captions", 4),
        ("dissimilar subset", "strict", 2),
        ("dissimilar subset", "credit for duplicates", 2),
    ]
    # The two who walk: the second is the more similar to both captions.
    assert rows["all", "strict"].figures["text->motion"]["R@1"] == 75.0
    assert rows["all", "credit for duplicates"].figures["text->motion"]["R@1"] == 100.0
    assert rows["all with threshold 0.95", "similar captions"].figures["text->motion"]["R@1"] == 100.0
    assert rows["dissimilar subset", "strict"].figures["motion->text"]["R@1"] == 100.0


def test_without_a_list_the_subset_is_selected_and_without_sentences_there_is_none(dataset: CaptionedDataset) -> None:
    (dataset.folder / "splits" / "nsim_test.txt").unlink()
    report = evaluated(dataset)
    assert report.subset == "selected by orthogonal"
    assert [row.gallery for row in report.rows if row.protocol == "dissimilar subset"] == [3, 3], "one of each caption"
    bare = evaluate_dataset(dataset, "test", model(), None)
    assert {row.protocol for row in bare.rows} == {"all"}
    assert bare.as_dict()["sentence_similarity"] is None


def test_a_motion_that_is_not_there_and_a_model_that_fails_are_errors(dataset: CaptionedDataset) -> None:
    with pytest.raises(BundleError, match="a_model: gives vectors that are not finite on toy"):
        evaluate_dataset(dataset, "test", model(np.nan), None)
    (dataset.motions.folder / "SYN" / "000002.npy").unlink()
    with pytest.raises(MissingMotion, match="000002"):
        evaluated(dataset)


def test_a_report_as_csv_and_latex(dataset: CaptionedDataset) -> None:
    report = evaluated(dataset)
    rows = list(csv.DictReader(io.StringIO(retrieval_tables.as_csv(report))))
    assert len(rows) == 10
    assert rows[0] == {
        "model": "a_model",
        "dataset": "toy",
        "split": "test",
        "sentence_similarity": "orthogonal",
        "dissimilar_subset": "published list nsim_test",
        "protocol": "all",
        "footing": "strict",
        "gallery": "4",
        "direction": "text->motion",
        "R@1": "75.00",
        **{f"R@{k}": "100.00" for k in (2, 3, 5, 10)},
        "MedR": "1.00",
    }
    latex = retrieval_tables.as_latex(report)
    assert "% sentence similarity: orthogonal" in latex
    wanted = r"% all, strict, gallery 4\na\\_model & 75.00 (& 100.00 ){4}& 1.00 (& \d+.\d\d ){6}\\\\\n"
    assert re.search(wanted, latex)
