"""`index`, `check`, `search` and `serve` with a collection of Milvus, as a user runs them."""

from __future__ import annotations

import shutil
from pathlib import Path

import click
import pytest

pytest.importorskip("milvus_lite")

from search.cli.commands.serve import served
from tests.search.conftest import Run


@pytest.fixture
def archive(takes: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The takes without a library; the working folder is beside them."""
    monkeypatch.chdir(tmp_path)
    return Path(shutil.copytree(takes, tmp_path / "archive"))


def test_two_shards_fill_a_collection_that_answers_without_the_folder(run: Run, archive: Path) -> None:
    count = 5  # one take cannot be read
    ran = [run("index", archive, "--shard", f"{i}/2", "--vectors", "all.db", "--poses", "poses") for i in (1, 2)]
    assert all("clips sent" in one.out for one in ran)
    shutil.rmtree(archive)
    hits = run("search", "a person walks", "--library", "all.db", "--all", "-k", 100, "--json").document["hits"]
    assert len({hit["path"] for hit in hits}) == count
    library = served(None, "all.db", "poses", edit=False)
    assert len(library) == count


def test_a_collection_out_of_step_is_named_and_brought_in_step(run: Run, archive: Path) -> None:
    run("index", archive)
    missing = run("check", archive, "--vectors", "all.db")
    assert missing.code == 1
    assert "take 0.npy: is not in the collection" in missing.err
    run("index", archive, "--vectors", "all.db")
    assert run("check", archive, "--vectors", "all.db").out.strip() == "nothing is wrong"
    (archive / "take 1.npy").unlink()
    run("index", archive)
    behind = run("check", archive, "--vectors", "all.db")
    assert behind.code == 1
    assert "take 1.npy" in behind.err
    assert run("check", "--repair", archive, "--vectors", "all.db").code == 0
    assert run("check", archive, "--vectors", "all.db").code == 0


@pytest.mark.parametrize(
    ("arguments", "advice"),
    [
        (["index", "archive", "--shard", "3/2"], "shard"),
        (["index", "archive", "--shard", "1/2", "--vectors", "milvus://"], "milvus://"),
        (["index", "archive", "--poses", "poses"], "give vectors"),
        (["check", "archive", "--shard", "1/2"], "--vectors"),
        (["search", "walks", "--library", "none.db"], "none.db"),
        (["search", "walks", "--library", "milvus://127.0.0.1:9/mocap"], "milvus://127.0.0.1:9/mocap: "),
        (["serve", "archive", "--vectors", "all.db"], "cannot be combined"),
    ],
)
def test_what_cannot_be_is_said_in_a_line(run: Run, archive: Path, arguments: list[str], advice: str) -> None:
    ran = run(*arguments)
    assert ran.code in (1, 2)
    assert advice in ran.err
    assert ran.err.count("\n") == 1
    assert not Path("none.db").exists()


def test_poses_are_for_collections(archive: Path) -> None:
    with pytest.raises(click.UsageError, match="--poses"):
        served(str(archive), None, "poses", edit=False)
