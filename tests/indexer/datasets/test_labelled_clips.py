"""Labelled folders: clips, labels and queries from their tables."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from encoders.errors import QueryError
from indexer.datasets.labelled_clips import labelled_clips
from tests.search.conftest import made_motion


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    for name in "ab":
        np.save(tmp_path / f"{name}.npy", made_motion(2.0, 0).joints)
    (tmp_path / "broken.bvh").write_text("HIERARCHY", encoding="utf-8")
    (tmp_path / "labels.tsv").write_text("path\tlabel\na.npy\twalk\nbroken.bvh\twalk\nb.npy\trun\n", encoding="utf-8")
    (tmp_path / "queries.tsv").write_text("label\tquery\nwalk\twalks\nwalk\tstrolls\nsit\tsits\n", encoding="utf-8")
    return tmp_path


def test_clips_come_with_their_labels_and_every_label_with_its_queries(folder: Path) -> None:
    found = labelled_clips(folder)
    assert found.labels == ["walk", "run"]
    assert [motion.duration for motion in found.motions] == [2.0, 2.0]
    assert found.queries == {"walk": ["walks", "strolls"], "sit": ["sits"]}


def test_a_file_that_cannot_be_read_is_named_and_left_out(folder: Path) -> None:
    [(path, reason)] = labelled_clips(folder).unreadable
    assert path == "broken.bvh"
    assert "broken" in reason


def test_tables_may_lie_elsewhere(folder: Path, tmp_path_factory: pytest.TempPathFactory) -> None:
    queries = tmp_path_factory.mktemp("elsewhere") / "mine.csv"
    queries.write_text("label,query\nrun,runs\n", encoding="utf-8")
    assert labelled_clips(folder, queries=queries).queries == {"run": ["runs"]}
    with pytest.raises(QueryError, match=r"missing\.tsv"):
        labelled_clips(folder, Path("missing.tsv"))
