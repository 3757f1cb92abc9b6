"""The report of a composition: what each sentence is shown by, how it fits, and whose motion it is."""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from search.compose.composition import Chosen, Composition
from search.drawing import film
from search.export import cut
from search.export.credits import credits_text
from search.export.replacing import write_text
from search.plausibility.ground import foot_sliding
from search.plausibility.seams import transition_distances
from search.source import MotionSource

#: Endings of what can be written.
WRITERS = (*cut.WRITERS, *film.WRITERS)


def document(composition: Composition) -> dict[str, Any]:
    """The report as plain data, numbers rounded: the keys of the command's JSON.

    `sliding` is the percentage of frames in which a standing foot slides.
    """
    return {
        "timeline": composition.timeline.name or None,
        "duration": round(composition.motion.duration, 3),
        "intervals": [_interval(chosen) for chosen in composition.chosen],
        "joins": [round(at, 3) for at in composition.joins],
        "transitions": [{"at": round(at, 3), "cm": round(cm, 2)} for at, cm in transitions(composition)],
        "sliding": round(foot_sliding(composition.motion.joints, composition.motion.fps)[1], 2),
        "credits": credits_of(composition.chosen) or None,
    }


def transitions(composition: Composition) -> list[tuple[float, float]]:
    """Where a piece or a body part goes over into another: the second, and the centimetres between its two frames."""
    motion, line = composition.motion, composition.timeline
    begin = motion.duration - line.duration
    seconds = {begin + edge for one in line.intervals for edge in (one.start, one.end)} | set(composition.joins)
    frames = sorted({round(at * motion.fps) for at in seconds})
    frames = [frame for frame in frames if 0 < frame < len(motion)]
    distances = transition_distances(motion.joints, frames).tolist()
    return [(frame / motion.fps, cm) for frame, cm in zip(frames, distances, strict=True)]


def _interval(chosen: Chosen) -> dict[str, Any]:
    candidate, source = chosen.candidate, chosen.candidate.source
    return {
        "text": chosen.interval.text,
        "start": round(chosen.interval.start, 3),
        "end": round(chosen.interval.end, 3),
        "parts": sorted(chosen.interval.parts),
        "path": source.path,
        "root": source.root,
        "clip": source.clip_id,
        "source_start": round(source.start + candidate.start, 3),
        "source_end": round(source.start + candidate.end, 3),
        "repeats": candidate.repeats,
        "rate": round(candidate.rate, 3),
        "score": round(candidate.score, 4),
        "tmr_score": round(chosen.tmr_score, 4),
    }


def credits_of(chosen: Sequence[Chosen]) -> str:
    """What the folders of the clips say about credits and terms of use; empty where they say nothing."""
    files: dict[str, tuple[Path, Path]] = {}
    for one in chosen:
        source = one.candidate.source
        if source.file is not None and source.library is not None:
            root = next((root for root in source.library.roots if root in source.file.parents), None)
            if root is not None:
                files[source.path] = (source.file, root)
    return credits_text(files)


def write_composition(composition: Composition, out: Path, *, rig: Path | None = None) -> None:
    """Write a composition as motion or as a picture, by the ending of `out`, and its report beside it as .json.

    Raises
    ------
    QueryError
        If the ending names nothing that can be written.
    MotionSeekError
        If it cannot be written; then what was there is as it was.
    """
    if out.suffix.lower() in film.WRITERS:
        film.write_picture(composition.motion, out)
    else:
        cut.write_cut(MotionSource.of_motion(composition.motion, out.stem), out, rig=rig)
    write_text(out.with_suffix(".json"), json.dumps(document(composition), ensure_ascii=False, indent=2) + "\n")
