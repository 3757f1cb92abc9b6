"""Stitching in space: body parts of one motion on another, as rotations, so that what hangs on them comes along.

The heuristic of SINC (Athanasiou et al., ICCV 2023) and STMC: legs, heading and way come from one motion; the others
give the parts they name.
"""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from search.compose.body_parts import INDICES
from search.compose.joins import smooth
from search.compose.rotations import Rotated


def overlaid(base: Rotated, layer: Rotated, parts: Iterable[str], first: int, ramp: int) -> Rotated:
    """A base with parts of a layer laid over it from frame `first` on, taken over and given back in `ramp` frames.

    Parameters
    ----------
    layer : Rotated
        Its frames are those of the base from `first` on; those outside the base are passed over.
    """
    begin, end = max(first, 0), min(first + len(layer), len(base))
    if begin >= end:
        return base
    inside = layer[begin - first : end - first]
    joints = sorted(joint for part in parts for joint in INDICES[part])
    frames = np.arange(begin, end)
    share = np.minimum(smooth((frames - first + 1) / (ramp + 1)), smooth((first + len(layer) - frames) / (ramp + 1)))
    stitched = base[begin:end].with_joints_of(inside, joints, share)
    turns, bones = base.turns.copy(), base.bones.copy()
    turns[begin:end], bones[begin:end] = stitched.turns, stitched.bones
    return Rotated(base.root, turns, bones)
