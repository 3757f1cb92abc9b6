"""MotionSource: a motion to search in, whether a clip of a library, a file that is not indexed, or in memory."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from os import PathLike, fspath
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from encoders.bundle.windows import Windows, encode_grids
from encoders.errors import QueryError
from encoders.motion import Motion
from encoders.protocol import Encoder
from indexer.formats.reading import split_name
from indexer.ingest.unindexed import file_state, read_unindexed
from indexer.read_motion import NOT_KNOWN, Reading, extent
from indexer.store.clips import Caption, Clip
from indexer.store.marks.marks_table import NO_MARKS
from indexer.store.stored_library import StoredLibrary
from search.hits import Hit, Step
from search.spans import Moment

#: The shortest cut that can be compared, in seconds.
_SHORTEST_CUT = 0.5


@dataclass(frozen=True)
class MotionSource:
    """A motion with what is known about it.

    The times of captions, hits and cuts are those of its file, which may begin before the motion does; `read`, features
    and windows count from where the motion begins.

    Attributes
    ----------
    path : str
        As answers name it.
    file : Path or None
        Where it was read from; None for a motion in memory.
    duration : float
        Seconds.
    read : callable
        (start, end) in seconds from where the motion begins, end None for the end -> Motion.
    clip_id : int
        -1 where no library holds it.
    root : str
        Name of the indexed folder that holds it; empty where none does.
    library : StoredLibrary or None
        The library whose stored captions and windows are its own.
    part : str
        Which of several motions of its file it is; see `indexer.part_names`.
    reading : Reading
        How it was read from its file.
    """

    path: str
    file: Path | None
    duration: float
    read: Callable[[float, float | None], Motion]
    clip_id: int = -1
    root: str = ""
    library: StoredLibrary | None = field(default=None, repr=False)
    part: str = ""
    reading: Reading = NOT_KNOWN
    _features: dict[str, NDArray[np.float32]] = field(default_factory=dict, repr=False)
    _windows: dict[str, Sequence[Windows]] = field(default_factory=dict, repr=False)

    @classmethod
    def of_clip(cls, library: StoredLibrary, clip: Clip) -> MotionSource:
        """A clip of a library, from its stored poses."""

        def read(start: float, end: float | None) -> Motion:
            return library.motion(clip.id, clip.start + start, None if end is None else clip.start + end)

        return cls(
            clip.path,
            clip.file,
            clip.duration,
            read,
            clip.id,
            clip.root_name,
            library,
            clip.part,
            clip.reading,
        )

    @classmethod
    def of_file(
        cls,
        path: str | PathLike[str],
        library: StoredLibrary | None = None,
        *,
        fps: float | None = None,
        up: str | None = None,
    ) -> MotionSource:
        """A file, read now, with the read options of a library where one is given.

        Parameters
        ----------
        fps : float, optional
            The file's true frame rate, over what it says or the library knows.
        up : str, optional
            The axis that is up, over what the file says or the library knows.

        Raises
        ------
        UnreadableMotion
            If it cannot be read.
        """
        from indexer.ingest.load import issue_warnings, read_motion  # most questions read no file

        if library is None:
            read = read_motion(fspath(path), fps, up=up)
        else:
            read = read_unindexed(library, Path(path), fps=fps, up=up)
        issue_warnings(fspath(path), read.reading)
        file, part = split_name(path)
        return replace(cls.of_motion(read.motion, fspath(path), file), part=part, reading=read.reading)

    @classmethod
    def of_array(cls, array: Motion | NDArray[Any], fps: float | None = None, up: str | None = None) -> MotionSource:
        """Joints (T, 22, 3) at `fps`, 20 if not given; see `indexer.ingest.arrays.to_motion`."""
        from indexer.ingest.arrays import to_motion

        read = to_motion(array, fps, up=up)
        return replace(cls.of_motion(read.motion), reading=read.reading)

    @classmethod
    def of_motion(cls, motion: Motion, path: str = "", file: Path | None = None) -> MotionSource:
        """A motion in memory."""
        return cls(path, file, motion.duration, motion.crop)

    @property
    def start(self) -> float:
        """Where the motion begins, in seconds of its file."""
        return self.reading.start

    @property
    def end(self) -> float:
        """Where it ends, in seconds of its file."""
        return self.start + self.duration

    @cached_property
    def motion(self) -> Motion:
        """The whole motion."""
        return self.read(0.0, None)

    @cached_property
    def captions(self) -> Sequence[Caption]:
        """Its captions in the library; none where no library holds it."""
        return () if self.library is None else self.library.captions(self.clip_id)

    def stale(self) -> str:
        """What became of its file since it was indexed: that it is gone or has changed; else empty."""
        if self.library is None or self.file is None:
            return ""
        return file_state(self.library, self.clip_id, self.file)

    def features(self, encoder: Encoder) -> NDArray[np.float32]:
        """The features (T', F) of the whole motion that a model reads."""
        if encoder.fingerprint not in self._features:
            self._features[encoder.fingerprint] = encoder.features(self.motion)
        return self._features[encoder.fingerprint]

    def windows(self, encoder: Encoder) -> Sequence[Windows]:
        """Its encoded windows: those of the library, else those that a library would hold, shortest first."""
        if encoder.fingerprint not in self._windows:
            stored = () if self.library is None else self.library.windows(self.clip_id)
            self._windows[encoder.fingerprint] = (
                stored or encode_grids(encoder, [self.features(encoder)], [self.duration])[0]
            )
        return self._windows[encoder.fingerprint]

    def cut(self, start: float | None = None, end: float | None = None) -> Motion:
        """The motion from `start` to `end`, in seconds of its file.

        Raises
        ------
        QueryError
            If the span is empty or lies outside.
        """
        if start is None and end is None:
            return self.motion
        first, last = max(start or 0.0, self.start), self.end if end is None else min(end, self.end)
        if not first < last:
            raise QueryError(
                f"{self.path}: span {first:g} to {last:g} s lies outside its {extent(self.start, self.duration)}; "
                "give a start and end inside it, in seconds"
            )
        return self.read(first - self.start, None if end is None else last - self.start)

    def comparable_cut(self, start: float | None = None, end: float | None = None) -> Motion:
        """As `cut`, of a span long enough to be compared with other motions.

        Raises
        ------
        QueryError
            If the span is empty, lies outside or is too short.
        """
        motion = self.cut(start, end)
        if (start, end) != (None, None) and motion.duration < _SHORTEST_CUT:
            raise QueryError(
                f"{self.path}: a cut of {motion.duration:.2f} s shows too little movement to compare; "
                f"take at least {_SHORTEST_CUT:g} s"
            )
        return motion

    def caption(self, start: float, end: float) -> str:
        """The caption of a span of the file: the timed one that overlaps it longest, else one of the whole, else ""."""
        timed = [(min(c.end, end) - max(c.start or 0.0, start), c.text) for c in self.captions if c.end is not None]
        if timed and max(timed)[0] > 0:
            return max(timed)[1]
        return next((c.text for c in self.captions if c.end is None), "")

    def hit(self, rank: int, moment: Moment, strength: str, steps: tuple[Step, ...] = ()) -> Hit:
        """A moment of this motion, with its steps, as an answer in the times of its file."""
        start, end = self.start + moment.start, self.start + min(moment.end, self.duration)
        frames = self.reading.frames(start, end, self.duration)
        return Hit(
            rank=rank,
            path=self.path,
            score=moment.score,
            strength=strength,
            start=start,
            end=end,
            duration=self.duration,
            caption=self.caption(start, self.start + moment.end),
            clip_id=self.clip_id,
            steps=tuple(replace(s, start=self.start + s.start, end=min(self.start + s.end, end)) for s in steps),
            root=self.root,
            file=None if self.file is None else self.file.absolute(),
            source_fps=self.reading.source_fps if frames else None,
            first_frame=frames[0] if frames else None,
            last_frame=frames[1] if frames else None,
            stale=self.stale(),
            marks=NO_MARKS if self.library is None else self.library.marks(self.clip_id),
            read=lambda: self.cut(start, end),
        )
