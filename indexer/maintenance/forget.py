"""Forget clips: their poses, vectors and captions are removed from a library for good."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

from encoders.errors import UnknownClip
from indexer.store.files import GONE
from indexer.store.stored_library import StoredLibrary
from indexer.store.writer import writing


def forget(folder: Path, refs: Iterable[str] = (), *, gone: bool = False) -> list[str]:
    """Remove clips from a library, all of them or none; their paths.

    Parameters
    ----------
    folder : path
        The library folder.
    refs : iterable of str
        Paths, names or "#number"s of clips, also of those whose file has gone.
    gone : bool
        Remove all clips whose files have gone.

    Raises
    ------
    UnknownClip
        If a reference means no clip or several.
    LibraryLocked
        If another process is writing the library.
    """
    with StoredLibrary.open(folder) as library:
        ids = {_meant(library, ref) for ref in refs}
        ids |= set(_gone(library, "1", ())) if gone else set()
    with writing(folder) as writer, writer.batch():
        return writer.forget(sorted(ids))


def _meant(library: StoredLibrary, ref: str) -> int:
    found = [clip.id for clip in library.matches(ref)]
    number = ref[1:] if ref.startswith("#") and ref[1:].isdecimal() else "-1"
    found = found or _gone(library, "clips.id = ? OR clip_path = ? OR name = ?", (int(number), ref, ref))
    if len(found) > 1:
        raise UnknownClip(f"{ref}: {len(found)} clips are called so; name one of them by its number: {_shown(found)}")
    return found[0] if found else library.find(ref).id


def _gone(library: StoredLibrary, condition: str, values: tuple[int | str, ...]) -> list[int]:
    """Ids of clips whose files have gone and that are not forgotten."""
    rows = library.connection.execute(
        f"SELECT clips.id FROM clips JOIN files ON files.id = clips.file_id WHERE files.state = '{GONE}' "
        f"AND clips.id IN (SELECT clip_id FROM poses) AND ({condition}) ORDER BY clips.id",
        values,
    )
    return [row[0] for row in rows]


def _shown(ids: list[int]) -> str:
    return ", ".join(f"#{clip_id}" for clip_id in ids[:5]) + (", ..." if len(ids) > 5 else "")
