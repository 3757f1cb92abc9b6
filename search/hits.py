"""Hit: one answer, a span of a motion."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from html import escape
from pathlib import Path
from typing import Any, SupportsIndex, overload

from encoders.drawing.player import player
from encoders.errors import LibraryError, MissingProgram
from encoders.motion import Motion
from indexer.store.marks.marks_table import NO_MARKS, Marks

STRONG, PLAUSIBLE, WEAK = "strong", "plausible", "weak"

#: In a notebook: hits of a list that are shown, and seconds of each.
_SHOWN, _SECONDS = 24, 10.0


@dataclass(frozen=True)
class Step:
    """One step of an answer to a question in steps: its sentence, its span in seconds as of `Hit`, its similarity."""

    text: str
    start: float
    end: float
    score: float

    def document(self) -> dict[str, Any]:
        """The step as plain data, numbers rounded."""
        return {"text": self.text} | _rounded(self)


@dataclass(frozen=True)
class Hit:
    """A span of a motion that answers a query. Hits can be compared and pickled; a pickled one no longer has `read`.

    Attributes
    ----------
    rank : int
        1 for the best.
    path : str
        The clip's path, relative to its root; the path as given for a file that is not indexed.
    score : float
        Cosine similarity to the query, -1 to 1.
    strength : str
        "strong", "plausible" or "weak"; empty where the model carries no calibration.
    start, end : float
        The span in seconds of the clip's file.
    duration : float
        The whole clip in seconds.
    caption : str
        The clip's caption, empty where it has none.
    clip_id : int
        The clip's number in its library, -1 for a motion that is not indexed.
    steps : tuple of Step
        The spans of the steps, where the question has some.
    root : str
        Name of the indexed folder that holds the clip, unique in its library; empty for a motion that is not indexed.
    file : Path or None
        The absolute path of the source file; None for a motion without one.
    source_fps : float or None
        Frames a second of the file; None where they are not known.
    first_frame, last_frame : int or None
        The span's first and last frame in the file, counted from 0.
    stale : str
        What became of the file since it was indexed: that it is gone or has changed, so that the span may no longer
        be its; else empty.
    matched : tuple of str
        Where the clip has the words of the sentence: "name", "folder", "caption", "tag", "collection"; empty where it
        was found by its meaning alone.
    marks : Marks
        The clip's star, tags and collections.
    read : callable or None
        Gives the Motion of the span, as long as its library is open.
    """

    rank: int
    path: str
    score: float
    strength: str
    start: float
    end: float
    duration: float
    caption: str = ""
    clip_id: int = -1
    steps: tuple[Step, ...] = ()
    root: str = ""
    file: Path | None = None
    source_fps: float | None = None
    first_frame: int | None = None
    last_frame: int | None = None
    stale: str = ""
    matched: tuple[str, ...] = ()
    marks: Marks = NO_MARKS
    read: Callable[[], Motion] | None = field(default=None, repr=False, compare=False)

    def document(self) -> dict[str, Any]:
        """The hit as plain data with stable keys and rounded numbers, as the command line and the server write it.

        `clip` and `root` are None for a motion that is not indexed; `steps` is there where the question has some;
        `source_fps` and the frames are None where they are not known; `stale` is None where the file is as it was.
        """
        span = _rounded(self)
        fields = {"rank": self.rank, "path": self.path, "score": span["score"], "strength": self.strength}
        fields |= {"start": span["start"], "end": span["end"], "duration": round(self.duration, 3)}
        fields["caption"] = self.caption
        if self.steps:
            fields["steps"] = [step.document() for step in self.steps]
        indexed = self.clip_id >= 0
        fields |= {"clip": self.clip_id if indexed else None, "root": self.root if indexed else None}
        rate = None if self.source_fps is None else round(self.source_fps, 4)
        fields |= {"source_fps": rate, "first_frame": self.first_frame, "last_frame": self.last_frame}
        return fields | {"stale": self.stale or None, "matched": list(self.matched)} | self.marks.document()

    def __getstate__(self) -> dict[str, Any]:
        return self.__dict__ | {"read": None}

    def _repr_html_(self) -> str | None:
        """The hit, moving, in a notebook; None where its motion cannot be read."""
        return Hits([self])._repr_html_()


class Hits(list[Hit]):
    """Hits, best first; a slice of them is one too."""

    @overload
    def __getitem__(self, at: SupportsIndex) -> Hit: ...
    @overload
    def __getitem__(self, at: slice) -> Hits: ...
    def __getitem__(self, at: SupportsIndex | slice) -> Hit | Hits:
        return Hits(super().__getitem__(at)) if isinstance(at, slice) else super().__getitem__(at)

    @property
    def nothing_matches(self) -> bool:
        """Whether there are hits, and all are weak and found by their meaning: then nothing matches the query."""
        return bool(self) and all(hit.strength == WEAK and not hit.matched for hit in self)

    def to_dicts(self) -> list[dict[str, Any]]:
        """Every hit as `Hit.document` gives it."""
        return [hit.document() for hit in self]

    def to_pandas(self) -> Any:
        """A pandas.DataFrame with one row for each hit and the keys of `Hit.document` as columns, also without hits.

        Raises
        ------
        MissingProgram
            If pandas is not installed.
        """
        try:
            import pandas
        except ImportError:
            raise MissingProgram("to_pandas needs pandas; run: pip install pandas") from None

        columns = None if self else list(Hit(1, "", 0.0, "", 0.0, 0.0, 0.0).document())
        return pandas.DataFrame(self.to_dicts(), columns=columns)

    def _repr_html_(self) -> str | None:
        """The hits, moving, in a notebook; None where no motion can be read."""
        try:
            shown = [(hit.read(), _legend(hit)) for hit in self[:_SHOWN] if hit.read is not None]
        except LibraryError:  # closed since
            return None
        if not shown:
            return None
        more = len(self) - _SHOWN
        rest = f"<p>{escape(f'and {more} more')}</p>" if more > 0 else ""
        takes = [(motion.joints, motion.fps, legend) for motion, legend in shown]
        if len(takes) == 1:
            return player(takes) + rest
        return player(takes, seconds=_SECONDS, width=200) + rest


def _legend(hit: Hit) -> str:
    caption = f" · {hit.caption}" if hit.caption else ""
    ranked = f"{hit.rank}. {hit.score:.2f} {hit.strength}".rstrip()
    return f"{ranked} · {hit.path} · {hit.start:.1f}–{hit.end:.1f} s{caption}"


def _rounded(span: Step | Hit) -> dict[str, float]:
    return {"score": round(span.score, 4), "start": round(span.start, 3), "end": round(span.end, 3)}
