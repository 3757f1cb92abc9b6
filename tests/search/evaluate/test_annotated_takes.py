"""Takes with annotated events: synthetic and held out, joined, and annotated by people."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from encoders.corpus.composition.captioned_motion import CaptionedSpan, CaptionedTake
from encoders.errors import QueryError
from encoders.features.registry import FEATURE_KINDS
from encoders.motion import Motion
from indexer.datasets.captioned_dataset import CaptionedDataset
from search.evaluate import annotated_takes
from tests.search.conftest import made_motion


def captioned(trial: str, *spans: tuple[str, float, float], seconds: float = 20.0) -> CaptionedTake:
    captions = tuple(CaptionedSpan((text,), start, end) for text, start, end in spans)
    return CaptionedTake(f"{trial}.bvh", trial, made_motion(seconds, 0), "walk", captions)


def test_synthetic_takes_hold_actions_held_out_of_training() -> None:
    (take,) = annotated_takes.synthetic_takes(1, seed=5)
    assert 30.0 <= take.motion.duration < 150.0
    assert any(m.held_out for m in take.annotations)


def test_joined_takes_are_as_long_as_asked_and_repeat_sentences() -> None:
    clips = [(made_motion(3.0, 0), "walks"), (made_motion(4.0, 1), "jumps")]
    for take in annotated_takes.joined_takes(clips, 3):
        assert 30.0 <= take.motion.duration <= 124.0
        assert {m.sentence for m in take.annotations} == {"walks", "jumps"}


def test_a_sentence_about_a_whole_take_is_no_moment_of_it() -> None:
    takes = [captioned("01_01", ("walks", 0.0, float("inf")), ("jumps", 2.0, 5.0), ("jumps", 8.0, float("inf")))]
    (take,) = annotated_takes.captioned_moments(takes)
    assert [(m.sentence, m.spans) for m in take.annotations] == [("jumps", ((2.0, 5.0), (8.0, 20.0)))]


def test_a_trial_in_several_rigs_is_one_take() -> None:
    first, second = captioned("01_01", ("jumps", 2.0, 5.0)), captioned("01_01", ("jumps", 2.0, 5.0), seconds=19.0)
    (take,) = annotated_takes.captioned_moments([first, second])
    assert take.motion.duration == first.motion.duration


@pytest.fixture
def archive(tmp_path: Path) -> Path:
    np.save(tmp_path / "a.npy", made_motion(10.0, 0).joints)
    (tmp_path / "broken.bvh").write_text("HIERARCHY", encoding="utf-8")
    rows = ["path\ttrial\tkind\tfps_in_file\tfps_true", "broken.bvh\t1\ttake\t20\t", "a.npy\t1\ttake\t\t20"]
    (tmp_path / "manifest.tsv").write_text("\n".join(rows), encoding="utf-8")
    return tmp_path


def test_labels_in_camel_case_become_sentences_of_words(archive: Path) -> None:
    rows = [{"start": 1, "end": 2.5, "label": "KneeRaise"}, {"start": 60, "end": 70, "label": "not in it"}]
    (archive / "segments.json").write_text(json.dumps({"1": rows, "2": rows}), encoding="utf-8")
    (take,) = annotated_takes.timed_segments(archive, archive / "segments.json")
    assert [(m.sentence, m.spans) for m in take.annotations] == [("knee raise", ((1, 2.5),))]
    assert isinstance(take.motion, Motion)


def test_segments_that_cannot_be_read_are_refused(archive: Path) -> None:
    (archive / "segments.json").write_text("[", encoding="utf-8")
    with pytest.raises(QueryError, match=r"segments\.json"):
        list(annotated_takes.timed_segments(archive, archive / "segments.json"))


def test_captions_of_parts_of_a_data_sets_motions_are_moments(tmp_path: Path) -> None:
    label = {"raw_label": "jump", "start_t": 2.0, "end_t": 5.0}
    labels = [label, {**label, "start_t": 8.0, "end_t": 12.0}, {**label, "raw_label": "transition"}]
    babel = {
        key: {
            "dur": 10.0,
            "feat_p": f"CMU/CMU/{key}_poses.npz",
            "seq_ann": {"labels": [{"raw_label": "dance"}]},
            "frame_ann": {"labels": rows},
        }
        for key, rows in (("1", labels), ("2", []))
    }
    (tmp_path / "val.json").write_text(json.dumps(babel), encoding="utf-8")
    (tmp_path / "motions" / "CMU").mkdir(parents=True)
    for key in babel:
        np.save(tmp_path / "motions" / "CMU" / f"{key}_poses.npy", made_motion(10.0, int(key)).joints)
    dataset = CaptionedDataset.open(tmp_path, FEATURE_KINDS["body"], fps=20)
    (take,) = annotated_takes.dataset_moments(dataset, "val")
    assert [(m.sentence, m.spans) for m in take.annotations] == [("jump", ((2.0, 5.0), (8.0, 10.0)))]
