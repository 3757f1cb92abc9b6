"""Filters as expressions of Milvus, for a library that is a collection there."""

from __future__ import annotations

import re
from collections.abc import Sequence

from indexer.store.spelling import folded
from indexer.vectors.milvus.expressions import among, either, escaped, every, like, nothing, quoted
from search.query.filters import Filters

_WILD = re.compile(r"[*?]")
#: Array of a row by the filter that asks for one of its members.
_MEMBERS = {"tag": "tags", "collection": "collections", "split": "splits"}


def expression_of(filters: Filters, roots: Sequence[str], named: Sequence[int] | None = None) -> str:
    """The expression that all filters make together; empty where none is given.

    Parameters
    ----------
    roots : sequence of str
        The names of the roots, one of which a path may begin with.
    named : sequence of int, optional
        The numbers of the clips that `filters.clips` names.
    """
    conditions = []
    if filters.min_duration is not None:
        conditions.append(f"duration >= {filters.min_duration:.9f}")
    if filters.max_duration is not None:
        conditions.append(f"duration <= {filters.max_duration:.9f}")
    for name in ("rig", "format"):
        if (value := getattr(filters, name)) is not None:
            conditions.append(f"{name} == {quoted(value)}")
    for name in ("captioned", "starred"):
        if (flag := getattr(filters, name)) is not None:
            conditions.append(f"{name} == {str(flag).lower()}")
    for name, array in _MEMBERS.items():
        if (value := getattr(filters, name)) is not None:
            conditions.append(f"array_contains({array}, {quoted(value if name == 'split' else folded(value))})")
    if filters.path is not None:
        conditions.append(_at(filters.path, roots))
    if named is not None:
        conditions.append(among("clip", named))
    return every(conditions)


def _at(pattern: str, roots: Sequence[str]) -> str:
    """The clips at a path, or whose paths match a pattern, whatever the case; relative to a root or after its name.

    ``*`` is any run of characters and ``?`` one. Sets such as ``[ab]`` are not there in Milvus.
    """
    plain = folded(pattern.replace("\\", "/")).removeprefix("./").rstrip("/")
    conditions = [_below(plain)] if plain else []
    for root in roots:
        name = folded(root)
        if plain and f"{plain}/".startswith(f"{name}/"):
            conditions.append(every([f"root == {quoted(root)}", _below(plain[len(name) + 1 :])]))
    return either(conditions) if conditions else nothing("duration")


def _below(place: str) -> str:
    """The clips of a file, those in a folder, or all that match a pattern."""
    if not place:
        return ""
    found = [like("folded", place)]
    found += [like("folded", f"{place}{mark}", then_anything=True) for mark in "/#"]
    if _WILD.search(place):
        matched = escaped(place).replace("*", "%").replace("?", "_")
        found += [f"folded like {quoted(matched)}", f"folded like {quoted(f'{matched}#%')}"]
    return either(found)
