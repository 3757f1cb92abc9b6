"""References: what a path, a name, a number, a clip, a hit, a motion or an array means."""

from __future__ import annotations

from dataclasses import replace
from difflib import get_close_matches
from os import PathLike, fspath
from os.path import abspath, exists, isdir
from pathlib import Path
from typing import Any, TypeAlias
from unicodedata import normalize

import numpy as np
from numpy.typing import NDArray

from encoders.arguments import checked_path
from encoders.errors import ArgumentError, QueryError, UnknownClip, UnreadableMotion
from encoders.motion import Motion
from indexer.formats.opening import is_file
from indexer.formats.reading import split_name
from indexer.part_names import splits, with_part
from indexer.store.clips import Clip
from indexer.store.stored_library import StoredLibrary
from search.hits import Hit
from search.source import MotionSource

#: A file; a clip of the library by path, name or "#number"; a clip, a hit, a motion, or joints (T, 22, 3).
Ref: TypeAlias = "str | PathLike[str] | Clip | Hit | Motion | NDArray[Any] | MotionSource"

#: Clips whose names are compared with one that no clip has.
_NAMES_COMPARED = 5000
#: Clips that an error suggests, at most.
_SUGGESTED = 3


def source_of(
    ref: Ref, library: StoredLibrary | None = None, *, fps: float | None = None, up: str | None = None
) -> MotionSource:
    """The motion that a reference means; of a hit, the whole clip it is from.

    Parameters
    ----------
    fps : float, optional
        The true frame rate of a file, a clip's file or an array.
    up : str, optional
        The axis that is up in it, one of `UP_AXES`.

    Raises
    ------
    UnreadableMotion
        If a file cannot be read.
    UnknownClip
        If there is no such clip.
    ArgumentError
        If it is nothing that can be meant, the frame rate makes no sense, or an axis is given for a `Motion`.
    """
    if isinstance(ref, (str, PathLike)):
        checked_path("ref", ref)
        return find_source(ref, library, fps=fps, up=up)
    if isinstance(ref, Clip):
        return _source_of_clip(ref.id, ref.path, ref.file, library, fps, up)
    if isinstance(ref, Hit):
        if ref.clip_id < 0 and ref.file is None and ref.read is not None:
            return MotionSource.of_motion(_upright(ref.read(), up), ref.path)
        return _source_of_clip(ref.clip_id, ref.path, ref.file, library, fps, up)
    if isinstance(ref, Motion):
        motion = _upright(ref, up)
        return MotionSource.of_motion(motion) if fps in (None, ref.fps) else MotionSource.of_array(motion, fps)
    if isinstance(ref, np.ndarray):
        return MotionSource.of_array(ref, fps, up)
    if isinstance(ref, MotionSource):
        return ref
    raise ArgumentError(f"a path, clip, hit, Motion or array of joints (T, 22, 3) is needed, not {type(ref).__name__}")


def _upright(motion: Motion, up: str | None) -> Motion:
    if up not in (None, "y"):
        raise ArgumentError(f"up={up!r}: a Motion is Y up; give up with a file or an array only")
    return motion


def is_vector(value: Any) -> bool:
    """Whether a value is meant as a query vector rather than a reference: numbers in one or two dimensions."""
    if isinstance(value, (str, PathLike, Clip, Hit, Motion, MotionSource)):
        return False
    try:
        return np.ndim(value) in (1, 2)
    except ValueError:  # lists of different lengths
        return True


def span_of(ref: Ref, start: float | None, end: float | None) -> tuple[float | None, float | None]:
    """The span that is meant: `start` and `end` if one is given, else that of a hit that is a part of its clip."""
    if not isinstance(ref, Hit) or start is not None or end is not None:
        return start, end
    is_whole = ref.end - ref.start >= ref.duration - 1e-6
    in_memory = ref.clip_id < 0 and ref.file is None  # then `source_of` gives the span itself
    return (None, None) if is_whole or in_memory else (ref.start, ref.end)


def _source_of_clip(
    number: int, path: str, file: Path | None, library: StoredLibrary | None, fps: float | None, up: str | None
) -> MotionSource:
    """The clip of a library by its number, where it is the one of this path and file; else the file."""
    clip = None if library is None else library.clips_by_id([number]).get(number)
    if library is not None and clip is not None and (clip.path, clip.file) == (path, file):
        return find_source(f"#{number}", library, fps=fps, up=up)
    if file is None:
        raise UnknownClip(f"{path}: is no clip of this library and has no file")
    part = next((part for place, part in splits(path) if place.endswith(file.name)), "")
    return find_source(with_part(str(file), part), library, fps=fps, up=up)


def find_clip(library: StoredLibrary, ref: str | PathLike[str]) -> Clip | None:
    """The clip that a reference names, None for a file outside the library.

    A file that exists is looked up as such; anything else as a path, name or #id of the library.

    Raises
    ------
    UnknownClip
        If it is neither.
    """
    file, part = split_name(ref)
    if not is_file(file):
        return library.find(ref)
    try:
        return library.find(with_part(abspath(file), part))
    except UnknownClip:
        return None


def find_source(
    ref: str | PathLike[str], library: StoredLibrary | None, *, fps: float | None = None, up: str | None = None
) -> MotionSource:
    """What a reference names.

    Parameters
    ----------
    fps : float, optional
        The true frame rate of what is meant; a clip is then read anew from its file.
    up : str, optional
        The axis that is up in its file; a clip is then read anew, too.

    Raises
    ------
    UnreadableMotion, UnknownClip
        If it names nothing, or a file that cannot be read.
    QueryError
        If it names a clip that was added as an array, with a frame rate or an axis.
    """
    if isdir(ref) and (library is None or not library.matches(ref)):
        raise UnreadableMotion(ref, "this is a folder; name a file in it, or a clip of a library by path, name or #id")
    if library is None:
        if not exists(ref) and not is_file(split_name(ref)[0]):
            raise UnreadableMotion(ref, "there is no such file, and no library is given that could hold such a clip")
        return MotionSource.of_file(ref, fps=fps, up=up)
    try:
        clip = find_clip(library, ref)
    except UnknownClip as error:
        raise UnknownClip(f"{error}{_suggestion(library, fspath(ref))}") from None
    if clip is None:
        return MotionSource.of_file(ref, library, fps=fps, up=up)
    if fps is not None or up is not None:
        if clip.file is None:
            change = "at another frame rate" if up is None else "with another axis up"
            raise QueryError(f"{clip.path}: was added as an array; it has no file to read {change}")
        source = MotionSource.of_file(with_part(str(clip.file), clip.part), library, fps=fps, up=up)
        return replace(source, path=clip.path, clip_id=clip.id, root=clip.root_name)
    return MotionSource.of_clip(library, clip)


def _suggestion(library: StoredLibrary, ref: str) -> str:
    """What a reference may have meant which names no clip; empty where it names several."""
    if library.matches(ref):
        return ""
    if len(ref.split()) > 2 and not Path(ref).suffix:
        return "; to find clips by a sentence, search for it"
    clips = library.clips_by_id(library.ids()[:_NAMES_COMPARED]).values()
    if ref.isdigit() and int(ref) in (clip.id for clip in clips):
        return f"; did you mean '#{ref}'?"
    names = {clip: (normalize("NFC", clip.path), normalize("NFC", clip.name)) for clip in clips}
    near_names = get_close_matches(normalize("NFC", ref), {name for both in names.values() for name in both}, n=3)
    near_clips = [clip for name in near_names for clip in clips if name in names[clip]]
    near = list(dict.fromkeys(library.reference(clip.root_name, clip.path) for clip in near_clips))[:_SUGGESTED]
    missing = "" if ref.startswith("#") else ", and no such file"
    return f"{missing}; did you mean {' or '.join(near)}?" if near else missing
