"""The first hits of questions whose answers are known: what the strength of real motion is calibrated and measured on.

Each question is asked of all motions, and of those that are not right, as of an archive that has no such motion.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from encoders.protocol import Encoder
from indexer.datasets.questioned_archives import QuestionedArchive
from search.evaluate.gallery import Gallery
from search.moments.localisation import best_moment
from search.moments.queried_motion import QueriedMotion
from search.query.encoding import encode_queries
from search.query.question import EncodedQuestion
from search.ranking.strength import background_level, score_statistics
from search.ranking.strength_calibration import Judged, calibrate_synthetically
from search.source import MotionSource

#: Hits of a question that count.
_HITS = 5


class JudgedHits(NamedTuple):
    """Hits of questions.

    Attributes
    ----------
    peaks : float array (H,)
        The highest similarity of each hit's moment.
    levels : float array (H, 2)
        The `background_level` of its question.
    right : bool array (H,)
    left_out : bool array (H,)
        Whether it was asked of an archive without the right ones.
    clip : int array (H,)
        The number of the motion.
    """

    peaks: NDArray[np.float64]
    levels: NDArray[np.float64]
    right: NDArray[np.bool_]
    left_out: NDArray[np.bool_]
    clip: NDArray[np.int64]

    @property
    def statistics(self) -> NDArray[np.float64]:
        """The `score_statistics` (H, 2)."""
        return score_statistics(self.peaks, (self.levels[:, 0], self.levels[:, 1]))


def judged_hits(
    encoder: Encoder, archive: QuestionedArchive, unrelated: NDArray[np.floating] | None = None
) -> JudgedHits:
    """The first hits of every question, ranked by clip score as search ranks, and judged by their first moments.

    Parameters
    ----------
    unrelated : array (M, D), optional
        Vectors of unrelated motions; those of the encoder's calibration if not given.
    """
    sources = [MotionSource.of_motion(motion) for motion in archive.motions]
    queries, rows = encode_queries(encoder, archive.sentences), []
    scores = Gallery(encoder, archive.motions).scores(queries)
    if unrelated is None:
        unrelated = (encoder.calibration or {})["motions"]
    levels = [background_level(row) for row in queries @ np.asarray(unrelated, np.float32).T]
    for query, level, those, heights in zip(queries, levels, archive.right, scores, strict=True):
        question = EncodedQuestion(query[None])
        for left_out in (False, True):
            among = np.where(those & left_out, -np.inf, heights)
            for clip in [i for i in np.argsort(-among)[:_HITS] if np.isfinite(among[i])]:
                peak = best_moment(QueriedMotion(encoder, sources[clip], question)).peak_score
                rows.append((peak, *level, those[clip], left_out, clip))
    peaks, first, second, right, absent, clips = np.array(rows, np.float64).reshape(-1, 6).T
    return JudgedHits(peaks, np.stack([first, second], axis=1), right > 0, absent > 0, clips.astype(np.int64))


def calibrate_on(encoder: Encoder, archives: Sequence[QuestionedArchive]) -> dict[str, NDArray[np.generic]]:
    """The arrays of `calibration.npz`, sentences calibrated on real archives, or on synthetic clips for want of any."""

    def real(unrelated: NDArray[np.float16]) -> list[Judged]:
        judged = [judged_hits(encoder, archive, unrelated) for archive in archives]
        return [(hits.statistics, hits.right) for hits in judged]

    return calibrate_synthetically(encoder, real if archives else None)
