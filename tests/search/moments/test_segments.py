"""Segments: the whole take divided, nothing known allowed, and the files people exchange."""

from __future__ import annotations

import itertools
import json
from xml.etree import ElementTree

import numpy as np

from search.export.annotations import as_babel, as_document, as_eaf, as_tsv
from search.moments.segments import UNKNOWN, Segment, best_path

SEGMENTS = [Segment(0, 2.5, "walk", 0.7), Segment(2.5, 4, UNKNOWN, 0.0), Segment(4, 6, "sit <down> & wave", 0.5)]


def test_the_best_path_is_the_best_of_all() -> None:
    gains = np.random.default_rng(0).normal(size=(3, 7))

    def value(path: tuple[int, ...]) -> float:
        changes = sum(a != b for a, b in itertools.pairwise(path))
        return sum(gains[state, t] for t, state in enumerate(path)) - 0.8 * changes

    assert tuple(best_path(gains, 0.8)) == max(itertools.product(range(3), repeat=7), key=value)


def test_a_dear_change_keeps_short_flickers_out() -> None:
    gains = np.zeros((2, 50))
    gains[1, :20], gains[1, 20:] = -1.0, 1.0
    gains[1, 35] = -1.0
    assert np.flatnonzero(np.diff(best_path(gains, 2.0))).tolist() == [19]


def test_a_table_has_a_line_for_every_segment() -> None:
    lines = as_tsv(SEGMENTS, "take.bvh").splitlines()
    assert lines[0].split("\t") == ["start", "end", "label", "score"]
    assert lines[2].split("\t") == ["2.500", "4.000", "", "0.0000"]


def test_the_document_covers_the_take() -> None:
    document = as_document(SEGMENTS, "take.bvh")
    assert document["duration"] == 6
    assert [s["label"] for s in document["segments"]] == ["walk", "", "sit <down> & wave"]


def test_elan_reads_back_what_was_labelled() -> None:
    root = ElementTree.fromstring(as_eaf(SEGMENTS, "take.bvh").encode())
    times = {slot.get("TIME_SLOT_ID"): slot.get("TIME_VALUE") for slot in root.iter("TIME_SLOT")}
    found = [
        (times[a.get("TIME_SLOT_REF1")], times[a.get("TIME_SLOT_REF2")], a.findtext("ANNOTATION_VALUE"))
        for a in root.iter("ALIGNABLE_ANNOTATION")
    ]
    assert found == [("0", "2500", "walk"), ("4000", "6000", "sit <down> & wave")]


def test_babel_reads_back_what_was_labelled() -> None:
    labels = json.loads(as_babel(SEGMENTS, "take.bvh"))["take.bvh"]["frame_ann"]["labels"]
    assert [(x["start_t"], x["end_t"], x["raw_label"]) for x in labels] == [(0, 2.5, "walk"), (4, 6, SEGMENTS[2].label)]
