"""Source: a motion that is asked about, whether a clip of the library or a file that no library holds."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from os import PathLike, fspath
from pathlib import Path

from encoders.errors import LibraryError, QueryError, UnreadableMotion
from encoders.motion import Motion
from indexer import load_motion
from indexer.clips import Caption, Clip
from indexer.library import Library
from indexer.windows import Windows


@dataclass(frozen=True)
class Source:
    """A motion with what is known about it.

    Attributes
    ----------
    path : str
        As answers name it.
    file : Path or None
        Where it was read from; None for a motion in memory.
    motion : Motion
    captions : sequence of Caption
    windows : sequence of Windows
        Its stored windows; empty where no library holds it.
    clip_id : int
        -1 where no library holds it.
    """

    path: str
    file: Path | None
    motion: Motion
    captions: Sequence[Caption] = ()
    windows: Sequence[Windows] = ()
    clip_id: int = -1

    @classmethod
    def of_clip(cls, library: Library, clip: Clip) -> Source:
        """A clip of a library, from its stored poses."""
        return cls(
            clip.path,
            Path(clip.root) / clip.path,
            library.motion(clip.id),
            library.captions(clip.id),
            library.windows(clip.id),
            clip.id,
        )

    @classmethod
    def of_file(cls, path: str | PathLike[str]) -> Source:
        """A file, read now.

        Raises
        ------
        UnreadableMotion
            If it cannot be read.
        """
        return cls(fspath(path), Path(path), load_motion(path))

    @property
    def duration(self) -> float:
        """Seconds."""
        return self.motion.duration

    def cut(self, start: float | None = None, end: float | None = None) -> Motion:
        """The motion from `start` to `end`, in seconds.

        Raises
        ------
        QueryError
            If the span is empty or lies outside.
        """
        if start is None and end is None:
            return self.motion
        try:
            return self.motion.crop(start or 0.0, end)
        except ValueError as error:
            raise QueryError(f"{self.path}: {error}; give a start and end inside it, in seconds") from None


def find_clip(library: Library, ref: str | PathLike[str]) -> Clip | None:
    """The clip that a reference names, None for a file outside the library.

    A file that exists is looked up as such; anything else as a path, name or #id of the library.

    Raises
    ------
    LibraryError
        If it is neither.
    """
    path = Path(ref)
    if not path.is_file():
        return library.find(fspath(ref))
    try:
        return library.find(str(path.resolve()))
    except LibraryError:
        return None


def find_source(ref: str | PathLike[str], library: Library | None) -> Source:
    """What a reference names.

    Raises
    ------
    UnreadableMotion, LibraryError
        If it names nothing, or a file that cannot be read.
    """
    if library is None:
        if not Path(ref).exists():
            raise UnreadableMotion(ref, "there is no such file; to name a clip of a library, add --library FOLDER")
        return Source.of_file(ref)
    clip = find_clip(library, ref)
    return Source.of_file(ref) if clip is None else Source.of_clip(library, clip)
