"""MarkedLibrary: stars, tags and collections, which people give to clips."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from os import PathLike
from typing import Any
from unicodedata import category

from encoders.arguments import checked_flag, checked_text, shown
from encoders.errors import ArgumentError, UnknownClip
from indexer.store.clips import Clip
from indexer.store.library_reader import one_snapshot
from indexer.store.marks import marks_table
from indexer.store.marks.marks_table import COLLECTION, STAR, TAG
from indexer.store.spelling import composed
from indexer.store.stored_library import StoredLibrary
from indexer.store.writer import writing
from search.hits import Hit
from search.references import Ref, find_clip

#: Characters of the longest name of a tag or collection.
_LONGEST_NAME = 100


class MarkedLibrary(StoredLibrary):
    """A library whose clips have stars, tags and collections."""

    def mark(
        self,
        refs: Ref | Iterable[Ref],
        *,
        star: bool = False,
        tags: str | Sequence[str] = (),
        collections: str | Sequence[str] = (),
    ) -> int:
        """Star clips, tag them, or put them into collections: all of them or none. How many clips.

        Parameters
        ----------
        refs : reference or iterable of references
            Clips of the library: by path, name or "#number", as `Clip` or as `Hit`.
        tags, collections : str or sequence of str
            Names of up to 100 characters. One that is there in other case ("Fight") is that one.

        Raises
        ------
        LibraryLocked
            If another process is writing the library.
        """
        return self._change(marks_table.add, refs, star, tags, collections)

    def unmark(
        self,
        refs: Ref | Iterable[Ref],
        *,
        star: bool = False,
        tags: str | Sequence[str] = (),
        collections: str | Sequence[str] = (),
    ) -> int:
        """Take stars, tags or collections from clips that have them; see `mark`."""
        return self._change(marks_table.remove, refs, star, tags, collections)

    @one_snapshot
    def mark_counts(self) -> dict[str, Any]:
        """How many clips are starred, and have each tag and collection: {"starred", "tags", "collections"}."""
        starred = sum(marks_table.counts(self.connection, STAR).values())
        tags, collections = (marks_table.counts(self.connection, kind) for kind in (TAG, COLLECTION))
        return {"starred": starred, "tags": tags, "collections": collections}

    def _change(self, change: Any, refs: Ref | Iterable[Ref], star: bool, tags: Any, collections: Any) -> int:
        given = [(STAR, "")] if checked_flag("star", star) else []
        given += [(TAG, name) for name in checked_names("tags", tags)]
        given += [(COLLECTION, name) for name in checked_names("collections", collections)]
        if not given:
            raise ArgumentError("give star=True, tags or collections")
        ids = self._meant(refs)
        with writing(self._writable()) as writer, writer.batch():
            for kind, name in given if ids else ():
                change(writer.connection, ids, kind, name)
        return len(ids)

    def _meant(self, refs: Ref | Iterable[Ref]) -> list[int]:
        """The numbers of the clips that references mean, each once."""
        one = isinstance(refs, (str, PathLike, Clip, Hit)) or not isinstance(refs, Iterable)
        with self.reading():
            return list(dict.fromkeys(map(self._clip_of, [refs] if one else refs)))  # type: ignore[arg-type]

    def _clip_of(self, ref: Any) -> int:
        if isinstance(ref, (Clip, Hit)):
            number = ref.id if isinstance(ref, Clip) else ref.clip_id
            found = self.clips_by_id([number]).get(number)
            if found is None or found.path != ref.path:
                raise UnknownClip(f"{ref.path}: is no clip of this library; index it to mark it")
            return number
        if not isinstance(ref, (str, PathLike)):
            raise ArgumentError(f"a path, name, '#number', Clip or Hit is needed, not {type(ref).__name__}")
        clip = find_clip(self, ref)
        if clip is None:
            raise UnknownClip(f"{ref!s}: is no clip of this library; index it to mark it")
        return clip.id


def checked_names(argument: str, given: Any) -> list[str]:
    """The names of tags or collections: one string, or several; spaces around and in a row do not count.

    Raises
    ------
    ArgumentError
        If one is empty, too long, or has characters that cannot be shown.
    """
    if isinstance(given, (bytes, dict)) or not isinstance(given, Iterable):
        raise ArgumentError(f"{argument}={shown(given)} must be a name or a list of names")
    return [_checked_name(argument, name) for name in ([given] if isinstance(given, str) else given)]


def _checked_name(argument: str, given: Any) -> str:
    name = composed(" ".join(checked_text(argument, given).split()))
    if not name or len(name) > _LONGEST_NAME or any(category(letter)[0] == "C" for letter in name):
        raise ArgumentError(
            f"{argument}={shown(given)} must have 1 to {_LONGEST_NAME} characters, none of them a control character"
        )
    return name
