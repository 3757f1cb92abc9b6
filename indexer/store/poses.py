"""Poses on disk: joints as whole steps in compressed chunks of ten seconds, each readable alone."""

from __future__ import annotations

import sqlite3
import struct
import zlib

import numpy as np
from numpy.typing import DTypeLike, NDArray

from encoders.errors import LibraryDamaged
from encoders.motion import FPS, Motion
from encoders.skeleton import JOINTS

#: Frames a chunk holds: ten seconds.
CHUNK = round(10 * FPS)

#: The step, in metres. Libraries of earlier versions have coarser ones where a chunk spans more than 13 m.
STEP = 0.0002

_HEADER = struct.Struct("<HH4d")  # frames, kind, step, origin x, y, z
_LEVEL = 6

#: The kinds of chunk: steps of two bytes; of four, where it spans more than 13 m; the bits of float32, where it spans
#: more than 800 km. One absurd frame thus makes a chunk longer, and no other frame less exact.
_NARROW, _WIDE, _BITS = range(3)
_TYPES: dict[int, DTypeLike] = {_NARROW: np.int16, _WIDE: np.int32, _BITS: np.int32}
_SPANS = {_NARROW: 65_000 * STEP, _WIDE: 4e9 * STEP}


def pack(joints: NDArray[np.float32]) -> bytes:
    """One chunk of joints (T <= CHUNK, 22, 3) in metres as bytes, to within half a step.

    Steps are stored as differences between frames, each byte of them apart: slow movement
    then is mostly zeros, and deflate makes it small.
    """
    exact = joints.astype(np.float64)
    low, high = exact.min(axis=(0, 1)), exact.max(axis=(0, 1))
    origin, span = (low + high) / 2, float((high - low).max())
    kind = next((kind for kind, largest in _SPANS.items() if span <= largest), _BITS)
    steps = (
        np.ascontiguousarray(joints, np.float32).view(np.int32) if kind == _BITS else np.rint((exact - origin) / STEP)
    )
    steps = steps.astype(_TYPES[kind]).reshape(len(joints), -1)
    change = np.diff(steps, axis=0, prepend=np.zeros_like(steps[:1]))  # wraps, and so does the sum that undoes it
    little = np.ascontiguousarray(change, change.dtype.newbyteorder("<"))
    planes = little.view(np.uint8).reshape(-1, change.itemsize).T
    return _HEADER.pack(len(joints), kind, STEP, *origin) + zlib.compress(planes.tobytes(), _LEVEL)


def unpack(blob: bytes) -> NDArray[np.float32]:
    """The joints (T, 22, 3) that `pack` was given.

    Raises
    ------
    LibraryDamaged
        If the bytes hold no chunk of poses.
    """
    try:
        frames, kind, step, *origin = _HEADER.unpack_from(blob)
        if not 0 < frames <= CHUNK or kind not in _TYPES:
            raise ValueError("wrong header")
        stored = np.dtype(_TYPES[kind])
        size = frames * len(JOINTS) * 3 * stored.itemsize
        raw = zlib.decompressobj().decompress(blob[_HEADER.size :], size + 1)
        if len(raw) != size:
            raise ValueError("wrong size")
    except (struct.error, zlib.error, ValueError) as error:
        raise LibraryDamaged(
            f"stored poses are damaged ({error}); motionseek check --repair reads the file again"
        ) from error
    planes = np.frombuffer(raw, np.uint8).reshape(stored.itemsize, -1)
    change = planes.T.copy().view(stored.newbyteorder("<")).reshape(frames, -1)
    steps = np.cumsum(change, axis=0, dtype=stored).reshape(frames, len(JOINTS), 3)
    return steps.view(np.float32) if kind == _BITS else np.asarray(steps * step + np.array(origin), np.float32)


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
        raise LibraryDamaged(f"clip #{clip_id} has no stored poses; motionseek check --repair reads its file again")
    return Motion(np.concatenate(joints), FPS)


def pack_all(joints: NDArray[np.float32]) -> list[bytes]:
    """A whole motion's joints (T, 22, 3) as chunks, in order."""
    return [pack(joints[first : first + CHUNK]) for first in range(0, len(joints), CHUNK)]
