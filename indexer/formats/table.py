"""Readers: a file becomes a Take. The content decides which reader, then the ending.

Every reader is a module with a `DESCRIPTION` and `read(path, data, *, fps=None) -> Take`.
"""

from __future__ import annotations

from os import PathLike, fspath
from pathlib import Path
from types import ModuleType

import numpy as np

from encoders.errors import UnreadableMotion
from indexer.formats import amc, bvh, npy, npz
from indexer.take import Take

_READERS: dict[str, ModuleType] = {".bvh": bvh, ".amc": amc, ".npy": npy, ".npz": npz}

#: Endings that can be read, and what they are.
READABLE: dict[str, str] = {ending: reader.DESCRIPTION for ending, reader in _READERS.items()}

MAX_BYTES = 4 << 30

#: How files begin that are known but not read.
_FOREIGN = {
    b"kaydara fbx binary": "FBX",
    b"; fbx": "FBX",
    b"gltf": "glTF",
    b"#usda": "USD",
    b"pxr-usdc": "USD",
}
_FOREIGN_ENDINGS = {
    ".fbx": "FBX", ".glb": "glTF", ".gltf": "glTF", ".c3d": "C3D", ".dae": "Collada", ".usd": "USD", ".usda": "USD",
    ".trc": "TRC", ".vmd": "VMD", ".vrma": "VRMA", ".pkl": "pickle", ".pt": "PyTorch",
    ".blend": "Blender", ".csv": "CSV", ".tak": "Motive TAK", ".zip": "ZIP",
}  # fmt: skip
#: Those that programs for animation open, and write again as BVH.
_SCENES = frozenset({"FBX", "glTF", "USD", "Collada", "C3D", "TRC", "Blender"})


@np.errstate(over="ignore", invalid="ignore")  # absurd values end as places that are no numbers, which are refused
def read_take(path: str | PathLike[str], *, fps: float | None = None) -> Take:
    """Read a motion file.

    Parameters
    ----------
    path : path
        The file; for AMC its skeleton lies beside it.
    fps : float, optional
        Its true frame rate, where it says none or a wrong one.

    Raises
    ------
    UnreadableMotion
        With the reason: no such file, no kind that can be read, damaged, no frames, values that are no numbers.
    """
    path = Path(fspath(path))
    if fps is not None and not 0 < fps < 1e5:
        raise UnreadableMotion(path, f"fps={fps:g} is no frame rate")
    data = _load(path)
    reader = _reader(path, data)
    take: Take = reader.read(path, data, fps=fps)
    return take


def _load(path: Path) -> bytes:
    try:
        if path.is_dir():
            raise UnreadableMotion(path, "this is a folder, not a file")
        if path.exists() and not path.is_file():
            raise UnreadableMotion(path, "this is no regular file")
        if path.stat().st_size > MAX_BYTES:
            raise UnreadableMotion(path, f"the file is larger than {MAX_BYTES >> 30} GB; cut it into takes")
        data = path.read_bytes()
    except (OSError, ValueError) as error:
        raise UnreadableMotion(path, getattr(error, "strerror", None) or str(error)) from None
    if not data.strip():
        raise UnreadableMotion(path, "the file is empty")
    return data


def _reader(path: Path, data: bytes) -> ModuleType:
    """The reader for a file, by how it begins, else by its ending."""
    start = data[:4096].removeprefix(b"\xef\xbb\xbf").lstrip().lower()
    if start.startswith(b"hierarchy"):
        return bvh
    if data.startswith(b"\x93NUMPY"):
        return npy
    if data.startswith(b"PK") and path.suffix.lower() == ".npz":
        return npz
    kind = next((kind for magic, kind in _FOREIGN.items() if start.startswith(magic)), None)
    if kind is None and b"\0" not in start:
        if b":bonedata" in data[:65536].lower():
            raise UnreadableMotion(path, "this is a skeleton without motion; read the .amc files that belong to it")
        if b":fully-specified" in start or b":degrees" in start or b":radians" in start:
            return amc
        if path.suffix.lower() in (".bvh", ".amc"):
            return _READERS[path.suffix.lower()]
    kind = kind or _FOREIGN_ENDINGS.get(path.suffix.lower())
    if kind in _SCENES:
        raise UnreadableMotion(path, f"{kind} cannot be read; export it as BVH, as Blender and MotionBuilder do")
    raise UnreadableMotion(path, f"{kind or 'this kind of file'} cannot be read; what can be: {', '.join(READABLE)}")
