"""The best moments of many takes: windows of all of them name places, and each place is then looked at closely."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import lru_cache
from itertools import islice
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from encoders.protocol import Encoder
from search.moments.localisation import Moment, background_level, refine, unknown
from search.moments.one_take import coarse_windows, region_of
from search.moments.window_scores import Vectors
from search.ranking.clip_scores import ClipScore, WindowGallery, spans_in_order
from search.ranking.paging import rounds
from search.source import MotionSource

#: A clip's id and a moment of it.
Located: TypeAlias = "tuple[int, Moment]"

#: Places looked at closely in a round, and takes held for the next one: features of a take are computed once.
_ROUND, _HELD = 10, 48


def best_moments(
    bundle: Encoder,
    gallery: WindowGallery,
    source_of: Callable[[int], MotionSource],
    queries: Vectors,
    k: int,
    *,
    allowed: NDArray[np.int64] | None = None,
) -> list[Located]:
    """The first k, at most, of `rank`: the best moments of all clips.

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
    return list(islice(rank(bundle, gallery, source_of, queries, allowed=allowed), k))


def rank(
    bundle: Encoder,
    gallery: WindowGallery,
    source_of: Callable[[int], MotionSource],
    queries: Vectors,
    *,
    allowed: NDArray[np.int64] | None = None,
) -> Iterator[Located]:
    """The moments of all clips, best first within each round of places; see `best_moments`."""
    held = lru_cache(_HELD)(source_of)
    found: list[Located] = []
    for places in rounds(spans_in_order(gallery, queries[0], allowed=allowed), _ROUND):
        new = sorted(_sharpened(bundle, held, places, queries, found), key=lambda entry: -entry[1].score)
        found += new
        yield from new


def _sharpened(
    bundle: Encoder,
    source_of: Callable[[int], MotionSource],
    places: list[ClipScore],
    queries: Vectors,
    known: list[Located],
) -> list[Located]:
    """The moments at these places that overlap none of those known."""
    found: list[Located] = []
    for clip_id in dict.fromkeys(place.clip_id for place in places):
        source = source_of(clip_id)
        level = background_level(bundle, coarse_windows(bundle, source, queries), queries)
        here = [Moment(p.start or 0.0, p.end or 0.0, p.score) for p in places if p.clip_id == clip_id]
        near = refine(bundle, region_of(bundle, source), bundle.fps, queries, here, level)
        taken = [moment for clip, moment in known if clip == clip_id]
        found += [(clip_id, moment) for moment in unknown(near, taken)]
    return found
