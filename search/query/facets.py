"""Facets: how many clips pass the filters, by folder, format, rig, length, tag and collection."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping
from dataclasses import replace
from typing import Any

from indexer.store.clips import LIVE
from indexer.store.marks.marks_table import COLLECTION, TAG
from indexer.store.stored_library import StoredLibrary
from search.query.filters import Filters

#: Values of a facet that are listed, the most frequent ones.
MOST = 50
#: Seconds from which on a clip is of a length.
LENGTHS = (0.0, 2.0, 5.0, 10.0, 30.0)

#: Facet -> the filters that it stands for: its counts are of what passes all others.
_OWN = {
    "folder": ("path",),
    "format": ("format",),
    "rig": ("rig",),
    "length": ("min_duration", "max_duration"),
    "tag": ("tag",),
    "collection": ("collection",),
    "starred": ("starred",),
}
_Row = tuple[int, str, str, str, float]


def facets(library: StoredLibrary, filters: Filters) -> dict[str, list[dict[str, Any]]]:
    """Facet -> its values with the number of clips that would be left: {"value", "count"}, the most frequent first.

    A folder is a part of a path, as the filter takes it; a length has the seconds "from" and "to", the last None.
    """
    rows = library.connection.execute(f"SELECT clips.id, clip_path, format, rig, duration {LIVE}").fetchall()
    marks = library.connection.execute("SELECT clip_id, kind, name FROM marks WHERE clip_id IS NOT NULL").fetchall()
    found: dict[str, list[dict[str, Any]]] = {}
    for facet, own in _OWN.items():
        ids = replace(filters, **dict.fromkeys(own)).ids(library)
        passing = None if ids is None else set(ids.tolist())
        left = [row for row in rows if passing is None or row[0] in passing]
        found[facet] = _values(facet, left, marks, filters.path)
    return found


def _values(facet: str, rows: list[_Row], marks: list[tuple[int, str, str]], path: str | None) -> list[dict[str, Any]]:
    if facet == "length":
        return _lengths(row[4] for row in rows)
    if facet in ("tag", "collection", "starred"):
        kind = {"tag": TAG, "collection": COLLECTION}.get(facet, "star")
        there = {row[0] for row in rows}
        return _listed(Counter(name for clip_id, of, name in marks if of == kind and clip_id in there))
    if facet == "folder":
        return _listed(_folders([row[1] for row in rows]))
    return _listed(Counter(row[2] if facet == "format" else row[3] for row in rows))


def _folders(paths: list[str]) -> Counter[str]:
    """The folders of paths, from the first level on which there are several."""
    parts = [path.split("/")[:-1] for path in paths]
    depth = 0
    while True:
        found = Counter("/".join(part[: depth + 1]) for part in parts if len(part) > depth)
        if len(found) != 1 or sum(found.values()) < len(parts):
            return found
        depth += 1


def _lengths(durations: Iterable[float]) -> list[dict[str, Any]]:
    ends = (*LENGTHS[1:], None)
    counts = Counter(sum(seconds >= start for start in LENGTHS) - 1 for seconds in durations)
    return [
        {"from": start, "to": end, "count": counts[i]}
        for i, (start, end) in enumerate(zip(LENGTHS, ends, strict=True))
        if counts[i]
    ]


def _listed(counts: Mapping[str, int]) -> list[dict[str, Any]]:
    common = sorted(counts.items(), key=lambda item: (-item[1], item[0]))[:MOST]
    return [{"value": value, "count": count} for value, count in common]
