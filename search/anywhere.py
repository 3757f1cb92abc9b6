"""The best moments of many takes: windows of all of them name places, and each place is then looked at closely."""

from __future__ import annotations

from collections.abc import Callable
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from encoders.bundle import Bundle
from search.dense import Vectors
from search.evidence import Evidence, WindowGallery, best_spans
from search.moments import OVERLAP, Moment, overlap, sharpen, usual_level
from search.source import Source
from search.takes import coarse_windows, region_of

#: A clip's id and a moment of it.
Located: TypeAlias = "tuple[int, Moment]"

#: Places named by windows, at most, for each answer asked for.
_PLACES = 4


def best_moments(
    bundle: Bundle,
    gallery: WindowGallery,
    source_of: Callable[[int], Source],
    queries: Vectors,
    k: int,
    *,
    allowed: NDArray[np.int64] | None = None,
) -> list[Located]:
    """The k best moments of all clips, best first.

    Parameters
    ----------
    gallery : WindowGallery
        The windows of all clips.
    source_of : callable
        Clip id -> the clip.
    queries : float32 array (1, D)
        The unit vector of what is asked.
    allowed : sorted int64 array, optional
        The clips to choose from.
    """
    places = best_spans(gallery, queries[0], _PLACES * k, allowed=allowed)
    found: list[Located] = []
    while places and len(found) < k:  # places side by side may turn out to be one
        found += _sharpened(bundle, source_of, places[:k], queries, found)
        places = places[k:]
    return sorted(found, key=lambda entry: -entry[1].score)[:k]


def _sharpened(
    bundle: Bundle,
    source_of: Callable[[int], Source],
    places: list[Evidence],
    queries: Vectors,
    known: list[Located],
) -> list[Located]:
    """The moments at these places that overlap none of those known."""
    found: list[Located] = []
    for clip_id in dict.fromkeys(place.clip_id for place in places):
        source = source_of(clip_id)
        level = usual_level(bundle, coarse_windows(bundle, source, queries), queries)
        here = [Moment(p.start or 0.0, p.end or 0.0, p.score) for p in places if p.clip_id == clip_id]
        near = sharpen(bundle, region_of(bundle, source), bundle.fps, queries, here, level, len(here))
        taken = [moment for clip, moment in known if clip == clip_id]
        found += [(clip_id, m) for m in near if not any(overlap(m, other) > OVERLAP for other in taken)]
    return found
