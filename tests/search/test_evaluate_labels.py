"""The protocol of labelled archives, on a model whose answers are known."""

from __future__ import annotations

from pathlib import Path

import pytest

from encoders.errors import QueryError, UnreadableMotion
from encoders.motion import Motion
from search.evaluate.labelled_archive import evaluate_labels, read_table
from tests.search.answers import KnownAnswers, motion


def load(path: Path) -> Motion:
    """What a file shows is the number in its name."""
    if path.stem == "broken":
        raise UnreadableMotion(path, "broken")
    return motion(int(path.stem[-1]))


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    files = {"a0": "nought", "b0": "nought", "c1": "single", "d1": "double", "broken": "nought"}
    lines = [f"{name}.bvh\t{label}" for name, label in files.items()]
    (tmp_path / "labels.tsv").write_text("\n".join(["path\tlabel", *lines]), encoding="utf-8")
    (tmp_path / "queries.tsv").write_text("label\tquery\nnought\tzero\nsingle\tone\nother\ttwo\n", encoding="utf-8")
    return tmp_path


def report(folder: Path, queries: str = "queries.tsv"):
    return evaluate_labels(folder, Path("labels.tsv"), Path(queries), KnownAnswers(), load=load)


def test_average_precision_of_each_label(folder: Path) -> None:
    """A clip labelled "double" looks just like the one labelled "single": the tie is broken against us."""
    found = report(folder)
    assert found.precisions == {"nought": [1.0], "single": [0.5]}
    assert found.clips == {"nought": 2, "single": 1}
    assert found.mean == 0.75
    assert found.top1 == 1.0


def test_a_file_that_cannot_be_read_is_named_and_left_out(folder: Path) -> None:
    [(path, reason)] = report(folder).unreadable
    assert path == "broken.bvh"
    assert "broken" in reason


def test_the_document_holds_it_all(folder: Path) -> None:
    document = report(folder).as_dict()
    assert document["mean_average_precision"] == 0.75
    assert document["labels"]["single"] == {"clips": 1, "average_precision": 0.5, "queries": [0.5]}


def test_queries_of_no_label_are_an_error(folder: Path) -> None:
    (folder / "none.tsv").write_text("label\tquery\nother\ttwo\n", encoding="utf-8")
    with pytest.raises(QueryError, match="no readable clip"):
        report(folder, "none.tsv")


@pytest.mark.parametrize(
    ("text", "complaint"),
    [("", "header"), ("path\tlabel\n", "header"), ("path\tname\na\tb\n", "label"), ("path\tlabel\na.bvh\n", "row 2")],
)
def test_a_table_that_makes_no_sense_is_named(tmp_path: Path, text: str, complaint: str) -> None:
    table = tmp_path / "table.tsv"
    table.write_text(text, encoding="utf-8")
    with pytest.raises(QueryError, match=complaint) as error:
        read_table(table, ("path", "label"))
    assert "table.tsv" in str(error.value)


def test_tables_may_use_commas_and_begin_with_a_byte_order_mark(tmp_path: Path) -> None:
    (tmp_path / "t.csv").write_text('path,label\n"a, b.bvh",walk\n', encoding="utf-8-sig")
    assert read_table(tmp_path / "t.csv", ("path", "label")) == [{"path": "a, b.bvh", "label": "walk"}]
