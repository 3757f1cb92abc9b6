"""`check` and `forget` as a user runs them."""

import shutil
import sqlite3
from pathlib import Path

import pytest

from tests.search.conftest import Run


@pytest.fixture
def own_copy(indexed: Path, tmp_path: Path) -> Path:
    """A copy of the indexed takes, to be changed."""
    return Path(shutil.copytree(indexed, tmp_path / "takes"))


def _damage(folder: Path, statement: str) -> None:
    with sqlite3.connect(folder / ".motionseek" / "library.sqlite") as connection:
        connection.execute(statement)
    connection.close()


def test_damage_is_named_and_mended(run: Run, own_copy: Path) -> None:
    assert run("check", own_copy).out.strip() == "nothing is wrong"
    _damage(own_copy, "UPDATE embeddings SET vector = zeroblob(length(vector)) WHERE clip_id = 1")
    found = run("check", own_copy)
    assert found.code == 1
    assert "its vectors are damaged" in found.err
    assert found.out.strip() == "2 faults; motionseek check --repair mends what can be made again"
    mended = run("check", "--repair", own_copy)
    assert (mended.code, mended.out.strip()) == (0, "nothing is wrong")
    assert "its vectors are damaged (mended)" in mended.err
    assert run("check", "--json", own_copy).document == {"found": [], "left": [], "unchecked": 0}


def test_a_clip_is_forgotten_until_its_file_is_indexed_again(run: Run, own_copy: Path) -> None:
    forgotten = run("forget", "take 2.npy", "--library", own_copy)
    assert (forgotten.out.strip(), forgotten.err.strip()) == ("1 forgotten", "forgotten: take 2.npy")
    assert "take 2.npy" not in run("list", "--library", own_copy).out
    assert run("check", own_copy).code == 0
    run("index", own_copy)
    assert "take 2.npy" in run("list", "--library", own_copy).out
    assert run("status", own_copy, "--json").document["gone"] == 0, "no file has gone"


def test_a_library_that_was_only_begun_is_finished_by_the_next_index(run: Run, own_copy: Path) -> None:
    shutil.rmtree(own_copy / ".motionseek")
    (own_copy / ".motionseek").mkdir()
    (own_copy / ".motionseek" / "library.sqlite").touch()
    assert "not finished" in run("search", "walks", "--library", own_copy).err
    assert "5 indexed" in run("index", own_copy).out
    assert run("search", "walks", "--library", own_copy).code == 0


def test_what_is_gone_can_be_forgotten(run: Run, own_copy: Path) -> None:
    (own_copy / "take 1.npy").unlink()
    run("index", own_copy)
    assert run("status", own_copy, "--json").document["gone"] == 1
    assert run("forget", "--gone", "--library", own_copy).out.strip() == "1 forgotten"
    assert run("forget", "--gone", "--library", own_copy).out.strip() == "0 forgotten"
    assert run("forget", "no such clip", "--library", own_copy).code == 1
    assert run("forget", "--library", own_copy).code == 2


def test_a_file_in_place_of_a_folder_is_named_with_a_command_that_can_be_pasted(run: Run, own_copy: Path) -> None:
    refused = run("index", own_copy / "take 2.npy")
    assert refused.code == 2
    assert f"motionseek describe '{own_copy / 'take 2.npy'}'" in refused.err
