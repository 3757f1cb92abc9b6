"""Segments as files that people and annotation tools read."""

from __future__ import annotations

import json
from collections.abc import Callable, Sequence
from xml.etree import ElementTree

from search.moments.segments import Segment


def as_tsv(segments: Sequence[Segment], path: str) -> str:
    """A table with the columns start, end, label and score; an empty label where none fits."""
    rows = [f"{s.start:.3f}\t{s.end:.3f}\t{' '.join(s.label.split())}\t{s.score:.4f}" for s in segments]
    return "\n".join(["start\tend\tlabel\tscore", *rows]) + "\n"


def as_document(segments: Sequence[Segment], path: str) -> dict[str, object]:
    """The segments as plain data."""
    rows = [
        {
            "start": round(s.start, 3),
            "end": round(s.end, 3),
            "label": s.label,
            "score": round(s.score, 4),
            "strength": s.strength,
        }
        for s in segments
    ]
    return {"path": path, "duration": round(segments[-1].end - segments[0].start, 3), "segments": rows}


def as_json(segments: Sequence[Segment], path: str) -> str:
    """One JSON document."""
    return json.dumps(as_document(segments, path), ensure_ascii=False, indent=2) + "\n"


def as_babel(segments: Sequence[Segment], path: str) -> str:
    """The frame annotations of one sequence as the BABEL data set writes them."""
    labels = [
        {"raw_label": s.label, "proc_label": s.label, "start_t": round(s.start, 3), "end_t": round(s.end, 3)}
        for s in segments
        if s.label
    ]
    sequence = {"feat_p": path, "dur": round(segments[-1].end, 3), "frame_ann": {"labels": labels}}
    return json.dumps({path: sequence}, ensure_ascii=False, indent=2) + "\n"


def as_eaf(segments: Sequence[Segment], path: str) -> str:
    """An ELAN document with one tier; times in milliseconds."""
    root = ElementTree.Element("ANNOTATION_DOCUMENT", AUTHOR="motionseek", DATE="", FORMAT="3.0", VERSION="3.0")
    ElementTree.SubElement(root, "HEADER", MEDIA_FILE="", TIME_UNITS="milliseconds")
    order = ElementTree.SubElement(root, "TIME_ORDER")
    tier = ElementTree.SubElement(root, "TIER", LINGUISTIC_TYPE_REF="default", TIER_ID="motion")
    known = [s for s in segments if s.label]
    for i, s in enumerate(known):
        first, last = f"ts{2 * i + 1}", f"ts{2 * i + 2}"
        for slot, time in ((first, s.start), (last, s.end)):
            ElementTree.SubElement(order, "TIME_SLOT", TIME_SLOT_ID=slot, TIME_VALUE=str(round(time * 1000)))
        outer = ElementTree.SubElement(tier, "ANNOTATION")
        inner = ElementTree.SubElement(
            outer, "ALIGNABLE_ANNOTATION", ANNOTATION_ID=f"a{i + 1}", TIME_SLOT_REF1=first, TIME_SLOT_REF2=last
        )
        ElementTree.SubElement(inner, "ANNOTATION_VALUE").text = s.label
    ElementTree.SubElement(root, "LINGUISTIC_TYPE", LINGUISTIC_TYPE_ID="default", TIME_ALIGNABLE="true")
    ElementTree.indent(root)
    return '<?xml version="1.0" encoding="UTF-8"?>\n' + ElementTree.tostring(root, encoding="unicode") + "\n"


#: Ending -> what writes it; the longest ending that fits counts.
FORMATS: dict[str, Callable[[Sequence[Segment], str], str]] = {
    ".babel.json": as_babel,
    ".json": as_json,
    ".tsv": as_tsv,
    ".eaf": as_eaf,
}
