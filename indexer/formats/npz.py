"""NumPy archives as `motionseek export` writes them: joint positions in SMPL order, their frame rate and up axis."""

from __future__ import annotations

import io
import zipfile
import zlib
from dataclasses import replace
from os import PathLike

from encoders.errors import UnreadableMotion
from indexer.formats import npy
from indexer.take import UP_AXES, Take

#: Unpacked, an array may be so large: twelve hours of the 22 joints at 20 frames a second.
MAX_BYTES = 256 << 20
_PACKED = (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED)


def read(path: str | PathLike[str], data: bytes, *, fps: float | None = None) -> list[Take]:
    """Read a `.npz` file; nothing in it is unpickled.

    Raises
    ------
    UnreadableMotion
        If the archive is damaged, holds no `joints`, or arrays of another shape or kind.
    """
    try:
        with zipfile.ZipFile(io.BytesIO(data)) as archive:
            names = {name.removesuffix(".npy") for name in archive.namelist() if name.endswith(".npy")}
            if "joints" not in names:
                held = f"but {', '.join(sorted(names)[:8])}" if names else "nor any other"
                raise UnreadableMotion(path, f"it holds no array 'joints' of {npy.SHAPES}, {held}")
            array = npy.load_array(path, _member(path, archive, "joints.npy", MAX_BYTES))
            if fps is None and "fps" in names:
                fps = npy.load_number(path, _member(path, archive, "fps.npy", 1 << 10))
            up = npy.load_word(path, _member(path, archive, "up.npy", 1 << 10)) if "up" in names else None
    except (zipfile.BadZipFile, zlib.error, EOFError, NotImplementedError, RuntimeError, ValueError) as error:
        raise UnreadableMotion(path, f"the archive is damaged: {error}") from None
    if fps is not None and not 0 < fps < 1e5:
        raise UnreadableMotion(path, f"fps={fps:g} is no frame rate; give the true one (fps=, --fps)")
    if up is not None and up not in UP_AXES:
        raise UnreadableMotion(path, f"up={up!r} is no axis; it must be one of {', '.join(UP_AXES)}")
    take = npy.take_of(path, array, fps)
    return [take if up is None else replace(take, up=up, up_is_certain=True)]


def _member(path: str | PathLike[str], archive: zipfile.ZipFile, name: str, limit: int) -> bytes:
    """A file of the archive, unpacked; no more of it than the archive announces, and that is at most `limit` bytes."""
    info = archive.getinfo(name)
    if info.compress_type not in _PACKED:
        raise UnreadableMotion(path, f"{name} is packed in a way that NumPy does not write")
    if info.file_size > limit:
        raise UnreadableMotion(path, f"{name} is larger than {limit} bytes; cut it into takes")
    with archive.open(info) as file:
        return file.read(info.file_size)
