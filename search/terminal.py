"""What people and programs see: tables in a terminal, TAB-separated lines in a pipe, JSON when asked."""

from __future__ import annotations

import json
import sys
from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING, Any, Literal

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from search.hits import Hit
    from search.question import Question

    Curve = tuple[NDArray[np.float64], NDArray[np.float32]]

_HIT_COLUMNS = ("", "score", "strength", "start", "end", "clip", "caption")
_COLOURS = {"strong": "green", "plausible": "yellow", "weak": "dim"}
_BLOCKS = "▁▂▃▄▅▆▇█"


def is_terminal() -> bool:
    """Whether a person is likely to read stdout."""
    return sys.stdout.isatty()


def document(content: Any) -> None:
    """Print one JSON document."""
    print(json.dumps(content, ensure_ascii=False, indent=2 if is_terminal() else None, allow_nan=False))


def table(columns: Sequence[str], rows: Iterable[Sequence[str]], *, right: Sequence[str] = ()) -> None:
    """Print rows as an aligned table without its empty columns, or as lines with TABs between all cells when piped.

    Parameters
    ----------
    right : sequence of str
        The columns that hold numbers.
    """
    if not is_terminal():
        for row in rows:
            print("\t".join(" ".join(cell.split()) for cell in row))
        return
    from rich import box
    from rich.console import Console
    from rich.table import Table
    from rich.text import Text

    rows = list(rows)
    shown = Table(box=box.SIMPLE_HEAD, pad_edge=False, show_edge=False, show_header=any(columns))
    used = [i for i, column in enumerate(columns) if not column or any(row[i] for row in rows)]
    for i in used:
        justify: Literal["right", "left"] = "right" if columns[i] in right else "left"
        shown.add_column(columns[i], justify=justify, overflow="fold")
    for row in rows:
        shown.add_row(*(Text(row[i], style=_COLOURS.get(row[i], "")) for i in used))
    Console().print(shown)


def hits(found: Sequence[Hit], query: str, *, as_json: bool) -> None:
    """Print the answers to a query."""
    if as_json:
        document({"query": query, "hits": [hit.document() for hit in found]})
        return
    rows = [
        (str(h.rank), f"{h.score:.3f}", h.strength, f"{h.start:.1f}", f"{h.end:.1f}", h.path, h.caption) for h in found
    ]
    table(_HIT_COLUMNS, rows, right=("", "score", "start", "end"))
    if found and all(hit.strength == "weak" for hit in found):
        note("nothing here matches; these are the nearest")


def note(line: str) -> None:
    """Say something beside the answer: on stderr, so that a pipe carries answers only."""
    print(line, file=sys.stderr)


def strip(values: Sequence[float], width: int) -> str:
    """A curve as one line of blocks, each the highest value of its stretch."""
    import numpy as np

    curve = np.asarray(values, dtype=np.float64)
    edges = np.linspace(0, len(curve), min(width, len(curve)) + 1).astype(int)[:-1]
    peaks = np.maximum.reduceat(curve, edges)
    span = float(np.ptp(peaks)) or 1.0
    levels = ((peaks - peaks.min()) / span * (len(_BLOCKS) - 1)).round().astype(int)
    return "".join(_BLOCKS[level] for level in levels)


def answer(
    question: Question,
    found: Sequence[Hit],
    curve: Curve | None = None,
    *,
    as_json: bool,
    width: int = 80,
) -> None:
    """Print the moments that answer a question, with the curve of the take where there is one."""
    if as_json:
        content: dict[str, Any] = {"query": str(question), "hits": [hit.document() for hit in found]}
        if question.how != "alone":
            content |= {"how": question.how, "sentences": list(question.sentences)}
        if curve is not None:
            times, similarity = curve
            named = zip(question.sentences, similarity.round(4).tolist(), strict=True)
            content["curve"] = {"times": times.round(3).tolist(), "similarity": dict(named)}
        document(content)
        return
    if is_terminal() and curve is not None:
        for text, values in zip(question.sentences, curve[1], strict=True):
            print(f"{text}\n{strip(values.tolist(), width - 2)}")
    elif is_terminal() and question.how != "alone":
        print(f" {question.how} ".join(f"'{text}'" for text in question.sentences))
    hits(found, str(question), as_json=False)
    steps = [(str(h.rank), f"{s.score:.3f}", f"{s.start:.1f}", f"{s.end:.1f}", s.text) for h in found for s in h.steps]
    if steps:
        table(("", "score", "start", "end", "step"), steps, right=("", "score", "start", "end"))
