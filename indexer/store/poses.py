"""Poses on disk: joints as int16 steps in compressed chunks of ten seconds, each readable alone."""

from __future__ import annotations

import sqlite3
import struct
import zlib

import numpy as np
from numpy.typing import NDArray

from encoders.errors import LibraryDamaged
from encoders.motion import FPS, Motion
from encoders.skeleton import JOINTS

#: Frames a chunk holds: ten seconds.
CHUNK = round(10 * FPS)

#: The finest step, in metres. Coarser only where a chunk spans more than 13 m.
STEP = 0.0002

_HEADER = struct.Struct("<I4d")  # frames, step, origin x, y, z
_LEVEL = 6


def pack(joints: NDArray[np.float32]) -> bytes:
    """One chunk of joints (T <= CHUNK, 22, 3) in metres as bytes, to within half a step.

    Steps are stored as differences between frames, high and low bytes apart: slow movement
    then is mostly zeros, and deflate makes it small.
    """
    exact = joints.astype(np.float64)
    low, high = exact.min(axis=(0, 1)), exact.max(axis=(0, 1))
    origin = (low + high) / 2
    step = max(STEP, float((high - low).max()) / 65_000)
    steps = np.rint((exact - origin) / step).astype(np.int16).reshape(len(joints), -1)
    change = np.diff(steps, axis=0, prepend=np.zeros_like(steps[:1]))  # wraps, and so does the sum that undoes it
    planes = np.ascontiguousarray(change, "<i2").view(np.uint8).reshape(-1, 2).T
    return _HEADER.pack(len(joints), step, *origin) + zlib.compress(planes.tobytes(), _LEVEL)


def unpack(blob: bytes) -> NDArray[np.float32]:
    """The joints (T, 22, 3) that `pack` was given.

    Raises
    ------
    LibraryDamaged
        If the bytes hold no chunk of poses.
    """
    try:
        frames, step, *origin = _HEADER.unpack_from(blob)
        size = frames * len(JOINTS) * 3 * 2
        inflate = zlib.decompressobj()
        raw = inflate.decompress(blob[_HEADER.size :], size + 1) if 0 < frames <= CHUNK else b""
        if not raw or len(raw) != size:
            raise ValueError("wrong size")
    except (struct.error, zlib.error, ValueError) as error:
        raise LibraryDamaged(
            f"stored poses are damaged ({error}); delete the library folder and index again"
        ) from error
    change = np.frombuffer(raw, np.uint8).reshape(2, -1).T.copy().view("<i2").reshape(frames, -1)
    steps = np.cumsum(change, axis=0, dtype=np.int16).reshape(frames, len(JOINTS), 3)
    return np.asarray(steps * step + np.array(origin), np.float32)


def read(db: sqlite3.Connection, clip_id: int) -> Motion:
    """The motion of a clip, whether or not its file is still there.

    Raises
    ------
    LibraryDamaged
        If there are no poses of it, or they are damaged.
    """
    rows = db.execute("SELECT data FROM poses WHERE clip_id = ? ORDER BY chunk", (clip_id,))
    joints = [unpack(data) for (data,) in rows]
    if not joints:
        raise LibraryDamaged(f"clip #{clip_id} has no stored poses; run 'motionseek check --repair'")
    return Motion(np.concatenate(joints), FPS)


def pack_all(joints: NDArray[np.float32]) -> list[bytes]:
    """A whole motion's joints (T, 22, 3) as chunks, in order."""
    return [pack(joints[first : first + CHUNK]) for first in range(0, len(joints), CHUNK)]
