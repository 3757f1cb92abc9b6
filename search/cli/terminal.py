"""Output: tables in a terminal, tab-separated lines in a pipe, JSON on request."""

from __future__ import annotations

import json
import re
import sys
from collections.abc import Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, Any, Literal

if TYPE_CHECKING:
    from rich.console import Console
    from rich.text import Text

    from encoders.protocol import Encoder
    from indexer.store.stored_library import StoredLibrary
    from search.documents import Curve
    from search.hits import Hits
    from search.query.question import Question

_HIT_COLUMNS = ("", "score", "strength", "start", "end", "clip", "caption", "matched")
_COLOURS = {"strong": "green", "plausible": "yellow", "weak": "dim"}
#: Control characters, which would move the cursor or break a line.
_CONTROL = re.compile(r"[\x00-\x1f\x7f-\x9f]")
#: Characters between two columns; the preferred and the minimum width of a column of text.
_GAP, _READABLE, _TIGHT = 3, 24, 10
_BLOCKS = "▁▂▃▄▅▆▇█"


def is_terminal() -> bool:
    """Whether stdout is a terminal."""
    return sys.stdout.isatty()


def document(content: Any) -> None:
    """Print one JSON document."""
    print(json.dumps(content, ensure_ascii=False, indent=2 if is_terminal() else None, allow_nan=False))


def table(
    columns: Sequence[str], rows: Iterable[Sequence[str]], *, right: Sequence[str] = (), below: Sequence[str] = ()
) -> None:
    """Print rows as an aligned table without empty columns, or when piped as tab-separated lines of all cells.

    Parameters
    ----------
    right : sequence of str
        Columns that are right-aligned, as numbers are.
    below : sequence of str
        Columns that go on lines of their own where the terminal is too narrow.
    """
    rows = [[_CONTROL.sub(" ", cell) for cell in row] for row in rows]
    if not is_terminal():
        for row in rows:
            print("\t".join(row))
        return
    if not rows:
        return
    from rich.cells import cell_len
    from rich.console import Console

    console = Console(highlight=False)
    used = [i for i, column in enumerate(columns) if not column or any(row[i] for row in rows)]
    width = {i: max(cell_len(text) for text in (columns[i], *(row[i] for row in rows))) for i in used}

    def least(text: int) -> int:
        return sum(width[i] if columns[i] in right else min(width[i], text) for i in used) + _GAP * (len(used) - 1)

    long = [i for i in used if columns[i] in below]
    if long and least(_READABLE) > console.width:
        _print_stacked(console, rows, [i for i in used if i not in long], long)
    else:
        console.width = max(console.width, least(_TIGHT))  # rather lines that the terminal breaks than numbers cut off
        _print_table(console, columns, rows, used, right)


def _print_table(
    console: Console, columns: Sequence[str], rows: Sequence[Sequence[str]], used: Sequence[int], right: Sequence[str]
) -> None:
    from rich import box
    from rich.table import Table

    shown = Table(box=box.SIMPLE_HEAD, pad_edge=False, show_edge=False, show_header=any(columns))
    for i in used:
        number = columns[i] in right
        justify: Literal["right", "left"] = "right" if number else "left"
        shown.add_column(columns[i], justify=justify, overflow="fold", no_wrap=number)
    for row in rows:
        shown.add_row(*(_styled(row[i]) for i in used))
    console.print(shown)


def _print_stacked(console: Console, rows: Sequence[Sequence[str]], short: Sequence[int], long: Sequence[int]) -> None:
    from rich.padding import Padding
    from rich.text import Text

    for row in rows:
        console.print(Text("  ").join(_styled(row[i]) for i in short if row[i]))
        for cell in (row[i] for i in long if row[i]):
            console.print(Padding(Text(cell, overflow="fold"), (0, 0, 0, 3), expand=False))


def _styled(cell: str) -> Text:
    from rich.text import Text

    return Text(cell, style=_COLOURS.get(cell, ""))


def hits(
    found: Hits,
    query: str,
    library: StoredLibrary | None = None,
    *,
    as_json: bool,
    sentences: Sequence[str] = (),
    told: bool = False,
) -> None:
    """Print the hits of a query; where their library has several roots, the root's name comes before each path.

    Parameters
    ----------
    sentences : sequence of str
        What of the query was said in words.
    told : bool
        Whether it has been said what became of their files.
    """
    if as_json:
        from search.documents import search_document

        content = search_document(query, sentences, found.to_dicts())
        document(content if sentences else {"query": query, "hits": content["hits"]})
        return
    clips = [h.path if library is None else library.reference(h.root, h.path) for h in found]
    rows = [
        (
            str(h.rank),
            f"{h.score:.3f}",
            h.strength,
            f"{h.start:.1f}",
            f"{h.end:.1f}",
            clip,
            h.caption,
            ", ".join(h.matched),
        )
        for h, clip in zip(found, clips, strict=True)
    ]
    table(_HIT_COLUMNS, rows, right=("", "score", "start", "end"), below=("clip", "caption"))
    if not told:
        stale({clip: h.stale for h, clip in zip(found, clips, strict=True)})
    if found.nothing_matches:
        note("no good match; these are the nearest")


def stale(clips: Mapping[str, str]) -> None:
    """Say of clips, by name, what became of their files since they were indexed; nothing where that is empty."""
    for clip, state in clips.items():
        if state:
            note(f"{clip} {state}")


def remark(sentences: Sequence[str], bundle: Encoder) -> None:
    """Say what of the sentences is not understood: a slip, another language, words that were never learned."""
    from search.query.wording import remark

    known = (bundle.calibration or {}).get("words")
    if known is None:
        return
    for sentence in sentences:
        if said := remark(sentence, known):
            note(said if len(sentences) == 1 else f"{sentence}: {said}")


def note(line: str) -> None:
    """Print a remark to stderr, so that a pipe carries results only."""
    print(line, file=sys.stderr)


def strip(values: Sequence[float], width: int) -> str:
    """A curve as one line of block characters, each the maximum of its interval."""
    import numpy as np

    curve = np.asarray(values, dtype=np.float64)
    edges = np.linspace(0, len(curve), min(width, len(curve)) + 1).astype(int)[:-1]
    peaks = np.maximum.reduceat(curve, edges)
    span = float(np.ptp(peaks)) or 1.0
    levels = ((peaks - peaks.min()) / span * (len(_BLOCKS) - 1)).round().astype(int)
    return "".join(_BLOCKS[level] for level in levels)


def moments(
    question: Question,
    found: Hits,
    library: StoredLibrary | None = None,
    curve: Curve | None = None,
    *,
    as_json: bool,
    width: int = 80,
    filters: Mapping[str, Any] | None = None,
) -> None:
    """Print the moments of a question, with the similarity curve of the clip if they are of one.

    Where none is found, it is said which of the filters no clip passes.
    """
    if as_json:
        from search.documents import moments_document

        document(moments_document(question, found.to_dicts(), curve))
        return
    if is_terminal() and curve is not None:
        for text, values in zip(question.sentences, curve[1], strict=True):
            print(f"{text}\n{strip(values.tolist(), width - 2)}")
    elif is_terminal() and question.how != "alone":
        print(f" {question.how} ".join(f"'{text}'" for text in question.sentences))
    hits(found, str(question), library, as_json=False, told=curve is not None)
    if not found:
        why = "" if library is None else why_no_clips(library, filters or {})
        whole = "; with --no-split it is searched for as one" if question.undivided else ""
        note(why or f"nothing found: the motion is too short for all steps{whole}")
    if not is_terminal():
        return  # piped lines have one format; the steps are in the JSON
    steps = [(str(h.rank), f"{s.score:.3f}", f"{s.start:.1f}", f"{s.end:.1f}", s.text) for h in found for s in h.steps]
    if steps:
        table(("", "score", "start", "end", "step"), steps, right=("", "score", "start", "end"))


def no_clips(library: StoredLibrary, filters: Mapping[str, Any]) -> str:
    """Why there are no clips to show."""
    return why_no_clips(library, filters) or "nothing found"


def why_no_clips(library: StoredLibrary, filters: Mapping[str, Any]) -> str:
    """Why no clip is looked at; empty where some are."""
    if len(library) == 0:
        if gone := library.stats()["gone"]:
            return f"the files of all {gone} clips are gone; bring them or their drive back and run 'motionseek index'"
        return "the library is empty; put motion files into its folder and run 'motionseek index' again"
    from search.query.filters import Filters

    return Filters.of(filters).why_none(library)
