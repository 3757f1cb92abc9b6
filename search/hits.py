"""Hit: one answer, a span of a clip."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from html import escape
from typing import Any, SupportsIndex, overload

from encoders.drawing.player import player
from encoders.errors import LibraryError
from encoders.motion import Motion

#: Of a list in a notebook: hits that are shown, and seconds of each.
_SHOWN, _SECONDS = 24, 10.0


@dataclass(frozen=True)
class Step:
    """One step of an answer to a question in steps: its sentence, its span in seconds and its similarity."""

    text: str
    start: float
    end: float
    score: float

    def document(self) -> dict[str, Any]:
        """The step as it is written."""
        return {"text": self.text} | _rounded(self)


@dataclass(frozen=True)
class Hit:
    """A span of a clip that answers a query.

    Attributes
    ----------
    rank : int
        1 for the best.
    path : str
        The clip's path, relative to its indexed folder where it has one.
    score : float
        Cosine similarity to the query, -1 to 1.
    strength : str
        "strong", "plausible" or "weak"; empty where the model carries no calibration.
    start, end : float
        The span in seconds.
    duration : float
        The whole clip in seconds.
    caption : str
        The clip's caption, empty where it has none.
    clip_id : int
        The clip's number in its library, -1 for a file that is not indexed.
    steps : tuple of Step
        The spans of the steps, where the question has some.
    read : callable, optional
        The motion of the span, as long as its library is open.
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
    read: Callable[[], Motion] | None = field(default=None, repr=False, compare=False)

    def document(self) -> dict[str, Any]:
        """The hit as the command line and the server write it: stable keys, rounded numbers."""
        named = {"rank": self.rank, "path": self.path, "strength": self.strength, "caption": self.caption}
        numbers = _rounded(self) | {"duration": round(self.duration, 3)}
        fields = {name: (named | numbers)[name] for name in _KEYS}
        return fields | ({"steps": [step.document() for step in self.steps]} if self.steps else {})

    def _repr_html_(self) -> str | None:
        """The hit, moving, in a notebook; None where its motion is out of reach."""
        return Hits([self])._repr_html_()


class Hits(list[Hit]):
    """Hits, best first; a slice of them is one too."""

    @overload
    def __getitem__(self, at: SupportsIndex) -> Hit: ...
    @overload
    def __getitem__(self, at: slice) -> Hits: ...
    def __getitem__(self, at: SupportsIndex | slice) -> Hit | Hits:
        return Hits(super().__getitem__(at)) if isinstance(at, slice) else super().__getitem__(at)

    def _repr_html_(self) -> str | None:
        """The hits, moving, in a notebook; None where there is none whose motion is within reach."""
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
    said = f" · {hit.caption}" if hit.caption else ""
    found = f"{hit.rank}. {hit.score:.2f} {hit.strength}".rstrip()
    return f"{found} · {hit.path} · {hit.start:.1f}–{hit.end:.1f} s{said}"


_KEYS = ("rank", "path", "score", "strength", "start", "end", "duration", "caption")


def _rounded(span: Step | Hit) -> dict[str, float]:
    return {"score": round(span.score, 4), "start": round(span.start, 3), "end": round(span.end, 3)}
