"""NumPy arrays: joint positions in SMPL order, or the 263 published features."""

from __future__ import annotations

import io
from dataclasses import replace
from os import PathLike

import numpy as np
from numpy.typing import NDArray

from encoders.errors import UnreadableMotion
from encoders.skeleton import JOINTS, PARENTS
from indexer.take import Take

FEATURES = 263
SHAPES = "(T, 22, 3), (T, 24, 3), (T, 52, 3) or (T, 263)"


def read(path: str | PathLike[str], data: bytes, *, fps: float | None = None) -> list[Take]:
    """Read a `.npy` file; of 24 or 52 joints the 22 of the body are kept, all in SMPL order.

    Raises
    ------
    UnreadableMotion
        If the array has another shape, holds objects, or is shorter than its header says.
    """
    return [take_of(path, load_array(path, data), fps)]


def take_of(path: str | PathLike[str], array: NDArray[np.float64], fps: float | None) -> Take:
    """A take of an array of joints or features.

    Raises
    ------
    UnreadableMotion
        If it has another shape.
    """
    if array.ndim == 2 and array.shape[1] == FEATURES:
        from encoders.features.humanml3d import features_to_joints

        joints = np.asarray(features_to_joints(array), np.float64)
        return replace(joints_take(joints, fps), up="y", up_is_certain=True)
    elif array.ndim == 3 and array.shape[1] in (22, 24, 52) and array.shape[2] == 3:
        joints = array[:, : len(JOINTS)]
    else:
        raise UnreadableMotion(path, f"an array of shape {array.shape} is no motion; it must be {SHAPES}")
    return joints_take(joints, fps)


def joints_take(joints: NDArray[np.float64], fps: float | None) -> Take:
    """A take of the 22 joints (T, 22, 3); its rest pose is unknown, hence zeros."""
    return Take(JOINTS, PARENTS.astype(np.int64), np.zeros((len(JOINTS), 3)), joints, fps)


def load_array(path: str | PathLike[str], data: bytes) -> NDArray[np.float64]:
    """The array of a `.npy` file as float64, checked before anything is allocated."""
    shape = _checked_shape(path, data)
    if len(shape) not in (2, 3) or shape[0] == 0:
        raise UnreadableMotion(path, f"an array of shape {shape} is no motion; it must be {SHAPES}")
    array: NDArray[np.float64] = np.load(io.BytesIO(data), allow_pickle=False).astype(np.float64)
    if not np.isfinite(array).all():
        frame = int(np.argwhere(~np.isfinite(array))[0, 0]) + 1
        raise UnreadableMotion(path, f"frame {frame} holds values that are no numbers")
    return array


def load_number(path: str | PathLike[str], data: bytes) -> float:
    """The one number of a `.npy` file."""
    shape = _checked_shape(path, data)
    if shape not in ((), (1,)):
        raise UnreadableMotion(path, f"an array of shape {shape} is no number")
    return float(np.load(io.BytesIO(data), allow_pickle=False).reshape(()))


def load_word(path: str | PathLike[str], data: bytes) -> str:
    """The one string of a `.npy` file."""
    shape = _checked_shape(path, data, kinds="U")
    if shape not in ((), (1,)):
        raise UnreadableMotion(path, f"an array of shape {shape} is no word")
    return str(np.load(io.BytesIO(data), allow_pickle=False).reshape(()))


def _checked_shape(path: str | PathLike[str], data: bytes, kinds: str = "fiu") -> tuple[int, ...]:
    """The shape a header announces, of numbers (or other kinds) that are all there."""
    stream = io.BytesIO(data)
    try:
        version = np.lib.format.read_magic(stream)
        header = np.lib.format.read_array_header_1_0 if version == (1, 0) else np.lib.format.read_array_header_2_0
        shape, _, dtype = header(stream)
    except ValueError as error:
        raise UnreadableMotion(path, f"the array's header is damaged: {error}") from None
    if dtype.hasobject or dtype.kind not in kinds:
        raise UnreadableMotion(path, f"an array of {dtype} is no motion; numbers are needed")
    need = int(np.prod([int(n) for n in shape], dtype=object)) * dtype.itemsize
    if need > len(data) - stream.tell():
        raise UnreadableMotion(path, f"the array is cut short: shape {shape} needs {need} bytes")
    return tuple(shape)
