"""Stitching in space: body parts of one motion on another, as rotations, so that what hangs on them comes along.

The heuristic of SINC (Athanasiou et al., ICCV 2023) and STMC: legs, heading and way come from one motion; the others
give the parts they name.
"""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

from encoders.geometry import length
from search.compose.body_parts import INDICES
from search.compose.joins import half_blend, smooth
from search.compose.rotations import Rotated, concatenated


def overlaid(
    base: Rotated, layer: Rotated, parts: Iterable[str], span: tuple[int, int], margin: int, overlap: int
) -> Rotated:
    """A base with parts of a layer laid over it, taken over and given back around the ends of a span of its frames.

    As in joins that takes `overlap` frames, more where the poses lie far apart; and never more than the margin allows.

    Parameters
    ----------
    layer : Rotated
        From `margin` frames before the span to as many after it; what lies outside the base is passed over.
    """
    first = span[0] - margin
    begin, end = max(first, 0), min(first + len(layer), len(base))
    if begin >= end:
        return base
    joints = sorted(joint for part in parts for joint in INDICES[part])
    under, over = base[begin:end], layer[begin - first : end - first]
    edges = np.clip(np.array(span) - begin, 0, end - begin - 1)
    taken = under[edges].with_joints_of(over[edges], joints, np.ones(2))
    own, other = np.split(concatenated([under[edges], taken]).joints(), 2)
    apart = length(other - own).mean(axis=-1)
    most = min(margin, (span[1] - span[0]) // 2)
    rise, fall = (max(min(half_blend(overlap, float(metres)), most), 0) for metres in apart)
    frames = np.arange(begin, end)
    share = np.minimum(_ramp(frames - span[0], rise), _ramp(span[1] - 1 - frames, fall))
    stitched = under.with_joints_of(over, joints, share)
    turns, bones = base.turns.copy(), base.bones.copy()
    turns[begin:end], bones[begin:end] = stitched.turns, stitched.bones
    return Rotated(base.root, turns, bones)


def _ramp(frames: NDArray[np.int64], half: int) -> NDArray[np.float64]:
    """Shares at frames counted from an edge, rising over `half` frames on either side of it."""
    return smooth((frames + half + 1) / (2 * half + 1))
