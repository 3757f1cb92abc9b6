"""Captioned takes: of one split and use only, with the spans of its captions."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from encoders.corpus.composition.captioned_motion import CaptionedSpan, CaptionedTake
from encoders.errors import QueryError, UnreadableMotion
from encoders.motion import Motion
from indexer.datasets import captioned_takes as module
from indexer.datasets.captioned_takes import captioned_takes, uncaptioned_takes

COLUMNS = ("path", "trial", "kind", "split", "use", "fps_in_file", "fps_true", "description")
ROWS = (
    ("walk.bvh", "1", "take", "train", "train", "24", "120", "walks"),
    ("other_rig.bvh", "1", "take", "train", "train", "", "", "walks"),
    ("sit.bvh", "2", "take", "val", "val", "30", "", "sits"),
    ("kept.bvh", "3", "take", "train", "evaluation only", "", "", "secret"),
    ("held.bvh", "4", "take", "eval", "evaluation only", "", "", "secret"),
    ("clip.bvh", "1", "clip", "train", "train", "", "", "part of a walk"),
    ("broken.bvh", "1", "take", "train", "train", "", "", "walks"),
)
LINES = (
    {"trial": "1", "start_frame": 20, "end_frame": 80, "fps": 20, "captions": ["a man walks", "he strolls"]},
    {"trial": "1", "start_frame": 0, "end_frame": -1, "fps": 20, "captions": ["walking"], "spans_s": [[1.0, 3.0]]},
    {"trial": "1", "start_frame": 0, "end_frame": -1, "fps": 20, "captions": ["all of it"], "spans_s": [[0.0, None]]},
    {"trial": "1", "start_frame": 400, "end_frame": 500, "fps": 20, "captions": ["after the end"]},
    {"trial": "1", "start_frame": 0, "end_frame": 40, "fps": 20, "captions": ["another's"], "split": "eval"},
    {"trial": "2", "start_frame": 0, "end_frame": 40, "fps": 20, "captions": ["sits down"], "split": "val"},
)


@pytest.fixture
def asked(monkeypatch: pytest.MonkeyPatch) -> dict[str, float | None]:
    """Frame rates that files were read at; every file lasts ten seconds."""
    rates: dict[str, float | None] = {}

    def load(path: Path, fps: float | None = None) -> Motion:
        if path.stem == "broken":
            raise UnreadableMotion(path, "broken")
        rates[path.name] = fps
        return Motion(np.zeros((200, 22, 3), np.float32))

    monkeypatch.setattr("indexer.datasets.archive_tables.load_motion", load)
    return rates


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    table = "\n".join("\t".join(row) for row in (COLUMNS, *ROWS))
    (tmp_path / "manifest.tsv").write_text(table, encoding="utf-8")
    lines = "\n".join(json.dumps({"split": "train", **line}) for line in LINES)
    (tmp_path / "captions.jsonl").write_text(lines, encoding="utf-8")
    return tmp_path


def takes(folder: Path, split: str) -> list[CaptionedTake]:
    return list(captioned_takes(folder, folder / "captions.jsonl", split))


def test_only_rows_of_the_split_and_its_use_come_through(folder: Path, asked: dict[str, float | None]) -> None:
    assert [take.path for take in takes(folder, "train")] == ["walk.bvh", "other_rig.bvh", "clip.bvh"]
    assert [take.path for take in takes(folder, "val")] == ["sit.bvh"]
    assert takes(folder, "eval") == [], "what is for evaluation only is never read"
    assert not {"kept.bvh", "held.bvh"} & set(asked)


def test_spans_are_those_of_the_split_within_the_take(folder: Path, asked: dict[str, float | None]) -> None:
    walk, other_rig, clip = takes(folder, "train")
    assert walk.spans == other_rig.spans
    assert walk.spans == (
        CaptionedSpan(("a man walks", "he strolls"), 1.0, 4.0),
        CaptionedSpan(("walking",), 1.0, 3.0),
        CaptionedSpan(("all of it",), 0.0, float("inf")),
    )
    assert clip.spans == (), "captions are timed on whole takes"
    assert walk.description == "walks"


def test_captions_of_one_span_go_together_also_those_of_another_file(
    folder: Path, asked: dict[str, float | None]
) -> None:
    more = {
        "trial": "1",
        "start_frame": 30,
        "end_frame": 90,
        "fps": 30,
        "captions": ["going on foot"],
        "split": "train",
    }
    (folder / "more.jsonl").write_text(json.dumps(more), encoding="utf-8")
    walk, *_ = captioned_takes(folder, folder / "captions.jsonl", "train", more_captions=[folder / "more.jsonl"])
    assert [span.captions for span in walk.spans] == [
        ("a man walks", "he strolls"), ("walking", "going on foot"), ("all of it",)
    ]  # fmt: skip


def test_the_true_frame_rate_is_used(folder: Path, asked: dict[str, float | None]) -> None:
    takes(folder, "train")
    takes(folder, "val")
    assert asked == {"walk.bvh": 120.0, "other_rig.bvh": None, "sit.bvh": 30.0, "clip.bvh": None}


@pytest.mark.parametrize("damage", ["missing", "empty", "no json", "no split", "no columns"])
def test_what_cannot_be_read_is_named_in_one_error(folder: Path, asked: dict[str, float | None], damage: str) -> None:
    lines = folder / "captions.jsonl"
    if damage == "missing":
        lines.unlink()
    elif damage == "no columns":
        (folder / "manifest.tsv").write_text("path\nwalk.bvh\n", encoding="utf-8")
    else:
        lines.write_text({"empty": "", "no json": "{", "no split": '{"trial": "1"}'}[damage], encoding="utf-8")
    with pytest.raises(QueryError, match="manifest.tsv: " if damage == "no columns" else "captions.jsonl: "):
        takes(folder, "train")


def test_takes_without_captions_are_all_readable_bvh_files_of_a_folder(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    still = Motion(np.zeros((20, 22, 3), np.float32))

    def load(path: Path) -> Motion:
        if path.stem == "broken":
            raise UnreadableMotion(path, "not a BVH file")
        return still

    monkeypatch.setattr(module, "load_motion", load)
    with pytest.raises(QueryError, match=r"no \.bvh"):
        list(uncaptioned_takes(tmp_path))
    (tmp_path / "below").mkdir()
    for name in ("one.bvh", "broken.bvh", "below/two.bvh", "notes.txt"):
        (tmp_path / name).touch()
    assert list(uncaptioned_takes(tmp_path)) == [still, still]
