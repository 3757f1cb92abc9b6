"""The project's own captions of CMU trials: of the form that training reads, and none that is held out."""

from __future__ import annotations

import json
from itertools import chain
from pathlib import Path

import encoders.tmr.training
from encoders.corpus.heldout.queries import paraphrase_queries
from encoders.corpus.language.held_out_sentences import HeldOutSentences

LINES = [
    json.loads(line)
    for line in Path(encoders.tmr.training.__file__).with_name("cmu_captions.jsonl").read_text("utf-8").splitlines()
]


def test_every_line_is_a_span_of_a_trial_to_train_on_with_distinct_captions() -> None:
    for line in LINES:
        assert set(line) == {"trial", "start_frame", "end_frame", "fps", "split", "captions"}
        assert line["split"] == "train"
        assert line["end_frame"] == -1 or 0 <= line["start_frame"] < line["end_frame"]
        assert len(set(line["captions"])) == len(line["captions"]) > 0
        assert all(caption == " ".join(caption.split()) for caption in line["captions"])


def test_no_caption_is_one_of_the_paraphrases_that_models_are_tested_with() -> None:
    held_out = HeldOutSentences(chain(*paraphrase_queries().values()))
    assert [caption for line in LINES for caption in line["captions"] if held_out(caption)] == []
