"""Figures of motions for time lines, and of each crop: what a sentence should show, and when (STMC)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from encoders.metrics import ranks
from encoders.motion import FPS, Motion
from encoders.protocol import Encoder
from search.evaluate.row_formats import csv_text
from search.judging.encoded_motions import EncodedMotions
from search.judging.generated_figures import Comparison, Figures, Missing, drawn_figures, fixed_figures
from search.judging.judgement import REPEATS, Judgement, averaged
from search.judging.metrics.agreement import tmr_scores
from search.judging.motion_table import JudgedMotion
from search.judging.timeline_files import TimelineMotion, check_references

#: The figures that STMC reports of crops, of whole motions, and of both drawn at random.
_OF_CROPS = ("score_text", "score_motion", "precision_1", "precision_3")
_OF_WHOLE = ("transition", "transition_world", "skate", "skating", "penetration")
_DRAWN = ("frechet_crops",)


@dataclass(frozen=True)
class CropFigures:
    """A crop of a motion.

    Attributes
    ----------
    timeline, text : str
    start, end : float
        Seconds.
    score_text, score_motion : float or None
        TMR-scores with its own text, and with the real clip of that text where there is one.
    rank : float
        Of its own text among all texts, from 1; ties take the mean of their places.
    """

    timeline: str
    text: str
    start: float
    end: float
    score_text: float
    score_motion: float | None
    rank: float

    def as_dict(self) -> dict[str, Any]:
        """Plain values, for JSON."""
        return asdict(self)


def judge_timelines(
    timelines: Sequence[TimelineMotion],
    references: Mapping[str, Motion] | None,
    encoder: Encoder,
    *,
    repeats: int = REPEATS,
    seed: int = 0,
) -> tuple[Judgement, list[CropFigures]]:
    """Judge the motions of time lines: the figures over all crops, and each crop.

    Parameters
    ----------
    references : mapping of text to Motion, optional
        A real clip of each text. Their texts are those that a crop's own is ranked among; without references the texts
        of the time lines.

    Raises
    ------
    QueryError
        If a text has no reference.
    """
    if references is not None:
        check_references(references, list(timelines))
    crops = [_crop(one, prompt.text, prompt.start, prompt.end) for one in timelines for prompt in one.prompts]
    whole = EncodedMotions([replace(one.motion, transitions=tuple(one.boundaries)) for one in timelines], encoder)
    real = None if references is None else EncodedMotions(_named(references), encoder)
    texts = list(references or dict.fromkeys(one.text for one in crops))
    cut = EncodedMotions(crops, encoder)
    own = [texts.index(one.text) for one in crops]
    vectors = encoder.encode_texts(texts)
    with_text = tmr_scores(cut.vectors, vectors[own])
    with_real = None if real is None else tmr_scores(cut.vectors, real.vectors[own])
    rank = ranks(cut.vectors @ vectors.T, np.arange(len(texts)) == np.array(own)[:, None])

    figures = _crop_figures(with_text, with_real, rank)
    generated = Comparison(whole, real, None, (), ())
    fixed = _only(fixed_figures(generated), _OF_WHOLE)
    drawn = [_only(drawn_figures(generated, seed + i), _DRAWN) for i in range(repeats)]
    measured, missing = averaged([figures, fixed, *drawn])
    of_real = {}
    if real is not None:
        itself = Comparison(real, real, range(len(real.motions)), (), ())
        alone = [_only(drawn_figures(itself, seed + i), _DRAWN) for i in range(repeats)]
        of_real = averaged([_only(fixed_figures(itself), (*_OF_CROPS, *_OF_WHOLE)), *alone])[0]
    evaluator = f"{encoder.name} ({encoder.fingerprint[:12]})"
    judgement = Judgement(evaluator, len(timelines), len(references or ()), measured, of_real, missing)
    return judgement, _rows(timelines, with_text, with_real, rank)


def _crop(one: TimelineMotion, text: str, start: int, end: int) -> JudgedMotion:
    joints = one.motion.motion.joints[start : max(end, start + 1)]
    return JudgedMotion(one.motion.name, Motion(joints, one.motion.motion.fps), text)


def _named(references: Mapping[str, Motion]) -> list[JudgedMotion]:
    return [JudgedMotion(text, motion, text) for text, motion in references.items()]


def _crop_figures(
    with_text: NDArray[np.float64], with_real: NDArray[np.float64] | None, rank: NDArray[np.float64]
) -> tuple[Figures, Missing]:
    found = {"score_text": float(with_text.mean())}
    found |= {f"precision_{k}": float(100 * np.mean(rank < k)) for k in (1, 3)}
    if with_real is None:
        return found, {"score_motion": "no references"}
    return found | {"score_motion": float(with_real.mean())}, {}


def _only(found: tuple[Figures, Missing], names: Sequence[str]) -> tuple[Figures, Missing]:
    figures, missing = ({name: part[name] for name in names if name in part} for part in found)
    return figures, missing  # type: ignore[return-value]


def _rows(
    timelines: Sequence[TimelineMotion],
    with_text: NDArray[np.float64],
    with_real: NDArray[np.float64] | None,
    rank: NDArray[np.float64],
) -> list[CropFigures]:
    prompts = [(one, prompt) for one in timelines for prompt in one.prompts]
    return [
        CropFigures(
            one.motion.name,
            prompt.text,
            prompt.start / FPS,
            prompt.end / FPS,
            float(with_text[i]),
            None if with_real is None else float(with_real[i]),
            float(rank[i]) + 1,
        )
        for i, (one, prompt) in enumerate(prompts)
    ]


def crop_table(rows: Sequence[CropFigures]) -> str:
    """The crops as CSV."""
    columns = list(CropFigures.__dataclass_fields__)
    return csv_text(columns, (list(row.as_dict().values()) for row in rows))
