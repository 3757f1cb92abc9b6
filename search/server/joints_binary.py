"""Joints on the wire: int16 steps from an origin behind a header of 40 bytes; see docs/serving.md."""

from __future__ import annotations

import struct

import numpy as np

from encoders.motion import Motion

MAGIC = b"MSJ1"

_HEADER = struct.Struct("<4sIIfff3fI")  # magic, frames, joints, frames a second, start, step, origin, nothing
_FINEST = 0.0002  # metres a step
_LARGEST = 32_767


def pack(motion: Motion, start: float = 0.0) -> bytes:
    """A motion as bytes, each coordinate to within half a step: 0.1 mm, coarser only where it spans over 13 m.

    Parameters
    ----------
    start : float
        Second of the clip at which the motion begins.
    """
    low, high = motion.joints.min(axis=(0, 1)), motion.joints.max(axis=(0, 1))
    origin = ((low.astype(np.float64) + high) / 2).astype(np.float32)
    step = np.float32(max(_FINEST, float((high - low).max()) / 2 / (_LARGEST - 1)))
    frames, joints, _ = motion.joints.shape
    steps = np.rint((motion.joints - origin) / step).astype("<i2")
    header = _HEADER.pack(MAGIC, frames, joints, motion.fps, start, step, *origin, 0)
    return header + bytes(steps.tobytes())


def unpack(data: bytes) -> tuple[Motion, float]:
    """What `pack` was given: the motion and where it begins."""
    magic, frames, joints, fps, start, step, *origin, _ = _HEADER.unpack_from(data)
    if magic != MAGIC:
        raise ValueError(f"begins with {magic!r}, not with {MAGIC!r}")
    steps = np.frombuffer(data, "<i2", frames * joints * 3, _HEADER.size).reshape(frames, joints, 3)
    return Motion((steps * np.float32(step) + np.array(origin, np.float32)).astype(np.float32), fps), start
