"""Damaged frames of a take: found where a reader marked them or values are absurd, and filled in from those around.

Time is kept, and what is whole is left as it is. Fast movement is never absurd: a joint farther from the body than its
limbs are long, a body farther away for some frames than it could have gone and come back.
"""

from __future__ import annotations

from dataclasses import replace
from os import PathLike

import numpy as np
from numpy.typing import NDArray

from encoders.errors import UnreadableMotion
from indexer.take import Take

#: Share of damaged frames, above which a take is refused; of a handful, one is too many.
_MAX_DAMAGED, _HANDFUL = 0.1, 4

#: Sizes of the body that a joint is away from the others, and that the body is away from where it is before and after.
_APART, _AWAY = 20.0, 20.0
#: The same at the first and last frames, where nothing tells a mistake from a start elsewhere.
_FAR = 1000.0
#: Frames on both sides that tell where a body should be.
_AROUND = 5


def is_hopeless(is_damaged: NDArray[np.bool_]) -> bool:
    """Whether too many frames are damaged to fill them in, by which frames (T,) are."""
    return bool(is_damaged.sum() > max(_MAX_DAMAGED * len(is_damaged), len(is_damaged) >= _HANDFUL))


def mended(path: str | PathLike[str], take: Take) -> Take:
    """A take whose damaged frames are interpolated from whole ones, with a warning that counts them.

    Parameters
    ----------
    take : Take
        As read; NaN among a frame's positions marks it as damaged.

    Raises
    ------
    UnreadableMotion
        If more frames are damaged than can be filled in, or all are.
    """
    is_damaged = _damaged(take.positions)
    count = int(is_damaged.sum())
    if not count:
        return take
    if is_hopeless(is_damaged):
        raise UnreadableMotion(
            path,
            f"{count} of {len(is_damaged)} frames hold values that are no places of joints, the first of them frame"
            f" {int(is_damaged.argmax()) + 1}",
        )
    whole = (~is_damaged).nonzero()[0]
    damaged = is_damaged.nonzero()[0]
    after = np.searchsorted(whole, damaged).clip(1, max(len(whole) - 1, 1))
    before, after = whole[after - 1], whole[np.minimum(after, len(whole) - 1)]
    share = ((damaged - before) / np.maximum(after - before, 1)).clip(0, 1)[:, None, None]
    positions = take.positions.copy()
    positions[damaged] = positions[before] * (1 - share) + positions[after] * share
    nearest = np.arange(len(is_damaged))
    nearest[damaged] = np.where(share[:, 0, 0] < 0.5, before, after)
    rotations = take.rotations
    frames = "1 frame was" if count == 1 else f"{count} frames were"
    return replace(
        take,
        positions=positions,
        rotations=None if rotations is None else lambda: rotations()[nearest],
        warnings=(
            *take.warnings,
            f"{frames} damaged and filled in from those around, the first at frame {damaged[0] + 1}",
        ),
    )


def _damaged(positions: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Which frames (T, J, 3) are not finite, or absurd beside the others."""
    with np.errstate(invalid="ignore", over="ignore"):
        low, high = positions.min(axis=1), positions.max(axis=1)
        extent = (high - low).max(axis=-1)
        damaged: NDArray[np.bool_] = ~np.isfinite(extent)
        if damaged.all():
            return damaged
        size = float(np.median(extent[~damaged]))
        apart = np.asarray(extent > _APART * size)
        if not is_hopeless(apart):  # else that is how this skeleton is
            damaged |= apart
        middle = (low + high) / 2
    whole = (~damaged).nonzero()[0]
    away = _away(middle[whole], size)
    if not is_hopeless(away):
        damaged[whole] = away
    return damaged


def _away(middle: NDArray[np.float64], size: float) -> NDArray[np.bool_]:
    """In which frames a body of some size whose middle is known (T, 3) is where it can only be by mistake."""
    if np.abs(np.diff(middle, axis=0)).max(initial=0.0) <= _AWAY * size:
        return np.zeros(len(middle), np.bool_)
    width = min(2 * _AROUND + 1, len(middle) - 1 | 1)
    usual = np.median(np.lib.stride_tricks.sliding_window_view(middle, width, axis=0), axis=-1)
    edge = len(middle) - len(usual)
    usual = np.pad(usual, ((edge // 2, edge - edge // 2), (0, 0)), "edge")
    allowed = np.full(len(middle), _AWAY * size)
    allowed[:_AROUND] = allowed[len(middle) - _AROUND :] = _FAR * size
    away: NDArray[np.bool_] = np.abs(middle - usual).max(axis=-1) > allowed
    return away
