"""Hit: one answer, a span of a clip."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any


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

    def document(self) -> dict[str, Any]:
        """The hit as the command line and the server write it: stable keys, rounded numbers."""
        named = {"rank": self.rank, "path": self.path, "strength": self.strength, "caption": self.caption}
        numbers = _rounded(self) | {"duration": round(self.duration, 3)}
        fields = {name: (named | numbers)[name] for name in _KEYS}
        return fields | ({"steps": [step.document() for step in self.steps]} if self.steps else {})


_KEYS = ("rank", "path", "score", "strength", "start", "end", "duration", "caption")


def _rounded(span: Step | Hit) -> dict[str, float]:
    return {"score": round(span.score, 4), "start": round(span.start, 3), "end": round(span.end, 3)}
