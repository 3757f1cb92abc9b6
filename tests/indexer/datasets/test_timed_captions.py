"""Annotations of TMR's data sets and of BABEL, and lists of splits."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

from encoders.errors import DatasetError, MissingSplit
from indexer.datasets.timed_captions import TimedCaption, read_annotations, read_keys

BOXES = {"seg_id": "1_0", "text": "a man boxes", "start": 0.5, "end": 3.0}
ENTRY = {"path": "CMU/13/13_18_poses", "duration": 7.3, "annotations": [BOXES]}


def written(folder: Path, content: Any) -> Path:
    path = folder / "annotations.json"
    path.write_text(content if isinstance(content, str) else json.dumps(content), "utf-8")
    return path


def test_the_published_layout(tmp_path: Path) -> None:
    entries = read_annotations(written(tmp_path, {"000001": ENTRY, "000002": {**ENTRY, "annotations": []}}))
    assert list(entries) == ["000001"], "what has no caption is left out"
    entry = entries["000001"]
    assert (entry.key, entry.path, entry.duration) == ("000001", "CMU/13/13_18_poses", 7.3)
    assert entry.captions == (TimedCaption("a man boxes", 0.5, 3.0),)


def test_babel_becomes_the_same_with_labels_of_the_sequence_first(tmp_path: Path) -> None:
    babel = {
        "3593": {
            "dur": 8.0,
            "feat_p": "KIT/KIT/348/turn_left05_poses.npz",
            "seq_ann": {"labels": [{"raw_label": "turn", "seg_id": "a"}]},
            "frame_ann": {"labels": [{"raw_label": "stand", "seg_id": "b", "start_t": 0.0, "end_t": 1.5}]},
        },
        "12": {"dur": 3.0, "feat_p": "CMU/CMU/01/01_01_poses.npz", "seq_ann": {"labels": []}, "frame_ann": None},
    }
    entries = read_annotations(written(tmp_path, babel))
    assert list(entries) == ["3593"]
    assert entries["3593"].path == "KIT/348/turn_left05_poses"
    assert entries["3593"].captions == (TimedCaption("turn", 0.0, 8.0), TimedCaption("stand", 0.0, 1.5))


@pytest.mark.parametrize(
    ("content", "reason"),
    [
        ("{", "cannot be read as annotations"),
        ("[]", "one JSON object"),
        ({"1": []}, "'1' is no annotated motion"),
        ({"1": {**ENTRY, "duration": "long"}}, "'long' are no seconds"),
        ({"1": {**ENTRY, "annotations": [{**BOXES, "text": " "}]}}, "no sentence"),
        ({"1": {**ENTRY, "annotations": [{"text": "x", "start": 0}]}}, "'end' is missing"),
        ({"1": {**ENTRY, "annotations": [{**BOXES, "end": 0.1}]}}, "ends at 0.1 s, before it starts at 0.5 s"),
        ({"1": {**ENTRY, "annotations": [{**BOXES, "end": float("nan")}]}}, "nan are no seconds"),
        *(({"1": {**ENTRY, "path": path}}, "leads out of the folder") for path in ("../x", "/etc/x", "a/../../x", "")),
    ],
)
def test_what_is_wrong_with_annotations_is_said(tmp_path: Path, content: Any, reason: str) -> None:
    with pytest.raises(DatasetError, match=reason):
        read_annotations(written(tmp_path, content))


def test_a_split_is_a_list_of_keys_and_a_missing_one_names_those_that_are_there(tmp_path: Path) -> None:
    (tmp_path / "splits").mkdir()
    (tmp_path / "splits" / "test.txt").write_text("000001\nM000001\n\n000001\n", "utf-8")
    assert read_keys(tmp_path, "test") == ["000001", "M000001"]
    with pytest.raises(MissingSplit, match=r"no split 'tset' .*there: test"):
        read_keys(tmp_path, "tset")
    with pytest.raises(MissingSplit):
        read_keys(tmp_path, "../splits/test")
