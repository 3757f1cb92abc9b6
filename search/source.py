"""MotionSource: a motion to search in, whether a clip of a library, a file that is not indexed, or in memory."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from os import PathLike, fspath
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from encoders.bundle.windows import Windows, encode_grids
from encoders.errors import QueryError
from encoders.motion import Motion
from encoders.protocol import Encoder
from indexer.formats.reading import split_name
from indexer.ingest.load import load_motion
from indexer.ingest.unindexed import file_state, read_unindexed
from indexer.store.clips import Caption, Clip
from indexer.store.stored_library import StoredLibrary
from search.hits import Hit, Step
from search.spans import Moment

#: The shortest cut that can be compared, in seconds.
_SHORTEST_CUT = 0.5


@dataclass(frozen=True)
class MotionSource:
    """A motion with what is known about it.

    Attributes
    ----------
    path : str
        As answers name it.
    file : Path or None
        Where it was read from; None for a motion in memory.
    duration : float
        Seconds.
    read : callable
        (start, end) in seconds, end None for the end -> Motion.
    clip_id : int
        -1 where no library holds it.
    root : str
        Name of the indexed folder that holds it; empty where none does.
    library : StoredLibrary or None
        The library whose stored captions and windows are its own.
    part : str
        Which of several motions of its file it is; see `indexer.part_names`.
    """

    path: str
    file: Path | None
    duration: float
    read: Callable[[float, float | None], Motion]
    clip_id: int = -1
    root: str = ""
    library: StoredLibrary | None = field(default=None, repr=False)
    part: str = ""
    _features: dict[str, NDArray[np.float32]] = field(default_factory=dict, repr=False)
    _windows: dict[str, Sequence[Windows]] = field(default_factory=dict, repr=False)

    @classmethod
    def of_clip(cls, library: StoredLibrary, clip: Clip) -> MotionSource:
        """A clip of a library, from its stored poses."""

        def read(start: float, end: float | None) -> Motion:
            return library.motion(clip.id, start, end)

        return cls(clip.path, clip.file, clip.duration, read, clip.id, clip.root_name, library, clip.part)

    @classmethod
    def of_file(
        cls, path: str | PathLike[str], library: StoredLibrary | None = None, *, fps: float | None = None
    ) -> MotionSource:
        """A file, read now, with the read options of a library where one is given.

        Parameters
        ----------
        fps : float, optional
            The file's true frame rate, over what it says or the library knows.

        Raises
        ------
        UnreadableMotion
            If it cannot be read.
        """
        motion = load_motion(path, fps=fps) if library is None else read_unindexed(library, Path(path), fps=fps).motion
        file, part = split_name(path)
        return replace(cls.of_motion(motion, fspath(path), file), part=part)

    @classmethod
    def of_motion(cls, motion: Motion, path: str = "", file: Path | None = None) -> MotionSource:
        """A motion in memory."""
        return cls(path, file, motion.duration, motion.crop)

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
        return "" if self.library is None or self.file is None else file_state(self.library, self.clip_id, self.file)

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
        """The motion from `start` to `end`, in seconds.

        Raises
        ------
        QueryError
            If the span is empty or lies outside.
        """
        if start is None and end is None:
            return self.motion
        try:
            return self.read(start or 0.0, end)
        except ValueError as error:
            raise QueryError(f"{self.path}: {error}; give a start and end inside it, in seconds") from None

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
        """The caption of a span: the timed one that overlaps it longest, else one of the whole clip, else ""."""
        timed = [(min(c.end, end) - max(c.start or 0.0, start), c.text) for c in self.captions if c.end is not None]
        if timed and max(timed)[0] > 0:
            return max(timed)[1]
        return next((c.text for c in self.captions if c.end is None), "")

    def hit(self, rank: int, moment: Moment, strength: str, steps: tuple[Step, ...] = ()) -> Hit:
        """A moment of this motion as an answer."""
        end = min(moment.end, self.duration)
        return Hit(
            rank=rank,
            path=self.path,
            score=moment.score,
            strength=strength,
            start=moment.start,
            end=end,
            duration=self.duration,
            caption=self.caption(moment.start, moment.end),
            clip_id=self.clip_id,
            steps=steps,
            root=self.root,
            file=None if self.file is None else self.file.absolute(),
            read=lambda: self.cut(moment.start, end),
        )
