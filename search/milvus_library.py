"""MilvusLibrary: a `Library` that is a collection of Milvus, to be asked from any machine that reaches it."""

from __future__ import annotations

import copy
import time
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from encoders.bundle.windows import Windows
from encoders.errors import QueryError, UnknownClip
from encoders.protocol import Encoder
from indexer.argument_checks import checked_clip_id
from indexer.formats.opening import is_file
from indexer.formats.reading import split_name
from indexer.shards.collection_rows import DistantClip, clip_of, windows_of
from indexer.shards.pose_files import PoseFiles
from indexer.shards.summaries import together
from indexer.store.clips import Caption, Clip
from indexer.store.marks.marks_table import Marks
from indexer.store.spelling import folded
from indexer.store.stored_library import CaptionVectors
from indexer.vectors.blocks import IndexRows
from indexer.vectors.milvus.collection_schema import CLIPS, FIELDS, WINDOWS, Row
from indexer.vectors.milvus.expressions import among, either, every, like, quoted
from indexer.vectors.milvus.milvus_address import MilvusAddress
from indexer.vectors.milvus.milvus_collection import MOST_ROWS, MilvusCollection
from indexer.vectors.milvus.milvus_index import MilvusIndex, as_index_rows
from search.distant_library import DistantLibrary
from search.query.filter_expressions import expression_of
from search.query.filters import FilterArguments, Filters
from search.ranking.text_matches import TextMatch, called_so
from search.references import Ref
from search.source import MotionSource

if TYPE_CHECKING:
    from typing_extensions import Self, Unpack

Ids = NDArray[np.int64]
Vectors = NDArray[np.float32]

#: Clips whose captions and marks are kept, and seconds for which the number of clips is.
_KEPT, _COUNTED = 20_000, 2.0
#: Clips that may be listed one by one.
_MOST_LISTED = 200_000
#: Clips of one name that are looked at.
_CALLED = 300
_OF_CLIP = tuple(field for field in FIELDS if field not in ("folded", "splits", "slot", "start", "end", "length"))


class MilvusLibrary(DistantLibrary):
    """A library that any number of indexers fill and any number of processes ask; nothing of it is on this machine.

    It answers as a `Library` does. What needs the library itself raises `QueryError`: marks cannot be changed, stacks
    are not found, and `describe` knows the shipped vocabulary alone. The clips that a question's words are in are found
    by their whole name or path only. docs/scaling.md has all that differs.

    Parameters
    ----------
    address : MilvusAddress or str
    bundle : Encoder, optional
        The model; if not given, that of the collection is found where models are kept.
    poses : path or str, optional
        Where the poses are; without, what needs them raises `QueryError`.

    Raises
    ------
    LibraryNotFound, LibraryError
        If there is no such collection, or no Milvus that answers.
    BundleMismatch
        If `bundle` is not the model whose vectors it holds.
    """

    #: Clips that are scored at once: one answer of Milvus for many costs little more than one for few.
    scored_at_once = 64

    def __init__(
        self,
        address: MilvusAddress | str,
        *,
        bundle: Encoder | None = None,
        poses: str | PathLike[str] | None = None,
    ) -> None:
        self.address = address if isinstance(address, MilvusAddress) else MilvusAddress.of(address)
        super().__init__(Path(str(self.address)))
        self.collection = MilvusCollection(self.address)
        self._poses = None if poses is None else PoseFiles(poses)
        self.has_poses = poses is not None
        self._condition = ""
        self._known: dict[int, DistantClip] = {}
        self._count = (0.0, 0)
        if bundle is not None:
            self._check(bundle)
            self._bundle = bundle

    def close(self) -> None:
        """End the connection; later calls fail."""
        super().close()
        self.collection.close()

    @property
    def generation(self) -> int:
        """Another number after each run that wrote."""
        return self.collection.generation()

    captions_generation = marks_generation = generation

    def _model(self) -> dict[str, Any]:
        held = self.collection
        return {"name": held.model, "fingerprint": held.fingerprint, "size": held.size}

    def __len__(self) -> int:
        when, count = self._count
        if time.monotonic() - when > _COUNTED or not count:
            count = self.collection.count(CLIPS)
            self._count = time.monotonic(), count
        return count

    # Which clips there are

    def narrowed(self, filters: FilterArguments, *, without: int = -1) -> tuple[Self, Ids | None]:
        """See `Library.narrowed`: the library whose searches have the filters' expression."""
        condition = every([self.expression(filters), f"clip != {without}" if without >= 0 else ""])
        if not condition:
            return self, None
        other = copy.copy(self)
        other._condition = every([self._condition, condition])
        return other, None

    def expression(self, filters: FilterArguments) -> str:
        """The filters as an expression of Milvus."""
        given = Filters.of(filters)
        named = None if given.clips is None else [self._number(clip) for clip in given.clips]
        return expression_of(given, self.root_names if given.path else (), named)

    def _number(self, clip: str | int) -> int:
        return self.find(f"#{clip}" if isinstance(clip, int) else clip).id

    def allowed(self, **filters: Unpack[FilterArguments]) -> Ids | None:
        """See `Library.allowed`; the filters are best left to `narrowed`."""
        condition = self.expression(filters)
        return self.ids(condition) if condition else None

    def ids(self, where: str = "", values: Sequence[Any] = ()) -> Ids:
        """The sorted numbers of the clips that meet an expression of Milvus.

        Raises
        ------
        QueryError
            If there are more than can be listed.
        """
        count = self.collection.count(CLIPS, where)
        if count > _MOST_LISTED:
            raise QueryError(f"{count} clips are too many to list one by one; narrow them down with filters")
        rows = self.collection.all_rows(CLIPS, where, ("clip",))
        return np.array(sorted(row["clip"] for row in rows), np.int64)

    def some_clips(self, filters: FilterArguments, first: int, count: int) -> tuple[int, list[DistantClip]]:
        """How many clips pass the filters, and some of them in an order that Milvus chooses, of the first 16,384."""
        condition, last = self.expression(filters), min(first + count, MOST_ROWS)
        rows = self.collection.rows(CLIPS, condition, ("clip",), limit=last) if first < last else []
        wanted = [row["clip"] for row in rows[first:last]]
        clips = self.clips_by_id(wanted)
        return self.collection.count(CLIPS, condition), [clips[id] for id in wanted if id in clips]

    def clips(self, sort: str | None = None, **filters: Unpack[FilterArguments]) -> Iterator[Clip]:
        """See `Library.clips`; in any order, and none is sorted."""
        if sort is not None:
            self.sorted_ids(sort)
        for row in self.collection.all_rows(CLIPS, self.expression(filters), _OF_CLIP):
            yield clip_of(row)

    def clips_by_id(self, ids: Iterable[int]) -> dict[int, DistantClip]:  # type: ignore[override]
        """See `StoredLibrary.clips_by_id`."""
        wanted = list(dict.fromkeys(map(checked_clip_id, ids)))
        found: dict[int, DistantClip] = {}
        for first in range(0, len(wanted), MOST_ROWS):
            rows = self.collection.rows(CLIPS, among("clip", wanted[first : first + MOST_ROWS]), _OF_CLIP)
            found |= {row["clip"]: clip_of(row) for row in rows}
        if len(self._known) > _KEPT:
            self._known.clear()
        self._known |= found
        return {id: found[id] for id in wanted if id in found}

    def matches(self, ref: str | PathLike[str]) -> list[Clip]:
        """See `ClipFinder.matches`: "#number", a path in a root, perhaps after the root's name, or a name."""
        text = str(ref).replace("\\", "/")
        if text.startswith("#") and text[1:].isdecimal():
            return list(self.clips_by_id([int(text[1:])]).values())
        at = [like("path", text), like("name", text)]
        for root in self.root_names:
            if text.startswith(f"{root}/"):
                at.append(every([f"root == {quoted(root)}", like("path", text[len(root) + 1 :])]))
        found = [clip_of(row) for row in self.collection.rows(CLIPS, either(at), _OF_CLIP, limit=_CALLED)]
        by_path = [clip for clip in found if clip.name != text]
        return list(by_path or found)

    @property
    def root_names(self) -> list[str]:
        """See `ClipFinder.root_names`."""
        return list(self._together()["roots"])

    def reference(self, root: str, path: str) -> str:
        """See `ClipFinder.reference`."""
        return f"{root}/{path}" if root and len(self.root_names) > 1 else path

    # What is known of clips

    def captions(self, id: int) -> list[Caption]:
        """See `StoredLibrary.captions`."""
        return list(self._seen(id).captions)

    def marks(self, id: int) -> Marks:
        """See `StoredLibrary.marks`."""
        return self._seen(id).marks

    def _seen(self, id: int) -> DistantClip:
        """A clip as it was when it was last read."""
        found = self._known.get(int(id)) or self.clips_by_id([id]).get(int(id))
        if found is None:
            raise UnknownClip(f"{self.address}: no clip #{id}")
        return found

    def pose_chunks(self, id: int, first: int, last: int) -> list[bytes]:
        """See `StoredLibrary.pose_chunks`."""
        if self._poses is None:
            raise QueryError("no poses here; give the place that they were put into (--poses)")
        return self._poses.read(id)[first : last + 1]

    def windows(self, id: int) -> list[Windows]:
        """See `StoredLibrary.windows`."""
        clips = list(self.clips_by_id([id]).values())
        if not clips:
            raise UnknownClip(f"{self.address}: no clip #{id}")
        return self._windows_of(clips)[id]

    def _windows_of(self, clips: Sequence[DistantClip]) -> dict[int, list[Windows]]:
        """Clip -> its windows, shortest length first."""
        rows = self.collection.rows_of(WINDOWS, [clip.id for clip in clips])
        of_clips: dict[int, list[Row]] = {clip.id: [] for clip in clips}
        versions = {clip.id: clip.version for clip in clips}
        for row in rows:
            if row["version"] == versions[row["clip"]]:
                of_clips[row["clip"]].append(row)
        return {id: windows_of(rows) for id, rows in of_clips.items()}

    def source(self, ref: Ref, *, fps: float | None = None, up: str | None = None) -> MotionSource:
        """See `Library.source`; a file of this machine is read as it is."""
        if isinstance(ref, (str, PathLike)) and is_file(split_name(ref)[0]):
            return MotionSource.of_file(ref, fps=fps, up=up)
        return super().source(ref, fps=fps, up=up)

    def caption_vectors(self) -> CaptionVectors:
        """None: captions are in a collection as text alone."""
        return [], np.empty(0, np.int64), np.empty((0, self.collection.size), np.float32)

    def stats(self) -> dict[str, Any]:
        """As `StoredLibrary.stats`, of all libraries that write here, as each said at the end of its last run."""
        total, held = self._together(), self.collection
        known = ("roots", "captions", "failed", "windows", "formats", "rigs")
        return {
            "folder": str(self.address),
            "clips": len(self),
            "seconds": round(total["seconds"], 3),
            "gone": 0,
            "with_warnings": 0,
            "model": held.model,
            "fingerprint": held.fingerprint,
            "generation": self.generation,
            "bytes": 0,
        } | {name: total[name] for name in known}

    def mark_counts(self) -> dict[str, Any]:
        """See `MarkedLibrary.mark_counts`; as of the last run of each library that writes here."""
        total = self._together()
        return {name: total[name] for name in ("starred", "tags", "collections")}

    def _together(self) -> dict[str, Any]:
        return together(self.collection.summaries())

    # What is near

    def nearest_clips(
        self, queries: Vectors, k: int, *, allowed: Ids | None = None, exact: bool = False
    ) -> tuple[Vectors, NDArray[np.int64]]:
        """See `StoredLibrary.nearest_clips`; at most 16,384."""
        _refuse(exact)
        return self._index(CLIPS).search(queries, k, allowed=allowed)[:2]

    def nearest_windows(
        self, queries: Vectors, k: int, *, allowed: Ids | None = None, exact: bool = False
    ) -> tuple[Vectors, NDArray[np.int64], Vectors, Vectors]:
        """See `StoredLibrary.nearest_windows`; at most 16,384."""
        _refuse(exact)
        return self._index(WINDOWS).search(queries, k, allowed=allowed)

    def vectors_of(self, ids: Ids) -> tuple[IndexRows, IndexRows]:
        """See `StoredLibrary.vectors_of`; of clips that have gone meanwhile nothing."""
        clips, windows = (self.collection.rows_of(part, ids.tolist()) if len(ids) else [] for part in (CLIPS, WINDOWS))
        versions = {row["clip"]: row["version"] for row in clips}
        own = [row for row in windows if versions.get(row["clip"]) == row["version"]]
        return as_index_rows(clips, self.collection.size), as_index_rows(own, self.collection.size)

    def _index(self, part: str) -> MilvusIndex:
        return MilvusIndex(self.collection, part, self._condition)

    def text_matches(self, sentence: str, allowed: Ids | None) -> Mapping[int, TextMatch]:
        """See `Library.text_matches`: of clips that are called so as a whole."""
        text = sentence.strip()
        called = either([like("name", text), like("path", text), like("folded", folded(text))])
        rows = self.collection.rows(CLIPS, every([self._condition, called]), ("clip",), limit=_CALLED)
        return {row["clip"]: called_so() for row in rows}

    def _source_of(self, clip_id: int) -> MotionSource:
        found = self._sources([clip_id])
        if clip_id not in found:
            raise UnknownClip(f"{self.address}: clip #{clip_id} has just gone")
        return found[clip_id]

    def _sources(self, ids: Iterable[int]) -> dict[int, MotionSource]:
        clips = self.clips_by_id(ids)
        windows = self._windows_of(list(clips.values())) if clips else {}
        return {
            id: replace(MotionSource.of_clip(self, clip), _windows={self.bundle.fingerprint: windows[id]})
            for id, clip in clips.items()
            if windows[id]
        }


def _refuse(exact: bool) -> None:
    if exact:
        raise QueryError("exact: a collection is searched as its server has indexed it; leave it out")
