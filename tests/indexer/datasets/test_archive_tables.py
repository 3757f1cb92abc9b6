"""Tables of an archive: what they may look like, and what is refused by name."""

from __future__ import annotations

from pathlib import Path

import pytest

from encoders.errors import QueryError
from indexer.datasets.archive_tables import read_columns, read_manifest


@pytest.mark.parametrize(
    ("text", "complaint"),
    [("", "header"), ("path\tlabel\n", "header"), ("path\tname\na\tb\n", "label"), ("path\tlabel\na.bvh\n", "row 2")],
)
def test_an_unusable_table_is_named(tmp_path: Path, text: str, complaint: str) -> None:
    table = tmp_path / "table.tsv"
    table.write_text(text, encoding="utf-8")
    with pytest.raises(QueryError, match=complaint) as error:
        read_columns(table, ("path", "label"))
    assert "table.tsv" in str(error.value)


def test_tables_may_use_commas_and_begin_with_a_byte_order_mark(tmp_path: Path) -> None:
    (tmp_path / "t.csv").write_text('path,label\n"a, b.bvh",walk\n', encoding="utf-8-sig")
    assert read_columns(tmp_path / "t.csv", ("path", "label")) == [{"path": "a, b.bvh", "label": "walk"}]


def test_cells_of_a_manifest_may_be_empty_but_its_columns_must_be_there(tmp_path: Path) -> None:
    table = tmp_path / "manifest.tsv"
    table.write_text("path\ttrial\tkind\tfps_in_file\tfps_true\na.npy\t\ttake\t20\t\n", encoding="utf-8")
    assert [row["trial"] for row in read_manifest(tmp_path)] == [""]
    with pytest.raises(QueryError, match="split"):
        read_manifest(tmp_path, ("split",))
