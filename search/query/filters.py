"""Filters: which clips a query is compared with, as columns compared with bound values."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from difflib import get_close_matches
from typing import Any, TypedDict

import numpy as np
from numpy.typing import NDArray

from encoders.arguments import checked_flag, checked_text, optional_number, shown
from encoders.errors import ArgumentError
from indexer.store.clips import LIVE
from indexer.store.marks import marks_table
from indexer.store.marks.marks_table import COLLECTION, STAR, TAG
from indexer.store.stored_library import StoredLibrary
from search.query.path_filter import clips_at, nearest_paths

#: Filter -> the SQL condition it stands for; the value is always bound, never pasted.
_CONDITIONS = {
    "min_duration": "duration >= ?",
    "max_duration": "duration <= ?",
    "rig": "rig = ?",
    "format": "format = ?",
    "split": "clips.id IN (SELECT clip_id FROM captions WHERE split = ?)",
}
#: Filter by the name of a mark -> its kind; names are compared whatever their case.
_MARKED = {"tag": TAG, "collection": COLLECTION}
_NAMES = "(SELECT name FROM (SELECT DISTINCT name FROM marks WHERE kind = '{}') WHERE folded(name) = folded(?))"
_CONDITIONS |= {
    name: f"clips.id IN (SELECT clip_id FROM marks WHERE kind = '{kind}' AND name IN {_NAMES.format(kind)})"
    for name, kind in _MARKED.items()
}
_STARRED = f"clips.id IN (SELECT clip_id FROM marks WHERE kind = '{STAR}' AND clip_id IS NOT NULL)"
_CAPTIONED = "clips.id IN (SELECT clip_id FROM captions WHERE clip_id IS NOT NULL AND text_id IS NOT NULL)"
_FLAGS = {"captioned": _CAPTIONED, "starred": _STARRED}

#: Values that an error suggests, at most.
_SUGGESTED = 4


class FilterArguments(TypedDict, total=False):
    """The fields of `Filters` as keyword arguments."""

    min_duration: float | None
    max_duration: float | None
    path: str | None
    rig: str | None
    format: str | None
    captioned: bool | None
    split: str | None
    starred: bool | None
    tag: str | None
    collection: str | None
    clips: Sequence[str | int] | None


@dataclass(frozen=True)
class Filters:
    """Conditions on clips, all of which must hold; None is no condition.

    Attributes
    ----------
    min_duration, max_duration : float, optional
        Seconds.
    path : str, optional
        A file or folder as it is called, or a pattern: ``*`` any run of characters, ``?`` one, ``[ab]`` one of these;
        see `search.query.path_filter.clips_at`.
    rig, format : str, optional
        As `motionseek status` names them.
    captioned : bool, optional
        Only clips with a caption, or only those without.
    split : str, optional
        The name of a list of ids beside the folders of a published data set, such as ``test``.
    starred : bool, optional
        Only clips with a star, or only those without.
    tag, collection : str, optional
        Only clips with that tag, or in that collection.
    clips : sequence of str or int, optional
        Only these: paths, names or numbers.

    Raises
    ------
    ArgumentError
        If a value is of a wrong type, not finite, or no clip can be as short and as long.
    """

    min_duration: float | None = None
    max_duration: float | None = None
    path: str | None = None
    rig: str | None = None
    format: str | None = None
    captioned: bool | None = None
    split: str | None = None
    starred: bool | None = None
    tag: str | None = None
    collection: str | None = None
    clips: Sequence[str | int] | None = None

    @classmethod
    def of(cls, arguments: Mapping[str, Any]) -> Filters:
        """From keyword arguments.

        Raises
        ------
        ArgumentError
            As above, or if there is no such filter.
        """
        unknown = sorted(set(arguments) - set(cls.__dataclass_fields__))
        if unknown:
            raise ArgumentError(f"no filter {', '.join(unknown)}; there are {', '.join(cls.__dataclass_fields__)}")
        return cls(**arguments)

    def __post_init__(self) -> None:
        for name in ("min_duration", "max_duration"):
            object.__setattr__(self, name, optional_number(name, getattr(self, name)))
        for name in ("path", "rig", "format", "split", *_MARKED):
            value = getattr(self, name)
            if value is not None:
                checked_text(name, value)
        if self.clips is not None:
            object.__setattr__(self, "clips", tuple(_checked_clips(self.clips)))
        for name in _FLAGS:
            if getattr(self, name) is not None:
                checked_flag(name, getattr(self, name))
        low, high = self.min_duration, self.max_duration
        if low is not None and high is not None and low > high:
            raise ArgumentError(f"min_duration={low:g} is more than max_duration={high:g}: no clip can be both")

    @property
    def given(self) -> list[str]:
        """The names of the filters that are given."""
        return [name for name in self.__dataclass_fields__ if getattr(self, name) is not None]

    def ids(self, library: StoredLibrary) -> NDArray[np.int64] | None:
        """The sorted ids of the clips that pass; None where no filter is given."""
        condition, values = self._where()
        passing = library.ids(condition, values) if condition else None
        if self.clips is not None:
            named = [f"#{clip}" if isinstance(clip, int) else clip for clip in self.clips]
            these = np.unique(np.array([library.find(clip).id for clip in named], np.int64))
            passing = these if passing is None else np.intersect1d(these, passing, assume_unique=True)
        if self.path is None:
            return passing
        there = clips_at(library, self.path)
        return there if passing is None else np.intersect1d(there, passing, assume_unique=True)

    def why_none(self, library: StoredLibrary) -> str:
        """Which filter no clip passes, and what there is; empty where some clip passes them all."""
        for name in self.given:
            found = Filters.of({name: getattr(self, name)}).ids(library)
            if found is not None and not len(found):
                return f"no clip passes {name}={getattr(self, name)!r}{self._what_there_is(name, library)}"
        found = self.ids(library)
        if found is None or len(found):
            return ""
        return f"no clip passes {' and '.join(self.given)} at once; each alone lets some through"

    def _what_there_is(self, name: str, library: StoredLibrary) -> str:
        if name == "path":
            near = nearest_paths(library, self.path or "")
            return f"; there are {', '.join(near)}" if near else ""
        if name in ("rig", "format"):
            counts = library.stats()[f"{name}s"]
            near = get_close_matches(getattr(self, name), counts, n=_SUGGESTED) or list(counts)[:_SUGGESTED]
            return f"; there are {', '.join(near)}{', ...' if len(counts) > len(near) else ''}"
        if name == "captioned":
            return "; no clip has a caption" if self.captioned else "; every clip has a caption"
        if name == "starred":
            return "; no clip has a star" if self.starred else "; every clip has a star"
        if name == "clips":
            return "; none is named"
        if name in _MARKED:
            names = list(marks_table.counts(library.connection, _MARKED[name]))
            near = get_close_matches(getattr(self, name), names, n=_SUGGESTED) or names[:_SUGGESTED]
            more = ", ..." if len(names) > len(near) else ""
            return f"; there are {', '.join(near)}{more}" if near else "; there are none"
        if name == "split":
            rows = library.connection.execute(
                "SELECT DISTINCT split FROM captions WHERE clip_id IS NOT NULL AND split IS NOT NULL"
            )
            names = sorted(split for (split,) in rows)
            return f"; there are {', '.join(names[:_SUGGESTED])}" if names else "; there are none"
        shortest, longest = library.connection.execute(f"SELECT min(duration), max(duration) {LIVE}").fetchone()
        return f"; clips last {shortest:.1f} to {longest:.1f} s"

    def _where(self) -> tuple[str, tuple[Any, ...]]:
        """The SQL condition of all filters but the path, and the values to bind; empty where there are none."""
        given = [name for name in self.given if name in _CONDITIONS]
        conditions = [_CONDITIONS[name] for name in given]
        for name, condition in _FLAGS.items():
            if (flag := getattr(self, name)) is not None:
                conditions.append(condition if flag else condition.replace(" IN ", " NOT IN ", 1))
        return " AND ".join(conditions), tuple(getattr(self, name) for name in given)


def _checked_clips(given: Any) -> list[str | int]:
    clips = [given] if isinstance(given, (str, int)) else list(given) if isinstance(given, Iterable) else [given]
    if not all(isinstance(clip, (str, int)) and not isinstance(clip, bool) for clip in clips):
        raise ArgumentError(f"clips={shown(given)} must be paths, names or numbers of clips")
    return clips


def refuse_filters(filters: Mapping[str, Any]) -> None:
    """Check the filters of a question about one motion.

    Raises
    ------
    ArgumentError
        If one is given: filters choose clips of a library.
    """
    if given := Filters.of(filters).given:
        raise ArgumentError(f"{', '.join(given)}: filters choose clips of the library, and a motion is given")
