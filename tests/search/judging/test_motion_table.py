"""Folders of motions, what tables say of them, and what is wrong with either."""

from pathlib import Path

import numpy as np
import pytest

from encoders.errors import QueryError, UnreadableMotion
from search.judging.motion_table import read_folder
from tests.search.judging.bodies import standing


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """Two motions, one of them in a subfolder with a space and an umlaut."""
    (tmp_path / "zwei Füße").mkdir()
    for name in ("one.npy", "zwei Füße/two.npy"):
        np.save(tmp_path / name, standing(50) + np.sin(np.arange(50) / 5)[:, None, None] * [0, 0, 0.01])
    (tmp_path / ".hidden.npy").write_bytes(b"")
    return tmp_path


def test_a_table_says_what_each_motion_is(folder: Path) -> None:
    table = folder / "said.tsv"
    table.write_text(
        "path\ttext\tlabel\treference\ttransitions\n"
        "one.npy\ta person stands\tstand\treal/7.bvh\t1.0 1.25\nzwei Füße/two\ta man sways\tsway\tx\t\n",
        "utf-8",
    )
    one, two = read_folder(folder, table)
    assert (one.name, one.text, one.label, one.reference, one.transitions) == (
        "one", "a person stands", "stand", "real/7.bvh", (20, 25),
    )  # fmt: skip
    assert (two.name, two.text, two.transitions) == ("zwei Füße/two", "a man sways", ())


def test_texts_lie_in_a_folder_as_those_of_humanml3d(folder: Path, tmp_path_factory: pytest.TempPathFactory) -> None:
    texts = tmp_path_factory.mktemp("texts")
    (texts / "zwei Füße").mkdir()
    (texts / "one.txt").write_text("a person stands.#a/DET person/NOUN#0.0#0.0\nanother#x#0.0#0.0\n")
    (texts / "zwei Füße" / "two.txt").write_text("\na man sways\n")
    assert [one.text for one in read_folder(folder, texts)] == ["a person stands.", "a man sways"]
    (texts / "one.txt").write_text("#0.0\n")
    with pytest.raises(QueryError, match=r"one.txt: holds no sentence"):
        read_folder(folder, texts)
    (texts / "one.txt").unlink()
    with pytest.raises(QueryError, match=r"one.txt: no text for this motion"):
        read_folder(folder, texts)


@pytest.mark.parametrize(
    ("lines", "message"),
    [
        ("path\ttext\none\ta\n", r"no row for 1 \(zwei Füße/two\) of the folder's 2 motions"),
        ("path\ttext\none\ta\nzwei Füße/two\tb\nthree\tc\n", r"1 \(three\) of 3 rows are no motion of the folder"),
        ("path\ttext\none\ta\none.npy\tb\n", "two rows for one.npy"),
        ("path\ttext\none\t\nzwei Füße/two\tb\n", "the text of one is missing"),
        ("path\tcaption\none\ta\nzwei Füße/two\tb\n", "says nothing of the motions; it needs a column text"),
        ("path\ttransitions\none\tsoon\nzwei Füße/two\t1\n", "one: 'soon' is no time in seconds"),
        ("path\ttransitions\none\t2.5\nzwei Füße/two\t1\n", "one: a transition at 2.5 s lies outside its 2.50 s"),
        ("name\ttext\none\ta\n", "needs a header line with path"),
    ],
)
def test_tables_that_do_not_fit_are_refused(folder: Path, lines: str, message: str) -> None:
    (folder / "said.tsv").write_text(lines, "utf-8")
    with pytest.raises(QueryError, match=message):
        read_folder(folder, folder / "said.tsv")


def test_a_folder_without_motions_and_a_motion_with_nan_are_refused(folder: Path, tmp_path: Path) -> None:
    empty = tmp_path / "empty"
    empty.mkdir()
    with pytest.raises(QueryError, match="empty: no motion in this folder; files end in"):
        read_folder(empty)
    broken = standing(50)
    broken[7, 3, 1] = np.nan
    np.save(folder / "one.npy", broken)
    with pytest.raises(UnreadableMotion, match=r"one.npy"):
        read_folder(folder)
