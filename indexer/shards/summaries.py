"""What each library that fills a collection says of itself, and what that makes together."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from typing import Any

from indexer.shards.shard import Shard
from indexer.store.marks import marks_table
from indexer.store.marks.marks_table import COLLECTION, STAR, TAG
from indexer.store.stored_library import StoredLibrary

_SUMS = ("clips", "seconds", "windows", "captions", "failed", "starred")
_COUNTS = ("formats", "rigs", "tags", "collections")
#: Values of one kind that a summary counts, the most frequent ones.
_MOST_VALUES = 300


def summary_of(library: StoredLibrary, shard: Shard) -> dict[str, Any]:
    """What a library says of itself; no place of its machine is among it."""
    stats, db = library.stats(), library.connection
    stats |= {"tags": marks_table.counts(db, TAG), "collections": marks_table.counts(db, COLLECTION)}
    stats |= {"starred": sum(marks_table.counts(db, STAR).values())}
    counted = {name: dict(Counter(stats[name]).most_common(_MOST_VALUES)) for name in _COUNTS}
    return {name: stats[name] for name in _SUMS} | counted | {"shard": str(shard), "roots": library.all_root_names}


def together(summaries: Sequence[dict[str, Any]]) -> dict[str, Any]:
    """The sums of all summaries, the last one written last, and the names of all roots.

    Where an archive's number of shards has changed, those of the shards of before do not count.
    """
    latest = {tuple(summary["roots"]): _count(summary) for summary in summaries}
    counting = [summary for summary in summaries if latest[tuple(summary["roots"])] == _count(summary)]
    total: dict[str, Any] = {name: sum(summary[name] for summary in counting) for name in _SUMS}
    for name in _COUNTS:
        values: Counter[str] = Counter()
        for summary in counting:
            values.update(summary[name])
        total[name] = dict(sorted(values.items(), key=lambda item: (-item[1], item[0])))
    return total | {"roots": sorted({root for summary in counting for root in summary["roots"]})}


def _count(summary: dict[str, Any]) -> str:
    return str(summary["shard"]).partition("/")[2]
