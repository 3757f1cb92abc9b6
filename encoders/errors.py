"""What can go wrong, as one tree.

MotionSeekError
├── UnreadableMotion   a file that is no motion we can read
├── UnknownRig         a skeleton that cannot be mapped to the 22 joints
├── LibraryError       a library that is missing, locked or damaged
├── BundleError        a model bundle that is missing or damaged
├── BundleMismatch     a library made with another model
└── QueryError         a question that cannot be asked
"""

from __future__ import annotations

from collections.abc import Sequence
from os import PathLike, fspath


class MotionSeekError(Exception):
    """Any error a user can mend; its message says what is wrong, where, and what to do."""


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
            reason or f"no joint found for {', '.join(self.missing)}; name them with --joint-map FILE",
        )


class LibraryError(MotionSeekError):
    """A library is missing, locked or damaged."""


class BundleError(MotionSeekError):
    """A model bundle is missing or damaged."""


class BundleMismatch(MotionSeekError):
    """A library was made with another model than the one at hand."""


class QueryError(MotionSeekError):
    """A question cannot be asked as it stands."""
