"""NumPy archives: joints as `motionseek export` and generators write them, or parameters of SMPL's body models."""

from __future__ import annotations

from dataclasses import replace
from os import PathLike

from encoders.errors import UnreadableMotion
from indexer.formats.numpy_files import array_layouts, body_models, smpl
from indexer.formats.numpy_files.npz_archive import NpzArchive, opened
from indexer.take import UP_AXES, Take

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
    with opened(path, data) as archive:
        spelling = smpl.spelling_of(archive.names)
        shapes = archive.shapes()
        fitting = [name for name, shape in shapes.items() if shape is not None and array_layouts.fits(shape)]
        rate = _rate(archive) if fps is None else fps
        if spelling is not None and not set(_SURE) & set(fitting):
            rest = body_models.rest_joints(archive)
            takes = [
                smpl.take_of(
                    path, spelling, lambda name: archive.array(name) if name in archive.names else None, rate, rest
                )
            ]
        else:
            takes = _joints(archive, _name_of_joints(archive, shapes, fitting), rate)
        if "up" not in archive.names:
            return takes
        up = archive.word("up")
        if up not in UP_AXES:
            raise UnreadableMotion(path, f"up={up!r} is no axis; it must be one of {', '.join(UP_AXES)}")
        return [replace(take, up=up, up_is_certain=True) for take in takes]


def _joints(archive: NpzArchive, name: str, rate: float | None) -> list[Take]:
    """The takes of an array of joints."""
    takes = array_layouts.takes_of(archive.path, archive.array(name), rate)
    if "lengths" in archive.names and len(takes) > 1:
        lengths = archive.array("lengths")
        if lengths.shape == (len(takes),) and lengths.min() > 0:
            takes = [replace(take, positions=take.positions[: int(n)]) for take, n in zip(takes, lengths, strict=True)]
    if rate is None and name == _GENERATED:
        warning = f"it states no frame rate; {_GENERATED_FPS:g} is taken (--fps gives the true one)"
        takes = [replace(take, fps=_GENERATED_FPS, warnings=(*take.warnings, warning)) for take in takes]
    return takes


def _name_of_joints(archive: NpzArchive, shapes: dict[str, tuple[int, ...] | None], fitting: list[str]) -> str:
    """The array that holds the joints."""
    known = [name for name in _JOINTS if name in fitting]
    if known or len(fitting) == 1:
        return (known or fitting)[0]
    if fitting:
        listed = ", ".join(f"{name} {shapes[name]}" for name in fitting[:8])
        raise UnreadableMotion(
            archive.path, f"several arrays may be its joints ({listed}); name the right one 'joints'"
        )
    meant = next((name for name in _JOINTS if name in shapes), "")
    if meant or len(shapes) == 1:
        return meant or next(iter(shapes))  # it cannot be read, and the reader of arrays says why
    held = f"but {', '.join(sorted(shapes)[:8])}" if shapes else "nor any other array"
    raise UnreadableMotion(
        archive.path, f"it holds no array of {array_layouts.SHAPES}, nor poses and trans of SMPL, {held}"
    )


def _rate(archive: NpzArchive) -> float | None:
    """The frame rate that an archive states."""
    name = next((name for name in _RATES if name in archive.names), None)
    if name is None:
        return None
    fps = archive.number(name)
    if not 0 < fps < 1e5:
        raise UnreadableMotion(archive.path, f"{name}={fps:g} is no frame rate; give the true one (fps=, --fps)")
    return fps
