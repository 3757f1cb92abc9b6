"""A motion, or a cut of it, as a file: in the rig of its source, of another file, or on the 22 joints."""

from __future__ import annotations

import os
import warnings
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import IO

import numpy as np

from encoders.arguments import checked_flag, checked_path
from encoders.errors import ArgumentError, MotionSeekWarning, QueryError
from encoders.motion import FPS, Motion
from indexer.formats.opening import read_bytes
from indexer.formats.reading import is_of_format, split_name
from indexer.part_names import with_part
from search.export import bvh_writer, glb_writer
from search.export.bvh_cut import cut_lines
from search.export.onto_rig import onto_rig
from search.export.posed_rig import posed_rig
from search.export.replacing import replacing
from search.export.rig_motion import RigMotion
from search.export.source_rig import SourceRig
from search.source import MotionSource

#: Frame rates that can be written.
RATES = (1.0, 1000.0)


@dataclass(frozen=True)
class WriteOptions:
    """How a motion is written.

    Attributes
    ----------
    fps : float or None
        Frames a second; None for those of what is written.
    in_place : bool
        Without the way the hips travel over the floor.
    rig : Path or None
        A file on whose skeleton a .bvh is written.
    """

    fps: float | None = None
    in_place: bool = False
    rig: Path | None = None


def write_cut(
    source: MotionSource,
    out: Path,
    start: float | None = None,
    end: float | None = None,
    *,
    fps: float | None = None,
    in_place: bool = False,
    rig: Path | None = None,
) -> tuple[int, float]:
    """Write a motion, or its cut from `start` to `end` in seconds, in the format that the ending of `out` names.

    A .bvh keeps rig and frame rate of the source where that has a rig with rotations; a cut of a BVH file is its own
    lines. A source that is gone or has changed since it was indexed is written from the library's poses, with a
    `MotionSeekWarning`.

    Parameters
    ----------
    fps : float, optional
        Frames a second of what is written; else those of the source's rig, or 20. A .npy has always 20.
    in_place : bool
        Leave out the way that the hips travel over the floor.
    rig : Path, optional
        A file on whose skeleton a .bvh is written, instead of that of the source.

    Returns
    -------
    frames : int
    fps : float
        Of what was written.

    Raises
    ------
    QueryError
        If the cut lies outside the motion, the ending names no format that can be written or none that keeps `fps` or
        `rig`, or `out` is the source.
    """
    if source.file is not None and os.path.exists(out) and os.path.exists(source.file) and out.samefile(source.file):
        raise QueryError(f"{out} is the clip itself; name another file, its source would be lost")
    motion = source.cut(start, end)
    writer = WRITERS.get(out.suffix.lower())
    if writer is None:
        raise QueryError(f"{out}: can write {', '.join(WRITERS)}")
    stale = source.stale()
    if stale:
        warnings.warn(f"{source.path} {stale}; the poses in the library are written", MotionSeekWarning, stacklevel=2)
    options = WriteOptions(fps, in_place, rig)
    if rig is not None and writer is not _write_bvh:
        raise QueryError(f"{out}: only a .bvh is written on the rig of another file")
    if fps not in (None, FPS) and writer is _write_npy:
        raise QueryError(f"{out}: a .npy keeps no frame rate and is read at {FPS:g}; write a .npz, which keeps {fps:g}")
    if writer is _write_bvh and rig is None and not stale and source.file is not None:
        path = Path(with_part(str(source.file), source.part))
        span = max(start or 0.0, source.start), source.end if end is None else min(end, source.end)
        frames = _in_source_rig(source, path, out, span, options)
        if frames is not None:
            return frames
    with replacing(out) as file:
        return writer(file, motion, options)


def _in_source_rig(
    source: MotionSource, path: Path, out: Path, span: tuple[float, float], options: WriteOptions
) -> tuple[int, float] | None:
    """Write a cut of a file in the file's own rig; None where it has none."""
    rig = SourceRig.of(path, source.reading, source.duration)
    first, count = rig.span(*span, source.duration)
    file, _ = split_name(path)
    if options == WriteOptions() and rig.is_only and not rig.take.warnings and is_of_format(file, ".bvh"):
        text = cut_lines(read_bytes(file), len(rig.take.positions), first, count, rig.fps)
        if text is not None:
            with replacing(out) as written:
                written.write(text)
            return count, rig.fps
    motion = rig.motion(first, count)
    if motion is None:
        return None
    motion = rig.in_place(motion, first) if options.in_place else motion
    motion = motion.resampled(options.fps or motion.fps)
    with replacing(out) as written:
        bvh_writer.write_rig(written, motion)
    return len(motion), motion.fps


def _write_bvh(file: IO[bytes], motion: Motion, options: WriteOptions) -> tuple[int, float]:
    if options.rig is None:
        rig = _posed(motion, options).scaled(bvh_writer.CENTIMETRES)
    else:
        rig = onto_rig(_placed(motion, options), options.rig)
        rig = rig.resampled(options.fps or rig.fps)
    bvh_writer.write_rig(file, rig)
    return len(rig), rig.fps


def _write_glb(file: IO[bytes], motion: Motion, options: WriteOptions) -> tuple[int, float]:
    rig = _posed(motion, options)
    glb_writer.write(file, rig)
    return len(rig), rig.fps


def _write_npz(file: IO[bytes], motion: Motion, options: WriteOptions) -> tuple[int, float]:
    motion = _resampled(_placed(motion, options), options)
    np.savez_compressed(file, joints=motion.joints, fps=np.float64(motion.fps), up=np.array("y"))
    return len(motion), motion.fps


def _write_npy(file: IO[bytes], motion: Motion, options: WriteOptions) -> tuple[int, float]:
    motion = _resampled(_placed(motion, options), replace(options, fps=FPS))  # at which it is read
    np.save(file, motion.joints)
    return len(motion), motion.fps


#: Ending -> what writes it.
WRITERS: dict[str, Callable[[IO[bytes], Motion, WriteOptions], tuple[int, float]]] = {
    ".bvh": _write_bvh,
    ".npz": _write_npz,
    ".npy": _write_npy,
    ".glb": _write_glb,
}


def _placed(motion: Motion, options: WriteOptions) -> Motion:
    """The motion, in place where that is wanted."""
    if not options.in_place:
        return motion
    way = motion.joints[:, :1] - motion.joints[:1, :1]
    return Motion(motion.joints - way * np.array([1, 0, 1], np.float32), motion.fps)


def _posed(motion: Motion, options: WriteOptions) -> RigMotion:
    """The motion on the 22 joints, as it is wanted."""
    rig = posed_rig(_placed(motion, options))
    return rig.resampled(options.fps or rig.fps)


def _resampled(motion: Motion, options: WriteOptions) -> Motion:
    """The motion at the wanted rate, bones as long as before."""
    if options.fps is None or options.fps == motion.fps:
        return motion
    rig = posed_rig(motion).resampled(options.fps)
    return Motion(rig.positions[:, : motion.joints.shape[1]].astype(np.float32), options.fps)


def writable(out: str | os.PathLike[str], overwrite: bool) -> Path:
    """The path of a file to write.

    Raises
    ------
    ArgumentError
        If it is no path, its folder does not exist, or it exists and is not to be overwritten.
    """
    path, overwrite = checked_path("out", out), checked_flag("overwrite", overwrite)
    if not os.path.isdir(path.absolute().parent):
        raise ArgumentError(f"out={str(path)!r}: no folder {path.absolute().parent}; create it first")
    if os.path.isdir(path):
        raise ArgumentError(f"out={str(path)!r} is a folder; name a file in it")
    if os.path.exists(path) and not overwrite:
        raise ArgumentError(f"{path} exists; overwrite it with overwrite=True")
    return path
