"""The protocol of labelled archives, on a model whose answers are known."""

from __future__ import annotations

import pytest

from encoders.errors import QueryError
from indexer.datasets.labelled_clips import LabelledClips
from search.evaluate.labelled_archive import LabelReport, evaluate_labels
from tests.search.answers import KnownAnswers, motion


def report(**queries: list[str]) -> LabelReport:
    """Two clips of kind 0 and two of kind 1, of which one is labelled "double"."""
    motions = [motion(kind) for kind in (0, 0, 1, 1)]
    archive = LabelledClips(motions, ["nought", "nought", "single", "double"], queries, [("broken.bvh", "broken")])
    return evaluate_labels(archive, KnownAnswers())


def test_average_precision_of_each_label() -> None:
    """A clip labelled "double" looks just like the one labelled "single": the tie is broken against the model."""
    found = report(nought=["zero"], single=["one"], other=["two"])
    assert found.precisions == {"nought": [1.0], "single": [0.5]}
    assert found.clips == {"nought": 2, "single": 1}
    assert found.mean == 0.75
    assert found.top1 == 1.0


def test_confusion_is_of_the_label_whose_query_is_nearest() -> None:
    found = report(nought=["zero"], single=["zero"], double=["one"])
    assert found.confusion["single"] == {"nought": 0.0, "single": 0.0, "double": 1.0}
    assert found.top1 == 0.75


def test_the_document_holds_it_all() -> None:
    document = report(nought=["zero"], single=["one"]).as_dict()
    assert document["mean_average_precision"] == 0.75
    assert document["labels"]["single"] == {"clips": 1, "average_precision": 0.5, "queries": [0.5]}
    assert document["unreadable"] == [{"path": "broken.bvh", "reason": "broken"}]


def test_queries_of_no_label_are_an_error() -> None:
    with pytest.raises(QueryError, match="no readable clip"):
        report(other=["two"])
