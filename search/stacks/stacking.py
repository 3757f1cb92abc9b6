"""The stacks of a library: its clips that show one performance, in several rigs or mirrored."""

from __future__ import annotations

import re
from collections import defaultdict
from collections.abc import Callable, Iterable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from encoders.errors import LibraryDamaged
from indexer.store import poses
from indexer.store.clips import LIVE
from indexer.store.stored_library import StoredLibrary
from search.stacks import shape_file
from search.stacks.copies import Pairs, blank, leaders, pairs_of
from search.stacks.shape_file import Computed
from search.stacks.shapes import SIZE, Shape, shape_of

#: Called with how much is done, and how much there is to do.
Progress = Callable[[int, int], None]

_SIDES = re.compile(r"\b(?:left|right|clockwise|anti-?clockwise|counter-?clockwise)(?:wards?)?\b", re.IGNORECASE)


class Copy(NamedTuple):
    """A clip of a stack: its number, and whether it shows the first one mirrored."""

    clip_id: int
    mirrored: bool


def asks_side(text: str) -> bool:
    """Whether a sentence asks for a side or a direction of turning, so that mirrored copies are different answers."""
    return _SIDES.search(text) is not None


def stacks(library: StoredLibrary, progress: Progress | None = None) -> list[tuple[Copy, ...]]:
    """The stacks of two and more clips, in order of their first clips, each in order of its clips' numbers.

    What was computed before is kept in the library's `previews/` folder, and only what changed is computed again.

    Parameters
    ----------
    progress : callable, optional
        Counts clips: each once when its shape is computed, and once when it is compared.
    """
    folder = library.folder / "previews"
    with library.reading() as db:
        (identity,) = db.execute("SELECT value FROM settings WHERE key = 'identity'").fetchone()
        held = shape_file.load(folder, identity)
        computed = _updated(library, held, progress)
    if computed is not held:
        shape_file.save(folder, computed)
    return _stacked(computed)


def among(found: Iterable[tuple[Copy, ...]], allowed: NDArray[np.int64]) -> list[tuple[Copy, ...]]:
    """What is left of stacks where only some clips count; mirrored is again relative to the first that is left."""
    passing = set(allowed.tolist())
    left = [[copy for copy in stack if copy.clip_id in passing] for stack in found]
    return [tuple(Copy(c.clip_id, c.mirrored != stack[0].mirrored) for c in stack) for stack in left if len(stack) > 1]


def _stacked(computed: Computed) -> list[tuple[Copy, ...]]:
    lead, flipped = leaders(len(computed.ids), computed.pairs)
    members: dict[int, list[Copy]] = defaultdict(list)
    for row in np.flatnonzero(np.bincount(lead, minlength=len(lead))[lead] > 1).tolist():
        members[int(lead[row])].append(Copy(int(computed.ids[row]), bool(flipped[row])))
    return [tuple(copies) for _, copies in sorted(members.items())]


def _updated(library: StoredLibrary, held: Computed, progress: Progress | None) -> Computed:
    """What was computed, brought up to date: clips in order of their ids."""
    rows = library.connection.execute(f"SELECT clips.id, clips.generation {LIVE} ORDER BY clips.id").fetchall()
    before = {key: row for row, key in enumerate(zip(held.ids.tolist(), held.generations.tolist(), strict=True))}
    kept = np.array([before.get(key, -1) for key in rows], np.int64)
    if np.array_equal(kept, np.arange(len(held.ids))):
        return held
    ids, generations = np.array(rows, np.int64).reshape(-1, 2).T
    shapes, new = blank(len(ids)), np.flatnonzero(kept < 0)
    shapes.vectors[kept >= 0] = held.shapes.vectors[kept[kept >= 0]]
    shapes.durations[kept >= 0] = held.shapes.durations[kept[kept >= 0]]
    shapes.ways[kept >= 0] = held.shapes.ways[kept[kept >= 0]]
    for done, row in enumerate(new.tolist(), start=1):
        shapes.vectors[row], shapes.durations[row], shapes.ways[row] = _shape(library, int(ids[row]))
        if progress is not None:
            progress(done, 2 * len(new))
    old, found = _moved(held, kept), pairs_of(new, shapes, progress=_second_half(progress, len(new)))
    pairs = np.concatenate([old[0], found[0]]), np.concatenate([old[1], found[1]])
    return Computed(held.identity, ids, generations, shapes, pairs)


def _second_half(progress: Progress | None, count: int) -> Progress | None:
    return None if progress is None else lambda done, _: progress(count + done, 2 * count)


def _shape(library: StoredLibrary, clip_id: int) -> Shape:
    """The shape of a clip; one of no length, which is like no other, where its poses are damaged."""
    try:
        motion = poses.read(library.connection, clip_id)
    except LibraryDamaged:
        return Shape(np.zeros(SIZE, np.float32), 0.0, 0.0)
    return shape_of(motion.joints, motion.duration)


def _moved(held: Computed, kept: NDArray[np.int64]) -> Pairs:
    """The pairs of clips that have not changed, by their new rows."""
    place = np.full(len(held.ids), -1, np.int64)
    place[kept[kept >= 0]] = np.flatnonzero(kept >= 0)
    pairs, flags = held.pairs
    moved = np.sort(place[pairs], axis=1)
    there = moved[:, 0] >= 0
    return moved[there], flags[there]
