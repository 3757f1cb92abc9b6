"""What can go wrong, as one tree.

MotionSeekError
├── UnreadableMotion       a file that holds no motion that can be read
│   └── UnknownRig         a skeleton that cannot be mapped to the 22 joints
├── LibraryError           a library that cannot be used
│   ├── LibraryNotFound    there is none
│   ├── LibraryLocked      another process is writing it
│   ├── LibraryDamaged     its files are corrupt or incomplete
│   └── UnknownClip        it has no such clip
├── DatasetError           a captioned data set that cannot be used
│   ├── MissingSplit       it has no such split
│   ├── MissingMotion      a motion that it names is not there
│   ├── WrongFeatureSize   a motion has other features than the model reads
│   ├── NotFinite          a motion holds values that are no numbers
│   └── WrongFrameRate     its motions have another frame rate
├── BundleError            a model bundle that is missing or damaged
├── BundleMismatch         a library made with another model
├── QueryError             a query that cannot be answered
│   └── ArgumentError      an argument of a wrong type or value
└── MissingProgram         an external program, such as ffmpeg, that is not installed

Every error can be pickled, so that it passes from one process to another.
"""

from __future__ import annotations

from collections.abc import Sequence
from os import PathLike, fspath
from typing import Any


class MotionSeekError(Exception):
    """Any error a user can mend; its message says what is wrong, where, and what to do."""


class MotionSeekWarning(UserWarning):
    """What was done otherwise than asked, and why; issued by `warnings.warn`."""


class UnreadableMotion(MotionSeekError):
    """A file holds no motion that can be read."""

    def __init__(self, path: str | PathLike[str], reason: str) -> None:
        self.path = fspath(path)
        self.reason = reason
        super().__init__(self.path, reason)

    def __str__(self) -> str:
        return f"{self.path}: {self.reason}"


class UnknownRig(UnreadableMotion):
    """Some of the 22 target joints have no counterpart in the file's skeleton."""

    def __init__(self, path: str | PathLike[str], missing: Sequence[str], reason: str | None = None) -> None:
        self.missing = list(missing)
        super().__init__(
            path,
            reason or f"no joint found for {', '.join(self.missing)}; name them (joint_map=, --joint-map)",
        )

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (self.path, self.missing, self.reason)


class LibraryError(MotionSeekError):
    """A library cannot be used; the subclasses name the cause."""


class LibraryNotFound(LibraryError):
    """There is no library at a place."""


class LibraryLocked(LibraryError):
    """Another process is writing the library."""


class LibraryDamaged(LibraryError):
    """Files of the library are corrupt or incomplete."""


class UnknownClip(LibraryError):
    """A reference names no clip of the library, or more than one."""


class DatasetError(MotionSeekError):
    """A captioned data set cannot be used; the subclasses name the cause."""


class MissingSplit(DatasetError):
    """A data set has no split of that name."""


class MissingMotion(DatasetError):
    """A motion that a data set names is not in its folder."""


class WrongFeatureSize(DatasetError):
    """A motion of a data set has other features than the model reads."""


class NotFinite(DatasetError):
    """A motion of a data set holds values that are no numbers."""


class WrongFrameRate(DatasetError):
    """The motions of a data set have another frame rate than the model reads."""


class BundleError(MotionSeekError):
    """A model bundle is missing or damaged."""


class BundleMismatch(MotionSeekError):
    """A library was made with another model than the one at hand."""


class QueryError(MotionSeekError):
    """A query cannot be answered as it stands."""


class ArgumentError(QueryError):
    """An argument has a wrong type or value; the message names it."""


class MissingProgram(MotionSeekError):
    """An external program is not installed; the message says how to get it."""
