"""A bundle that encodes no window twice, so that many sentences can be asked of one take at the price of one."""

from __future__ import annotations

from collections.abc import Collection
from typing import Any

import numpy as np
from numpy.typing import NDArray

from encoders.protocol import Encoder
from search.moments.window_scores import Vectors


class CachedBundle:
    """Answers as the bundle it is made of, and remembers the vector of every window by where it lies in memory.

    The features of a take are one array of which all windows are slices; it is held, so that no other takes its place,
    and must not be written to.
    """

    def __init__(self, bundle: Encoder) -> None:
        self._bundle = bundle
        self._known: dict[int, dict[int, Vectors]] = {}
        self._held: dict[int, Vectors] = {}

    def __getattr__(self, name: str) -> Any:
        return getattr(self._bundle, name)

    def encode_windows(self, features: Vectors, starts: NDArray[np.integer], length: int) -> Vectors:
        """See `Encoder.encode_windows`."""
        begins = features.__array_interface__["data"][0]
        self._held.setdefault(begins, features)
        known = self._known.setdefault(length, {})
        places = (begins + np.asarray(starts) * features.strides[0]).tolist()
        new = {place: start for place, start in zip(places, starts, strict=True) if place not in known}
        if new:
            vectors = self._bundle.encode_windows(features, np.array([*new.values()]), length)
            known.update(zip(new, vectors, strict=True))
        return np.array([known[place] for place in places], np.float32).reshape(-1, self._bundle.latent_size)

    def forget(self, *, but: Collection[int]) -> None:
        """Forget all windows but those of some lengths, in feature frames."""
        self._known = {length: vectors for length, vectors in self._known.items() if length in but}
