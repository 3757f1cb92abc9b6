"""Shown: a candidate from a frame of the time line on, as pieces that are joined."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from encoders.motion import FPS
from search.compose.candidates import Candidate
from search.compose.joins import Piece
from search.compose.timeline import Cut, Timeline


@dataclass(frozen=True, eq=False)
class Shown:
    """A candidate that is shown from frame `frame` of the time line to frame `end`."""

    candidate: Candidate
    frame: int
    end: int

    def pieces(self, start: int, end: int) -> list[Piece]:
        """Frames `start` to `end` of the time line, one piece for each time that the cut is shown."""
        start, end, times = start - self.frame, end - self.frame, self.candidate.repeats
        once = self.candidate.duration * FPS / self.candidate.rate
        pieces = []
        for time in range(times):
            begin = start if time == 0 else max(start, round(time * once))
            stop = end if time == times - 1 else min(end, round((time + 1) * once))
            if begin < stop:
                at = self.candidate.first + (begin - time * once) * self.candidate.rate
                pieces.append(Piece(self.candidate.around, at, self.candidate.rate, stop - begin))
        return pieces


def frames_of(timeline: Timeline) -> list[tuple[int, int]]:
    """The first frame of each interval, and the one after its last."""
    return [(round(FPS * one.start), round(FPS * one.end)) for one in timeline.intervals]


def stretches(cuts: Iterable[Cut]) -> list[tuple[int, int, int]]:
    """The intervals that lead, in order, each with the frames from and to which it does."""
    found: list[tuple[int, int, int]] = []
    for cut in cuts:
        same = bool(found) and found[-1][0] == cut.base
        start = found.pop()[1] if same else round(FPS * cut.start)
        found.append((cut.base, start, round(FPS * cut.end)))
    return found


def layers(timeline: Timeline, cuts: Iterable[Cut]) -> list[tuple[int, frozenset[str]]]:
    """The intervals that are laid over those that lead, each with its body parts, those with most parts first."""
    found: dict[int, set[str]] = {}
    for cut in cuts:
        for part, owner in cut.owners.items():
            if owner != cut.base:
                found.setdefault(owner, set()).add(part)
    order = sorted(found, key=lambda i: (-len(timeline.intervals[i].parts), i))
    return [(i, frozenset(found[i])) for i in order]
