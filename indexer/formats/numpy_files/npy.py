"""NumPy arrays: joint positions in an order that `array_layouts` knows, or published features."""

from __future__ import annotations

import io
from os import PathLike
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from encoders.errors import UnreadableMotion
from indexer.formats.numpy_files import array_layouts, smpl
from indexer.take import Take

#: So many numbers an array may hold (256 MB once they are float64): seven hours of 22 joints at 20 frames a second.
MAX_NUMBERS = 1 << 25
#: An array's header is at most so long, and needs no more than this to be read.
HEADER_BYTES = 16_384

#: What is said of pickled arrays; where a generator has saved a dictionary so, how to get at the array in it.
_PICKLED = "an array of objects is pickled, which is never opened, for a pickle can run any program"
_SAVE = "; if you trust it: np.save('motion.npy', np.load('{name}', allow_pickle=True).item()['motion'])"


class Header(NamedTuple):
    """What the header of an array says: shape and type of its numbers, their order, and where they begin."""

    shape: tuple[int, ...]
    is_fortran: bool
    dtype: np.dtype[Any]
    start: int


def read(path: str | PathLike[str], data: bytes, *, fps: float | None = None) -> list[Take]:
    """Read a `.npy` file.

    Raises
    ------
    UnreadableMotion
        If its shape is none that `array_layouts` knows, if it is pickled, damaged, or shorter than its header says.
    """
    array = load_array(path, data)
    if array.ndim == 2 and array.shape[1] == smpl.MOTION_X_SIZE:
        return [smpl.take_of_motion_x(path, array, fps)]
    return array_layouts.takes_of(path, array, fps)


def load_array(path: str | PathLike[str], data: bytes) -> NDArray[Any]:
    """The numbers of a `.npy` file as they are stored, all finite; checked before anything is allocated.

    Raises
    ------
    UnreadableMotion
        If it holds anything else, fewer or more than `MAX_NUMBERS`.
    """
    array = _array(path, data, "fiu")
    if array.dtype.kind == "f":
        for start in range(0, len(array) if array.ndim else 0, 65_536):
            finite = np.isfinite(array[start : start + 65_536])
            if not finite.all():
                frame = start + int(np.argwhere(~finite)[0, 0]) + 1
                raise UnreadableMotion(path, f"frame {frame} holds values that are no numbers")
    return array


def load_number(path: str | PathLike[str], data: bytes) -> float:
    """The one number of a `.npy` file."""
    array = _array(path, data, "fiu")
    if array.size != 1:
        raise UnreadableMotion(path, f"an array of shape {array.shape} is no number")
    return float(array.reshape(()))


def load_word(path: str | PathLike[str], data: bytes) -> str:
    """The one word of a `.npy` file."""
    array = _array(path, data, "U")
    if array.size != 1:
        raise UnreadableMotion(path, f"an array of shape {array.shape} is no word")
    return str(array.reshape(()))


def header_of(path: str | PathLike[str], start: bytes) -> Header:
    """The header of an array, given at least its first `HEADER_BYTES`.

    Raises
    ------
    UnreadableMotion
        If it is damaged.
    """
    stream = io.BytesIO(start)
    try:
        version = np.lib.format.read_magic(stream)
        read_header = np.lib.format.read_array_header_1_0 if version == (1, 0) else np.lib.format.read_array_header_2_0
        shape, is_fortran, dtype = read_header(stream)
    except Exception as error:  # NumPy evaluates the header as Python's tokenizer, parser and its own checks see fit
        raise UnreadableMotion(path, f"the array's header is damaged: {str(error).splitlines()[0][:200]}") from None
    if not all(type(n) is int and n >= 0 for n in shape):
        raise UnreadableMotion(path, f"the array's header is damaged: {shape} is no shape")
    return Header(tuple(shape), is_fortran, dtype, stream.tell())


def _array(path: str | PathLike[str], data: bytes, kinds: str) -> NDArray[Any]:
    """The array of a `.npy` file, as a view of its bytes, of one of some kinds of values."""
    shape, is_fortran, dtype, start = header_of(path, data)
    if dtype.hasobject:
        name = Path(path).name
        raise UnreadableMotion(path, _PICKLED + (_SAVE.format(name=name) if name.lower().endswith(".npy") else ""))
    if dtype.kind not in kinds or not dtype.itemsize:
        raise UnreadableMotion(path, f"an array of {dtype} is no motion; numbers are needed")
    count = 1
    for n in shape:
        count *= n
    if count > MAX_NUMBERS:
        raise UnreadableMotion(path, f"shape {shape} is more than {MAX_NUMBERS:,} numbers; cut it into takes")
    if count * dtype.itemsize > len(data) - start:
        raise UnreadableMotion(path, f"the array is cut short: shape {shape} needs {count * dtype.itemsize} bytes")
    array = np.frombuffer(data, dtype, count, start) if count else np.empty(0, dtype)
    return array.reshape(shape, order="F" if is_fortran else "C")
