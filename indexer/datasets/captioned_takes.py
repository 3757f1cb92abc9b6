"""Captioned takes of a folder with a manifest: what the model is trained and validated on."""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence
from contextlib import suppress
from itertools import repeat
from pathlib import Path
from typing import Any

from encoders.corpus.composition.captioned_motion import CaptionedSpan, CaptionedTake
from encoders.errors import MotionSeekError, QueryError
from encoders.motion import Motion
from indexer.datasets.archive_tables import load_row, read_manifest
from indexer.ingest.load import load_motion


def captioned_takes(
    folder: Path, captions: Path, split: str, *, more_captions: Sequence[Path] = ()
) -> Iterator[CaptionedTake]:
    """Takes of one split of a folder with a `manifest.tsv`, with the captions of `captions` (JSON lines) for the split.

    The manifest has the columns path, trial, kind, split, use, fps_in_file, fps_true and description; a caption line
    has trial, start_frame and end_frame at `fps` (-1: the end), captions, split, and perhaps spans_s: for each caption
    the seconds within the line's span that it is about. Captions of the same span, also those of `more_captions`, go
    together. Only rows whose split and use are `split` are read, so what is for evaluation only never comes through.
    Unreadable takes are left out; what is no "take" has no captions.

    Raises
    ------
    QueryError
        If the manifest or the captions cannot be read.
    """
    rows = [r for r in read_manifest(folder, ("split", "use", "description")) if r["split"] == r["use"] == split]
    captioned = _captioned_spans([captions, *more_captions], split)
    for row in rows:
        try:
            motion = load_row(folder, row)
        except MotionSeekError:
            continue
        timed = captioned.get(row["trial"], ()) if row["kind"] == "take" else ()
        spans = tuple(span for span in timed if span.start < motion.duration - 0.5)
        yield CaptionedTake(row["path"], row["trial"], motion, row["description"], spans)


def uncaptioned_takes(folder: Path) -> Iterator[Motion]:
    """The BVH takes below a folder, without captions; unreadable ones are left out.

    Raises
    ------
    QueryError
        If there is none.
    """
    paths = sorted(folder.rglob("*.bvh"))
    if not paths:
        raise QueryError(f"{folder}: holds no .bvh files")
    for path in paths:
        with suppress(MotionSeekError):
            yield load_motion(path)


def _captioned_spans(files: Sequence[Path], split: str) -> dict[str, list[CaptionedSpan]]:
    """The captioned spans of each trial of a split."""
    found: dict[str, dict[tuple[float, float], list[str]]] = {}
    for captions in files:
        try:
            lines = [json.loads(line) for line in captions.read_text(encoding="utf-8").splitlines() if line.strip()]
            for line in lines:
                if line["split"] == split:
                    _add_captions(line, found.setdefault(line["trial"], {}))
        except (OSError, KeyError, TypeError, ValueError) as error:
            raise QueryError(f"{captions}: no captions as JSON lines ({error!r}); see docs/training.md") from error
        if not lines:
            raise QueryError(f"{captions}: holds no captions; see docs/training.md")
    return {
        trial: [CaptionedSpan(tuple(captions), *span) for span, captions in spans.items()]
        for trial, spans in found.items()
    }


def _add_captions(line: dict[str, Any], spans: dict[tuple[float, float], list[str]]) -> None:
    """Add the captions of a line to those of the span, or the part of it, that they are about."""
    start = line["start_frame"] / line["fps"]
    end = float("inf") if line["end_frame"] < 0 else line["end_frame"] / line["fps"]
    for caption, part in zip(line["captions"], line.get("spans_s") or repeat(None), strict=False):
        first, last = part or (None, None)
        span = (start + (first or 0.0), end if last is None else min(start + last, end))
        spans.setdefault(span, []).append(caption)
