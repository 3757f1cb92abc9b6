"""The arrays that a bundle's scores are calibrated with, out of a file that somebody else may have crafted."""

from __future__ import annotations

import json
import os
import tempfile
import zipfile
from collections.abc import Mapping
from math import prod
from pathlib import Path
from typing import IO, Any

import numpy as np
from numpy.lib import format as npy
from numpy.typing import NDArray

from encoders.bundle.manifest import CALIBRATION, MANIFEST, digest, read_manifest
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


def add_calibration(folder: Path, arrays: Mapping[str, NDArray[Any]]) -> None:
    """Calibrate the bundle in a folder anew; whenever this ends early, it is a bundle, with the old one or with none.

    Raises
    ------
    BundleError
        If it is no bundle.
    """
    values = dict(read_manifest(folder).values)
    files = {name: sha256 for name, sha256 in values["files"].items() if name != CALIBRATION}
    _write_manifest(folder, values | {"files": files})
    with tempfile.TemporaryDirectory(dir=folder, prefix=".") as temporary:
        new = Path(temporary) / CALIBRATION
        np.savez_compressed(new, **arrays)  # type: ignore[arg-type]
        os.replace(new, folder / CALIBRATION)
    _write_manifest(folder, values | {"files": files | {CALIBRATION: digest(folder / CALIBRATION)}})


def _write_manifest(folder: Path, values: Mapping[str, Any]) -> None:
    with tempfile.TemporaryDirectory(dir=folder, prefix=".") as temporary:
        new = Path(temporary) / MANIFEST
        new.write_text(json.dumps(values, indent=2, sort_keys=True) + "\n", "utf-8")
        os.replace(new, folder / MANIFEST)


def _check_header(file: IO[bytes], size: int) -> None:
    version = npy.read_magic(file)
    read = npy.read_array_header_1_0 if version == (1, 0) else npy.read_array_header_2_0
    shape, _, kind = read(file)
    if kind.kind not in "fiubU" or prod(shape) * kind.itemsize > size - file.tell():
        raise ValueError("an array of neither numbers nor text, or of more than are there")
