"""Commands read what others print; a whole archive is labelled; a folder is kept in step."""

from __future__ import annotations

import csv
import io
import json
import shutil
import threading
from pathlib import Path

import click
import numpy as np
import pytest

from indexer.ingest import indexing
from indexer.maintenance import watch
from search.cli.piped import clips_in
from search.library import Library
from tests.search.conftest import Run, made_motion


@pytest.fixture
def folder(indexed: Path, tmp_path: Path) -> Path:
    return Path(shutil.copytree(indexed, tmp_path / "takes"))


@pytest.mark.parametrize(
    "command",
    [("list",), ("list", "--json"), ("search", "walks", "--all"), ("search", "walks", "--all", "--json")],
)  # fmt: skip
def test_what_a_command_prints_the_next_one_reads(
    folder: Path, run: Run, monkeypatch: pytest.MonkeyPatch, command: tuple[str, ...]
) -> None:
    at = ("--library", folder)
    printed = run(*command, "--max-duration", "5", *at).out
    monkeypatch.setattr("sys.stdin", io.TextIOWrapper(io.BytesIO(printed.encode())))
    found = run("list", "--clips", "-", "--json", *at).document["clips"]
    assert {clip["path"] for clip in found} == {"take 0.npy", "take 1.npy"}
    monkeypatch.setattr("sys.stdin", io.TextIOWrapper(io.BytesIO(printed.encode())))
    assert run("tag", "-", "--add", "short", *at).code == 0
    assert run("tag", *at, "--json").document["tags"] == {"short": 2}


def test_hits_of_chosen_clips_are_exported(folder: Path, run: Run, tmp_path: Path) -> None:
    (tmp_path / "chosen.txt").write_text("take 1.npy\n#3\n\n")
    at = ("--library", folder)
    run(
        "search", "walks", "--clips", tmp_path / "chosen.txt", "--all", "--export", tmp_path / "out", "--as", "npy", *at
    )
    assert len(list((tmp_path / "out").glob("*.npy"))) == 2
    (tmp_path / "chosen.txt").write_text("nowhere.npy\n")
    assert "nowhere.npy" in run("list", "--clips", tmp_path / "chosen.txt", *at).err
    assert run("list", "--clips", tmp_path / "none.txt", *at).code != 0


def test_stacks_are_read_as_clips() -> None:
    stacks = {"stacks": [{"clips": [{"id": 3, "path": "a"}, {"id": 7, "path": "b"}]}]}
    assert clips_in(json.dumps(stacks)) == ["#3", "#7"]
    assert clips_in("1\t#3\tr\ta b.bvh\t2.0\trig\t\n") == ["#3"]


@pytest.mark.parametrize(
    "text",
    ['{"clips": ["a b.bvh", 3]}', '["a b.bvh", 3]', '[{"path": "a b.bvh"}, {"id": 3, "path": "c.bvh"}]'],
)  # fmt: skip
def test_json_names_clips_by_path_by_number_and_as_objects(text: str) -> None:
    assert clips_in(text) == ["a b.bvh", "#3"]


def test_a_name_may_begin_with_a_bracket() -> None:
    assert clips_in("[old] walk.bvh\n[old] run.bvh\n") == ["[old] walk.bvh", "[old] run.bvh"]


@pytest.mark.parametrize("text", ["{", '{"clips": "a.bvh"}', '{"stacks": [1]}', "[null]", '[{"name": "a"}]', "[true]"])
def test_json_that_names_no_clips_is_a_usage_error(text: str) -> None:
    with pytest.raises(click.UsageError, match="piped in"):
        clips_in(text)


def test_a_whole_archive_is_labelled_as_a_captions_table(folder: Path, run: Run, tmp_path: Path) -> None:
    at = ("--library", folder)
    out = tmp_path / "labels.csv"
    assert "wrote the sentences of 3 clips" in run("describe", "--all", "-k", "2", "--uncaptioned", "-o", out, *at).err
    rows = list(csv.DictReader(out.open(encoding="utf-8")))
    assert len(rows) == 6
    with Library.open(folder) as library:
        clip = library.find(rows[0]["path"])
    sentences = run("describe", f"#{clip.id}", "-k", "2", *at, "--json").document["sentences"]
    assert [row["text"] for row in rows[:2]] == [sentence["text"] for sentence in sentences]
    shutil.copy(out, folder / "captions.csv")
    run("index", folder, "--jobs", "1")
    assert not run("list", "--uncaptioned", *at).out
    assert run("describe", "--all", "-o", out, *at).code != 0
    assert len(run("describe", "--all", "-k", "1", *at).out.splitlines()) == 5


def test_describing_all_takes_no_clip(folder: Path, run: Run, tmp_path: Path) -> None:
    at = ("--library", folder)
    assert "no CLIP" in run("describe", "take 1.npy", "--all", *at).err
    assert "give --all" in run("describe", *at).err
    assert "-o needs --all" in run("describe", "take 1.npy", "-o", tmp_path / "x.csv", *at).err


def test_a_folder_is_kept_in_step_until_it_is_stopped(folder: Path, run: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    real, runs = indexing.index, []

    def index(*given: object, **options: object) -> indexing.Summary:
        summary = real(*given, **options)  # type: ignore[arg-type]
        runs.append((summary.indexed, summary.gone))
        if len(runs) == 1:
            np.save(folder / "new.npy", made_motion(3.0, 70).joints)
        elif len(runs) == 2:
            threading.Timer(0.1, (folder / "new.npy").unlink).start()
        else:
            raise KeyboardInterrupt
        return summary

    monkeypatch.setattr(indexing, "index", index)
    monkeypatch.setattr(watch, "PAUSE", 0.05)
    monkeypatch.setattr(watch.changes, "__kwdefaults__", {"pause": 0.05})
    done = run("index", folder, "--watch", "--jobs", "1")
    assert (done.code, runs) == (0, [(0, 0), (1, 0), (0, 1)])
    assert "watching" in done.err
