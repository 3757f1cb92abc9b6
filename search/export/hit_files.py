"""All hits of a search as files, with a table of what they are and the credits of their sources."""

from __future__ import annotations

import csv
import io
import os
import re
import warnings
from collections.abc import Iterable, Sequence
from pathlib import Path

from encoders.errors import ArgumentError, MotionSeekWarning, QueryError, UnknownClip, UnreadableMotion
from indexer.store.stored_library import StoredLibrary
from search.export.credits import credits_text
from search.export.cut import WRITERS, write_cut
from search.export.replacing import write_text
from search.hits import Hit
from search.references import source_of, span_of

TABLE, CREDITS = "hits.csv", "credits.txt"
FORMATS = tuple(ending.lstrip(".") for ending in WRITERS)
_COLUMNS = (
    *("rank", "file", "root", "source", "start", "end", "source_fps", "first_frame", "last_frame"),
    *("score", "strength", "caption", "note"),
)

#: Characters of a clip's name that are kept in the name of a file.
_UNSAFE = re.compile(r"[^\w.-]+")
_LONGEST_NAME = 80


def export_hits(
    hits: Sequence[Hit],
    folder: Path,
    format: str = "bvh",
    *,
    library: StoredLibrary | None = None,
    fps: float | None = None,
    up: str | None = None,
    overwrite: bool = False,
) -> list[Path]:
    """Write the span of each hit as a file into a folder, which is made where there is none.

    The files are named by rank and clip. `hits.csv` says for each where it is from; `credits.txt` holds what the
    folders of the sources say about credits and terms, where they do. A hit that cannot be written has no file, and a
    note in the table.

    Parameters
    ----------
    format : str
        "bvh", in the rig of the source where it has one, "glb", "npz" or "npy".
    library : StoredLibrary, optional
        That the hits are from.
    fps : float, optional
        The true frame rate of the file that all hits are from.
    up : str, optional
        The axis that is up in that file.
    overwrite : bool
        Whether files of these names may be replaced.

    Returns
    -------
    list of Path
        The files of the hits.

    Raises
    ------
    ArgumentError
        If there is no such format, the folder is a file, or a file exists and is not to be overwritten.
    MotionSeekError
        If the system cannot write.
    """
    if format not in FORMATS:
        raise ArgumentError(f"format={format!r} must be one of {', '.join(FORMATS)}")
    files = file_names(hits, format)
    _make(folder, [TABLE, CREDITS, *files], overwrite)
    rows: list[tuple[object, ...]] = []
    written: dict[str, Hit] = {}
    for hit, name in zip(hits, files, strict=True):
        note, is_written = _write(hit, folder / name, library, fps, up)
        if is_written:
            written[name] = hit
        span = (f"{hit.start:.3f}", f"{hit.end:.3f}", hit.source_fps, hit.first_frame, hit.last_frame)
        answer = (f"{hit.score:.4f}", hit.strength, hit.caption, note)
        rows.append((hit.rank, name if name in written else "", hit.root, hit.path, *span, *answer))
    write_text(folder / TABLE, _table(rows))
    credits = credits_text({name: source for name, hit in written.items() if (source := _place(hit, library))})
    if credits:
        write_text(folder / CREDITS, credits)
    return [folder / name for name in written]


def file_names(hits: Sequence[Hit], format: str) -> list[str]:
    """A name for the file of each hit: its rank, and the name of its clip in characters that every system takes."""
    digits = len(str(max((hit.rank for hit in hits), default=1)))
    stems = [_UNSAFE.sub("_", Path(hit.path).stem)[:_LONGEST_NAME].strip("._") or "motion" for hit in hits]
    return [f"{hit.rank:0{digits}d}_{stem}.{format}" for hit, stem in zip(hits, stems, strict=True)]


def _make(folder: Path, names: Iterable[str], overwrite: bool) -> None:
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise ArgumentError(f"{folder}: no such folder can be made ({error.strerror or error})") from None
    for name in names:
        if os.path.lexists(folder / name) and not overwrite:
            raise ArgumentError(
                f"{folder / name} exists; name another folder, or overwrite it (overwrite=True, --force)"
            )


def _write(hit: Hit, out: Path, library: StoredLibrary | None, fps: float | None, up: str | None) -> tuple[str, bool]:
    """Write the span of a hit; what is to be noted of it, and whether it is written."""
    try:
        source = source_of(hit, library, fps=fps, up=up)
        write_cut(source, out, *span_of(hit, None, None))
        return source.stale(), True
    except (UnreadableMotion, UnknownClip, QueryError) as error:
        note = f"not written: {error}"
        warnings.warn(f"{hit.path}: {note}", MotionSeekWarning, stacklevel=3)
        return note, False


def _place(hit: Hit, library: StoredLibrary | None) -> tuple[Path, Path] | None:
    """The file of a hit and the indexed folder that it lies in."""
    if hit.file is None:
        return None
    clip = None if library is None else library.clips_by_id([hit.clip_id]).get(hit.clip_id)
    return hit.file, hit.file.parent if clip is None else clip.root


def _table(rows: Sequence[Sequence[object]]) -> str:
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(_COLUMNS)
    writer.writerows(rows)
    return text.getvalue()
