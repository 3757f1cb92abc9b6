"""The arrays that a bundle's scores are calibrated with, out of a file that somebody else may have crafted."""

from __future__ import annotations

import zipfile
from math import prod
from pathlib import Path
from typing import IO, Any

import numpy as np
from numpy.lib import format as npy
from numpy.typing import NDArray

from encoders.errors import BundleError

#: Bytes of all arrays together, and arrays.
LARGEST, MOST = 256 << 20, 256


def read_arrays(path: Path) -> dict[str, NDArray[Any]]:
    """The arrays of numbers and text in an `.npz`; their sizes are checked before anything is allocated.

    Raises
    ------
    BundleError
        If it is damaged, too large, or holds anything but arrays of numbers and text.
    """
    try:
        with zipfile.ZipFile(path) as archive:
            members = archive.infolist()
            if len(members) > MOST or sum(member.file_size for member in members) > LARGEST:
                raise ValueError(f"more than {MOST} arrays or {LARGEST >> 20} MB")
            for member in members:
                with archive.open(member) as file:
                    _check_header(file, member.file_size)
        with np.load(path, allow_pickle=False) as arrays:
            return dict(arrays.items())
    except (
        OSError,
        ValueError,
        KeyError,
        TypeError,
        MemoryError,
        EOFError,
        zipfile.BadZipFile,
        NotImplementedError,
    ) as error:
        raise BundleError(f"{path}: cannot be read ({error})") from error


def _check_header(file: IO[bytes], size: int) -> None:
    version = npy.read_magic(file)
    read = npy.read_array_header_1_0 if version == (1, 0) else npy.read_array_header_2_0
    shape, _, kind = read(file)
    if kind.kind not in "fiubU" or prod(shape) * kind.itemsize > size - file.tell():
        raise ValueError("an array of neither numbers nor text, or of more than are there")
