"""Bring a collection in step with a library: what it lacks is put there, and what the library has no more is removed.

Nothing is remembered between two runs: the versions of all clips are compared, so that what was cut off, lost or
restored from a backup is mended by the next run.
"""

from __future__ import annotations

import json
import sqlite3
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from itertools import groupby
from operator import itemgetter
from typing import Any

import numpy as np

from encoders.bundle.windows import ends_of
from encoders.errors import ArgumentError
from indexer.shards.collection_rows import fields_of
from indexer.shards.pose_files import PoseFiles
from indexer.shards.shard import Shard
from indexer.shards.summaries import summary_of
from indexer.store.clips import Caption
from indexer.store.marks import marks_table
from indexer.store.marks.marks_table import NO_MARKS
from indexer.store.stored_library import StoredLibrary
from indexer.store.tables.digests import digest
from indexer.vectors.milvus.collection_schema import CLIPS, WINDOWS, Row, StoredClip
from indexer.vectors.milvus.expressions import among, every
from indexer.vectors.milvus.milvus_collection import MilvusCollection

#: Clips that are read, and sent, at once.
_READ, _SENT = 500, 64

_OF_CLIPS = "clip_id IN ({ids})"
_OF_MODEL = f"model_id = (SELECT value FROM settings WHERE key = 'model') AND {_OF_CLIPS}"
_CAPTIONS = (
    'SELECT clip_id, texts.text, captions.start, captions."end" FROM captions JOIN texts ON texts.id = text_id '
    f"WHERE {_OF_CLIPS} ORDER BY clip_id, captions.id"
)
_SPLITS = f"SELECT DISTINCT clip_id, split FROM captions WHERE split IS NOT NULL AND {_OF_CLIPS} ORDER BY 1, 2"
_POSES = f"SELECT clip_id, data FROM poses WHERE {_OF_CLIPS} ORDER BY clip_id, chunk"
_VECTORS = f"SELECT clip_id, vector FROM embeddings WHERE {_OF_MODEL} ORDER BY clip_id"
_WINDOWS = f"SELECT clip_id, length, starts, vectors FROM windows WHERE {_OF_MODEL} ORDER BY clip_id, length"
_VECTOR_DIGESTS = f"SELECT clip_id, digest FROM embeddings WHERE {_OF_MODEL} ORDER BY clip_id"
_WINDOW_DIGESTS = f"SELECT clip_id, digest, length(starts) / 4 FROM windows WHERE {_OF_MODEL} ORDER BY clip_id, length"

#: Called with clips compared, and clips to compare.
Counted = Callable[[int, int], None]


@dataclass
class Sent:
    """What a run has changed in a collection.

    Attributes
    ----------
    put, removed : int
        Clips.
    refused : list of (path, reason)
        Clips that a collection cannot take.
    """

    put: int = 0
    removed: int = 0
    refused: list[tuple[str, str]] = field(default_factory=list)


def bring_in_step(
    library: StoredLibrary,
    collection: MilvusCollection,
    shard: Shard,
    *,
    poses: PoseFiles | None = None,
    complete: bool = True,
    thorough: bool = False,
    progress: Counted | None = None,
) -> Sent:
    """Put the clips of a library, those of its shard, into a collection, and remove those that it has no more.

    Parameters
    ----------
    poses : PoseFiles, optional
        Where their poses go.
    complete : bool
        Whether the library has all files of its shard. If not, nothing is removed.
    thorough : bool
        Count the windows of every clip, too, and remove those that belong to none; so does the run after one that was
        cut off.

    Raises
    ------
    LibraryError
        If the collection cannot be reached. What was put is there, the rest is put by the next run.
    """
    sent, identity = Sent(), _identity(library)
    with library.reading() as db:
        there, summary = _versions(library, collection, shard), summary_of(library, shard)
        thorough = thorough or collection.was_cut_off(identity)
        windows = _windows_there(library, collection, shard) if thorough else {}
        collection.record_run(identity, summary, is_open=True)
        kept: dict[int, int] = {}
        changed: list[tuple[int, Row]] = []
        total = len(library)
        for done, (id, fields, count) in enumerate(_described(library, db, shard, sent), start=1):
            number, version = fields["clip"], fields["version"]
            kept[number] = version
            is_there = there.pop(number, None) == version and (poses is None or poses.has(number))
            if not is_there or (thorough and windows.get(number, {}).get(version, 0) != count):
                changed.append((id, fields))
            if len(changed) == _SENT:
                _put(db, collection, changed, poses, sent)
                changed = []
            if progress is not None:
                progress(done, total)
        _put(db, collection, changed, poses, sent)
        if complete:
            collection.remove(list(there))
            for clip in there:
                if poses is not None:
                    poses.remove(clip)
            sent.removed = len(there)
        left = [clip for clip, versions in windows.items() if clip not in there and versions.keys() - {kept.get(clip)}]
        collection.remove_windows_but([(clip, kept.get(clip, -1)) for clip in left])
        collection.record_run(identity, summary)
    return sent


def out_of_step(library: StoredLibrary, collection: MilvusCollection, shard: Shard) -> list[tuple[str, str]]:
    """What a collection has otherwise than the library, by path: clips, and windows that are too many or too few."""
    found: list[tuple[str, str]] = []
    with library.reading() as db:
        there, windows = _versions(library, collection, shard), _windows_there(library, collection, shard)
        for _, fields, count in _described(library, db, shard, Sent()):
            held = there.pop(fields["clip"], None)
            own = windows.pop(fields["clip"], {})
            if held is None:
                found.append((fields["path"], "is not in the collection"))
            elif held != fields["version"]:
                found.append((fields["path"], "is in the collection as it was before"))
            elif own != {held: count}:
                found.append((fields["path"], "has other windows in the collection"))
    left = sorted(there.keys() | windows.keys())
    named = {clip: row["path"] for clip, row in collection.versions(left).items()}
    return found + [(named.get(clip, f"#{clip}"), "is in the collection and not in the library") for clip in left]


def _versions(library: StoredLibrary, collection: MilvusCollection, shard: Shard) -> dict[int, int]:
    """Clip -> version, of those in the collection that are this library's to keep."""
    return {
        row["clip"]: row["version"] for row in collection.all_rows(CLIPS, _own(library, shard), ("clip", "version"))
    }


def _windows_there(library: StoredLibrary, collection: MilvusCollection, shard: Shard) -> dict[int, dict[int, int]]:
    """Clip -> version -> how many windows of it there are."""
    found: dict[int, dict[int, int]] = {}
    for row in collection.all_rows(WINDOWS, _own(library, shard), ("clip", "version")):
        of_clip = found.setdefault(row["clip"], {})
        of_clip[row["version"]] = of_clip.get(row["version"], 0) + 1
    return found


def _own(library: StoredLibrary, shard: Shard) -> str:
    """The rows that are a library's to keep: of its roots, in the slots of its shard."""
    names = library.all_root_names
    return every([among("root", names), "" if shard.is_whole else among("slot", sorted(shard.slots))])


def _described(
    library: StoredLibrary, db: sqlite3.Connection, shard: Shard, sent: Sent
) -> Iterator[tuple[int, Row, int]]:
    """The number here, the fields and the number of windows of each clip of the shard.

    The version is of what a clip is, what is said of it, and its vectors.
    """
    ids = library.ids().tolist()
    for first in range(0, len(ids), _READ):
        some = ids[first : first + _READ]
        captions, splits, marks = _rows(db, _CAPTIONS, some), _rows(db, _SPLITS, some), marks_table.of_clips(db, some)
        wholes, windows = _rows(db, _VECTOR_DIGESTS, some), _rows(db, _WINDOW_DIGESTS, some)
        for id, clip in library.clips_by_id(some).items():
            said = [Caption(*row) for row in captions.get(id, ())]
            try:
                fields = fields_of(clip, said, marks.get(id, NO_MARKS), [row[0] for row in splits.get(id, ())])
            except ArgumentError as error:
                sent.refused.append((clip.path, str(error)))
                continue
            if shard.is_whole or fields["slot"] in shard.slots:
                content = json.dumps(fields, sort_keys=True, ensure_ascii=False)
                version = digest(content, repr(wholes.get(id)), repr(windows.get(id)))
                yield id, fields | {"version": version}, sum(row[1] for row in windows.get(id, ()))


def _put(
    db: sqlite3.Connection,
    collection: MilvusCollection,
    clips: Sequence[tuple[int, Row]],
    poses: PoseFiles | None,
    sent: Sent,
) -> None:
    ids = [id for id, _ in clips]
    wholes, windows = _rows(db, _VECTORS, ids), _rows(db, _WINDOWS, ids)
    chunks = {} if poses is None else _rows(db, _POSES, ids)
    for id, fields in clips:
        if poses is not None:
            poses.write(fields["clip"], [data for (data,) in chunks.get(id, ())])
    stored = [_stored(fields, wholes[id][0][0], windows.get(id, [])) for id, fields in clips if id in wholes]
    refused = collection.put(stored)
    sent.put += len(stored) - len(refused)
    sent.refused += [
        (clip.fields["path"], "has by chance the number of another clip of the collection; rename one of the two files")
        for clip in refused
    ]


def _stored(fields: Row, whole: bytes, windows: Sequence[Sequence[Any]]) -> StoredClip:
    size = len(whole) // 2
    starts = [np.frombuffer(begin, np.float32) for _, begin, _ in windows]
    ends = [ends_of(begin, length, fields["duration"]) for begin, (length, _, _) in zip(starts, windows, strict=True)]
    lengths = [np.full(len(begin), length, np.float32) for begin, (length, _, _) in zip(starts, windows, strict=True)]
    empty = np.empty(0, np.float32)
    return StoredClip(
        fields,
        np.frombuffer(whole, np.float16),
        np.concatenate([empty, *lengths]),
        np.concatenate([empty, *starts]),
        np.concatenate([empty, *ends]),
        np.frombuffer(b"".join(vectors for _, _, vectors in windows), np.float16).reshape(-1, size),
    )


def _rows(db: sqlite3.Connection, query: str, ids: Sequence[int]) -> dict[int, list[tuple[Any, ...]]]:
    """Clip -> the rest of its rows, of one of the queries above."""
    rows = db.execute(query.format(ids=",".join(map(str, ids))))
    return {id: [row[1:] for row in of_clip] for id, of_clip in groupby(rows, itemgetter(0))}


def _identity(library: StoredLibrary) -> str:
    (identity,) = library.connection.execute("SELECT value FROM settings WHERE key = 'identity'").fetchone()
    return f"library/{identity:x}"
