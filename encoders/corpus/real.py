"""Captioned real motion as training pairs: cut where its captions say, mirrored, and played faster and slower."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from encoders.kinds import FeatureKind
from encoders.motion import Motion

_SWAPS = {
    "left": "right", "right": "left", "leftward": "rightward", "rightward": "leftward", "leftwards": "rightwards",
    "rightwards": "leftwards", "lefthand": "righthand", "righthand": "lefthand", "clockwise": "counterclockwise",
    "counterclockwise": "clockwise", "counter-clockwise": "clockwise", "anticlockwise": "clockwise",
    "anti-clockwise": "clockwise",
}  # fmt: skip
_SIDE_WORDS = re.compile(r"(?<![\w-])(" + "|".join(sorted(_SWAPS, key=len, reverse=True)) + r")(?=\W|s?\b)", re.I)
#: A phrase in which "right" is no side.
_NO_SIDE = re.compile(
    r"\bright (away|after|before|now|back|there|where)\b|\b(all|upright|straight) right\b|\bupright\b", re.I
)


@dataclass(frozen=True)
class CaptionedSpan:
    """What was said of a part of a take: sentences, and start and end in seconds."""

    captions: tuple[str, ...]
    start: float
    end: float


def mirror_words(sentence: str) -> str:
    """Left and right swapped; words in which "right" is no side stay."""
    kept = [m.span() for m in _NO_SIDE.finditer(sentence)]

    def swap(match: re.Match[str]) -> str:
        if any(start <= match.start() < end for start, end in kept):
            return match[0]
        other = _SWAPS[match[0].lower()]
        return other.capitalize() if match[0][0].isupper() else other

    return _SIDE_WORDS.sub(swap, sentence)


def spans_of_pairs(
    motion: Motion,
    spans: Sequence[CaptionedSpan],
    kind: FeatureKind,
    *,
    speeds: Sequence[float] = (0.85, 1.0, 1.2),
    mirrored: bool = True,
    longest: float = 12.0,
) -> Iterator[tuple[NDArray[np.float32], tuple[str, ...]]]:
    """Features and sentences of every span, at every speed, as recorded and mirrored.

    Features are computed for the whole take and sliced, as the product does with windows.
    """
    for speed in speeds:
        for flip in (False, True) if mirrored else (False,):
            played = Motion(motion.joints, motion.fps * speed).resample(motion.fps) if speed != 1 else motion
            features = kind.compute(played.mirror() if flip else played)
            for span in spans:
                first = int(span.start / speed * kind.fps)
                last = int(np.ceil(min(span.end, span.start + longest) / speed * kind.fps))
                part = features[first:last]
                if len(part) >= 4:
                    yield part, tuple(mirror_words(c) for c in span.captions) if flip else span.captions
