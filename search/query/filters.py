"""Filters: which clips a question is asked of, as columns compared with bound values."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from encoders.errors import QueryError

#: Filter -> the SQL condition it stands for; the value is always bound, never pasted.
_CONDITIONS = {
    "min_duration": "duration >= ?",
    "max_duration": "duration <= ?",
    "path": "path GLOB ?",
    "rig": "rig = ?",
    "format": "format = ?",
}
_CAPTIONED = "clips.id IN (SELECT clip_id FROM captions WHERE clip_id IS NOT NULL AND text_id IS NOT NULL)"


@dataclass(frozen=True)
class Filters:
    """Conditions on clips, all of which must hold; None asks for nothing.

    Attributes
    ----------
    min_duration, max_duration : float, optional
        Seconds.
    path : str, optional
        A pattern for the path relative to its folder: ``*`` any run of characters, ``?`` one, ``[ab]`` one of these.
    rig, format : str, optional
        As `motionseek status` names them.
    captioned : bool, optional
        Only clips with a caption, or only those without.
    """

    min_duration: float | None = None
    max_duration: float | None = None
    path: str | None = None
    rig: str | None = None
    format: str | None = None
    captioned: bool | None = None

    def __post_init__(self) -> None:
        low, high = self.min_duration, self.max_duration
        if low is not None and high is not None and low > high:
            raise QueryError(f"min_duration={low:g} is more than max_duration={high:g}: no clip can be both")

    def where(self) -> tuple[str, tuple[Any, ...]]:
        """The SQL condition on the table of clips and the values to bind; an empty condition for all clips."""
        given = {name: getattr(self, name) for name in _CONDITIONS if getattr(self, name) is not None}
        conditions = [_CONDITIONS[name] for name in given]
        if self.captioned is not None:
            conditions.append(_CAPTIONED if self.captioned else _CAPTIONED.replace(" IN ", " NOT IN "))
        return " AND ".join(conditions), tuple(given.values())
