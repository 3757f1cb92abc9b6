"""Captioned real motion as training pairs: cut at caption spans, mirrored, and at several playback speeds."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import product

import numpy as np
from numpy.typing import NDArray

from encoders.features.registry import FeatureKind
from encoders.motion import Motion

#: Playback speeds, and the fewest feature frames of a clip.
_SPEEDS, _SHORTEST = (0.85, 1.0, 1.2), 4

_MIRRORED = {
    "left": "right", "right": "left", "leftward": "rightward", "rightward": "leftward", "leftwards": "rightwards",
    "rightwards": "leftwards", "lefthand": "righthand", "righthand": "lefthand", "clockwise": "counterclockwise",
    "counterclockwise": "clockwise", "counter-clockwise": "clockwise", "anticlockwise": "clockwise",
    "anti-clockwise": "clockwise", "counter clockwise": "clockwise", "anti clockwise": "clockwise",
}  # fmt: skip
_SIDE_WORDS = re.compile(r"(?<![\w-])(" + "|".join(sorted(_MIRRORED, key=len, reverse=True)) + r")(?=\W|s?\b)", re.I)
#: Phrases in which "right" is no side.
_NO_SIDE = re.compile(
    r"\bright (away|after|before|now|back|there|where)\b|\b(all|upright|straight) right\b|\bupright\b", re.I
)


@dataclass(frozen=True)
class CaptionedSpan:
    """Captions of a span of a take, with its start and end in seconds."""

    captions: tuple[str, ...]
    start: float
    end: float


@dataclass(frozen=True)
class CaptionedTake:
    """A take with its captions.

    Attributes
    ----------
    path : the file that it was read from
    trial : the performance, the same in every rig it was recorded in
    motion : Motion at 20 fps
    description : a short description by the data set's authors
    spans : human captions with times
    """

    path: str
    trial: str
    motion: Motion
    description: str
    spans: tuple[CaptionedSpan, ...]


def mirror_words(sentence: str) -> str:
    """The sentence with left and right swapped; "right" stays where it is no side ("right away")."""
    kept = [m.span() for m in _NO_SIDE.finditer(sentence)]

    def swap(match: re.Match[str]) -> str:
        if any(start <= match.start() < end for start, end in kept):
            return match[0]
        other = _MIRRORED[match[0].lower()]
        return other.capitalize() if match[0][0].isupper() else other

    return _SIDE_WORDS.sub(swap, sentence)


def real_clips(
    take: CaptionedTake, kind: FeatureKind, *, varied: bool = True, longest: float = 12.0
) -> Iterator[tuple[NDArray[np.float32], tuple[str, ...]]]:
    """Features and captions of every caption span; a short take is a further span, captioned by its description.

    Features are computed for the whole take and sliced, as for the windows of a library.

    Parameters
    ----------
    varied : bool
        Also mirrored and at other playback speeds, for training.
    longest : float
        Seconds to which a span is cropped.
    """
    motion, spans = take.motion, list(take.spans)
    if take.description and motion.duration <= longest:
        spans.append(CaptionedSpan((take.description,), 0.0, motion.duration))
    for speed, mirrored in product(_SPEEDS, (False, True)) if varied else ((1.0, False),):
        played = motion if speed == 1 else Motion(motion.joints, motion.fps * speed).resample(motion.fps)
        features = kind.compute(played.mirror() if mirrored else played)
        for span in spans:
            first = int(span.start / speed * kind.fps)
            last = int(np.ceil(min(span.end, span.start + longest, motion.duration) / speed * kind.fps))
            if last - first >= _SHORTEST:
                captions = tuple(map(mirror_words, span.captions)) if mirrored else span.captions
                yield features[first:last], captions
