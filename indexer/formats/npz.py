"""NumPy archives: joints as `motionseek export` and generators write them, or parameters of SMPL's body models."""

from __future__ import annotations

import io
import zipfile
import zlib
from dataclasses import replace
from os import PathLike
from typing import Any

from numpy.typing import NDArray

from encoders.errors import UnreadableMotion
from indexer.formats import array_layouts, npy, smpl
from indexer.take import UP_AXES, Take

#: Unpacked, an array may be so large.
MAX_BYTES = 256 << 20
#: Arrays of an archive that are looked at.
_MAX_ARRAYS = 256
_PACKED = (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED)

#: Names that arrays of joints go by, the likeliest first, and names of frame rates.
_JOINTS = (
    "joints", "posed_joints", "joints3d", "joints_3d", "joint_positions", "positions", "keypoints3d", "keypoints_3d",
    "xyz", "motion", "motions", "features", "arr_0",
)  # fmt: skip
_RATES = ("fps", "mocap_framerate", "mocap_frame_rate", "framerate", "frame_rate")
#: Names that mean joints even beside parameters; of the latter the joints would only be computed again.
_SURE = _JOINTS[:5]
#: Generators' results under a name of their own, at the rate of the models that write them.
_GENERATED, _GENERATED_FPS = "posed_joints", 30.0


def read(path: str | PathLike[str], data: bytes, *, fps: float | None = None) -> list[Take]:
    """Read a `.npz` file; nothing in it is unpickled.

    Raises
    ------
    UnreadableMotion
        If the archive is damaged, or holds neither joints of a known layout nor parameters of SMPL, or several arrays
        that may be joints.
    """
    try:
        with zipfile.ZipFile(io.BytesIO(data)) as archive:
            return _Archive(path, archive).takes(fps)
    except (zipfile.BadZipFile, zlib.error, EOFError, NotImplementedError, RuntimeError, ValueError) as error:
        raise UnreadableMotion(path, f"the archive is damaged: {error}") from None


class _Archive:
    """An archive of arrays that is open."""

    def __init__(self, path: str | PathLike[str], archive: zipfile.ZipFile) -> None:
        self.path, self.archive = path, archive
        infos = [info for info in archive.infolist() if info.filename.endswith(".npy")][:_MAX_ARRAYS]
        self.infos = {info.filename.removesuffix(".npy"): info for info in infos}

    def takes(self, fps: float | None) -> list[Take]:
        """What the archive holds: joints, else parameters."""
        spelling = smpl.spelling_of(set(self.infos))
        shapes = {name: self.shape(name) for name in self.infos}
        fitting = [name for name, shape in shapes.items() if shape is not None and array_layouts.fits(shape)]
        rate = self.rate() if fps is None else fps
        if spelling is not None and not set(_SURE) & set(fitting):
            takes = [smpl.take_of(self.path, spelling, self.array, rate)]
        else:
            takes = self.joints(self.name_of_joints(shapes, fitting), rate)
        up = self.up()
        return takes if up is None else [replace(take, up=up, up_is_certain=True) for take in takes]

    def joints(self, name: str, rate: float | None) -> list[Take]:
        """The takes of an array of joints."""
        takes = array_layouts.takes_of(self.path, self.needed(name), rate)
        lengths = self.array("lengths") if "lengths" in self.infos and len(takes) > 1 else None
        if lengths is not None and lengths.shape == (len(takes),) and lengths.min() > 0:
            takes = [replace(take, positions=take.positions[: int(n)]) for take, n in zip(takes, lengths, strict=True)]
        if rate is None and name == _GENERATED:
            warning = f"it states no frame rate; {_GENERATED_FPS:g} is taken (--fps gives the true one)"
            takes = [replace(take, fps=_GENERATED_FPS, warnings=(*take.warnings, warning)) for take in takes]
        return takes

    def name_of_joints(self, shapes: dict[str, tuple[int, ...] | None], fitting: list[str]) -> str:
        """The array that holds the joints."""
        known = [name for name in _JOINTS if name in fitting]
        if known or len(fitting) == 1:
            return (known or fitting)[0]
        if fitting:
            listed = ", ".join(f"{name} {shapes[name]}" for name in fitting[:8])
            raise UnreadableMotion(
                self.path, f"several arrays may be its joints ({listed}); name the right one 'joints'"
            )
        meant = next((name for name in _JOINTS if name in shapes), next(iter(shapes), None))
        if meant is not None and (meant in _JOINTS or len(shapes) == 1):
            self.needed(meant)  # says why it cannot be read
            return meant
        held = f"but {', '.join(sorted(shapes)[:8])}" if shapes else "nor any other array"
        raise UnreadableMotion(
            self.path,
            f"it holds no array of {array_layouts.SHAPES}, nor poses and trans of SMPL, {held}",
        )

    def rate(self) -> float | None:
        """The frame rate that the archive states."""
        name = next((name for name in _RATES if name in self.infos), None)
        if name is None:
            return None
        fps = npy.load_number(self.path, self.member(name, 1 << 10))
        if not 0 < fps < 1e5:
            raise UnreadableMotion(self.path, f"{name}={fps:g} is no frame rate; give the true one (fps=, --fps)")
        return fps

    def up(self) -> str | None:
        """The axis that the archive states is up."""
        if "up" not in self.infos:
            return None
        up = npy.load_word(self.path, self.member("up", 1 << 10))
        if up not in UP_AXES:
            raise UnreadableMotion(self.path, f"up={up!r} is no axis; it must be one of {', '.join(UP_AXES)}")
        return up

    def array(self, name: str) -> NDArray[Any] | None:
        """An array of numbers by name, None where there is none."""
        return self.needed(name) if name in self.infos else None

    def needed(self, name: str) -> NDArray[Any]:
        """An array of numbers by name."""
        return npy.load_array(self.path, self.member(name, MAX_BYTES))

    def shape(self, name: str) -> tuple[int, ...] | None:
        """The shape of an array of numbers; None of anything else."""
        info = self.infos[name]
        if info.compress_type not in _PACKED:
            return None
        with self.archive.open(info) as file:
            start = file.read(npy.HEADER_BYTES)
        try:
            header = npy.header_of(self.path, start)
        except UnreadableMotion:
            return None
        return header.shape if header.dtype.kind in "fiu" else None

    def member(self, name: str, limit: int) -> bytes:
        """An array's file, unpacked; no more of it than the archive announces, and that is at most `limit` bytes."""
        info = self.infos[name]
        if info.compress_type not in _PACKED:
            raise UnreadableMotion(self.path, f"{info.filename} is packed in a way that NumPy does not write")
        if info.file_size > limit:
            raise UnreadableMotion(self.path, f"{info.filename} is larger than {limit} bytes; cut it into takes")
        with self.archive.open(info) as file:
            return file.read(info.file_size)
