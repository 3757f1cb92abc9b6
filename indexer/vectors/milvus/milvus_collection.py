"""MilvusCollection: the clips of any number of libraries in one collection of Milvus, with all that hits show of them.

`collection_schema` says what its rows are.

Milvus has no transactions. So a clip is what its one row says: windows name the version of the clip that they belong
to, and those of another version are not there for readers. What changes a clip writes its new windows first, then its
row, and removes the old windows last. Ended anywhere, it leaves the old clip or the new one, and at most windows that
nobody sees and the next run of that library removes.
"""

from __future__ import annotations

import os
import time
from collections.abc import Iterator, Sequence
from hashlib import blake2b
from itertools import islice
from typing import Any

import numpy as np
from numpy.typing import NDArray

from encoders.errors import BundleMismatch, LibraryError, LibraryNotFound
from indexer.vectors.milvus.collection_schema import CLIPS, STATE, WINDOWS, Row, StoredClip, schema_of, state_row
from indexer.vectors.milvus.expressions import among, every
from indexer.vectors.milvus.milvus_address import MilvusAddress
from indexer.vectors.milvus.milvus_server import TIMEOUT, MilvusServer

#: What tells the rows of a partition: the length of a window, nothing for a clip as a whole.
_OF_PART = {CLIPS: "length == 0", WINDOWS: "length > 0"}
#: The most rows that Milvus answers with at once.
MOST_ROWS = 16_384
#: Rows that are written in one call, and clips whose rows are looked for in one.
_WRITTEN, _CLIPS_ASKED = 512, 512
_FORMAT = 1
_ABOUT = "about"


class MilvusCollection:
    """A collection that is read and written. Safe to share between threads.

    Raises
    ------
    LibraryNotFound
        If there is none, and `create` is not given.
    LibraryError
        If it cannot be reached, is none of ours, or is of another version.
    BundleMismatch
        If it holds the vectors of another model than the one that is given.
    """

    def __init__(
        self,
        address: MilvusAddress,
        *,
        create: tuple[str, str, int] | None = None,
        timeout: float = TIMEOUT,
    ) -> None:
        self.address = address
        missing = LibraryNotFound(
            f"{address}: no such collection; 'motionseek index FOLDER --vectors {address}' makes it"
        )
        if create is None and address.is_file and not os.path.exists(address.uri):
            raise missing  # milvus-lite would make the file
        self._server = MilvusServer(address, timeout=timeout)
        try:
            there = self._call("has_collection")
            if not there and create is None:
                raise missing
            if create is not None and not (there and self._is_whole()):
                self._create(create)  # also where whoever began to make it was cut off
            self._call("load_collection")
            about = self._about()
            self.fingerprint, self.model, self.size = str(about["fingerprint"]), str(about["model"]), int(about["size"])
            if create is not None and create[0] != self.fingerprint:
                raise BundleMismatch(
                    f"{address}: holds vectors of the model {self.model} ({self.fingerprint[:12]}), not of {create[1]} "
                    f"({create[0][:12]}); index into another collection, and serve that one when it is full"
                )
            self._search_parameters = self._parameters()
        except BaseException:
            self.close()
            raise

    def close(self) -> None:
        """End the connection."""
        self._server.close()

    @property
    def is_lite(self) -> bool:
        """Whether milvus-lite answers rather than a server."""
        return self._server.is_lite

    def generation(self) -> int:
        """A number of 48 bits that is another one after each run that wrote, of whichever library."""
        written = sorted((row["key"], row["document"].get("written", "")) for row in self._state())
        return int.from_bytes(blake2b(repr(written).encode(), digest_size=6).digest(), "little")

    def summaries(self) -> list[Row]:
        """What each library that writes here says of itself, the last one that did so last."""
        said = [row["document"] for row in self._state() if row["key"] != _ABOUT]
        return [document["summary"] for document in sorted(said, key=lambda document: document["written"])]

    def was_cut_off(self, library: str) -> bool:
        """Whether the last run of a library has begun to write and not ended."""
        return any(row["document"].get("open", False) for row in self._state() if row["key"] == library)

    def record_run(self, library: str, summary: Row, *, is_open: bool = False) -> None:
        """Say that a library has written, or is about to; caches of readers are stale from now on."""
        self._write_state(library, {"written": f"{time.time_ns():x}", "summary": summary, "open": is_open})

    def count(self, part: str, condition: str = "") -> int:
        """How many rows of a partition meet a condition."""
        these = every([_OF_PART[part], condition])  # milvus-lite counts the rows of all partitions
        options = {"partition_names": [part], "output_fields": ["count(*)"], "consistency_level": "Strong"}
        return int(self._call("query", filter=these, **options)[0]["count(*)"])

    def rows(
        self, part: str, condition: str, fields: Sequence[str], *, limit: int = MOST_ROWS, strong: bool = False
    ) -> list[Row]:
        """Rows of a partition that meet a condition, at most `limit`; in any order."""
        level = "Strong" if strong else "Bounded"
        options = {"partition_names": [part], "output_fields": list(fields), "consistency_level": level}
        return list(self._call("query", filter=condition, limit=limit, **options))

    def all_rows(self, part: str, condition: str, fields: Sequence[str]) -> Iterator[Row]:
        """All rows of a partition that meet a condition, however many; in any order, each once."""
        options = {"partition_names": [part], "output_fields": list(fields), "consistency_level": "Strong"}
        iterator = self._call("query_iterator", filter=condition, batch_size=MOST_ROWS // 4, **options)
        try:
            while rows := self._server.guarded(iterator.next):
                yield from rows
        finally:
            self._server.guarded(iterator.close)

    def rows_of(self, part: str, clips: Sequence[int]) -> list[Row]:
        """The spans, lengths and vectors of all rows of some clips, with their versions."""
        asked, fields = among("clip", clips), ("clip", "version", "start", "end", "length", "vector")
        rows = self.rows(part, asked, fields)
        return rows if len(rows) < MOST_ROWS else list(self.all_rows(part, asked, fields))

    def versions(self, clips: Sequence[int], *, strong: bool = False) -> dict[int, Row]:
        """Of clips that are there: clip -> its version, root and path."""
        found: dict[int, Row] = {}
        for first in range(0, len(clips), _CLIPS_ASKED):
            asked = among("clip", clips[first : first + _CLIPS_ASKED])
            rows = self.rows(CLIPS, asked, ("clip", "version", "root", "path"), strong=strong)
            found |= {row["clip"]: row for row in rows}
        return found

    def nearest(self, part: str, queries: NDArray[np.float32], k: int, condition: str) -> list[list[Row]]:
        """The rows of a partition nearest to each query, best first, with their scores as "distance"."""
        found = self._call(
            "search",
            data=list(np.ascontiguousarray(queries, np.float32)),
            anns_field="vector",
            filter=condition,
            limit=min(k, MOST_ROWS),
            output_fields=["clip", "version", "start", "end"],
            partition_names=[part],
            search_params={"metric_type": "IP", "params": self._search_parameters(k)},
            consistency_level="Bounded",
        )
        return [[dict(hit["entity"]) | {"distance": hit["distance"]} for hit in hits] for hits in found]

    def put(self, clips: Sequence[StoredClip]) -> list[StoredClip]:
        """Store clips in place of those of the same number; the ones that another clip's number forbids to store."""
        before = self.versions([clip.fields["clip"] for clip in clips], strong=True)
        held = {number: (row["root"], row["path"]) for number, row in before.items()}
        stored: list[StoredClip] = []
        refused: list[StoredClip] = []
        for clip in clips:
            own = clip.fields["root"], clip.fields["path"]
            (stored if held.setdefault(clip.fields["clip"], own) == own else refused).append(clip)
        self._upsert(WINDOWS, (row for clip in stored for row in clip.window_rows()))
        self._upsert(CLIPS, (clip.clip_row() for clip in stored))
        replaced = [clip for clip in stored if clip.fields["clip"] in before]
        self.remove_windows_but([(clip.fields["clip"], clip.fields["version"]) for clip in replaced])
        return refused

    def remove(self, clips: Sequence[int]) -> None:
        """Remove clips with their windows."""
        for first in range(0, len(clips), _CLIPS_ASKED):
            some = among("clip", clips[first : first + _CLIPS_ASKED])
            for part in (CLIPS, WINDOWS):
                self._call("delete", filter=some, partition_name=part)

    def remove_windows_but(self, versions: Sequence[tuple[int, int]]) -> None:
        """Remove the windows of clips that are of no version given: pairs of a clip and its version, -1 for none."""
        for first in range(0, len(versions), _CLIPS_ASKED):
            some = versions[first : first + _CLIPS_ASKED]
            kept = f"version not in [{', '.join(str(version) for _, version in some)}]"
            self._call(
                "delete", filter=every([among("clip", [clip for clip, _ in some]), kept]), partition_name=WINDOWS
            )

    def _upsert(self, part: str, rows: Iterator[Row]) -> None:
        while written := list(islice(rows, _WRITTEN)):
            self._call("upsert", data=written, partition_name=part)

    def _call(self, method: str, **options: Any) -> Any:
        return self._server.call(method, self.address.collection, **options)

    def _create(self, model: tuple[str, str, int]) -> None:
        """Make the collection; where others do so at the same time, it is theirs."""
        fingerprint, name, size = model
        self.size = size
        schema, index = schema_of(size, is_lite=self.is_lite)
        try:
            if not self._call("has_collection"):
                self._call("create_collection", schema=schema, index_params=index, consistency_level="Bounded")
        except LibraryError:
            if not self._call("has_collection"):
                raise
        for part in (CLIPS, WINDOWS, STATE):
            try:
                self._call("create_partition", partition_name=part)
            except LibraryError:
                if not self._call("has_partition", partition_name=part):
                    raise
        self._call("load_collection")
        if not any(row["key"] == _ABOUT for row in self._state()):
            self._write_state(_ABOUT, {"format": _FORMAT, "fingerprint": fingerprint, "model": name, "size": size})

    def _is_whole(self) -> bool:
        """Whether the collection has been made to its end."""
        if not self._call("has_partition", partition_name=STATE):
            return False
        self._call("load_collection")
        return any(row["key"] == _ABOUT for row in self._state())

    def _about(self) -> Row:
        """What the collection is; waits a little for whoever is making it at this moment."""
        for _ in range(20):
            about = next((row["document"] for row in self._state() if row["key"] == _ABOUT), None)
            if about is not None:
                break
            time.sleep(0.1)
        if about is None or about.get("format") != _FORMAT:
            raise LibraryError(
                f"{self.address}: is no collection of this version of motionseek; index into another one"
            )
        return dict(about)

    def _state(self) -> list[Row]:
        try:
            return self.rows(STATE, "", ("key", "document"), strong=True)
        except LibraryError as error:
            if "partition" not in str(error).lower():
                raise
            return []

    def _write_state(self, key: str, document: Row) -> None:
        self._call("upsert", data=[state_row(key, document, self.size)], partition_name=STATE)

    def _parameters(self) -> Any:
        """k -> how far the index of the collection is searched for so many rows."""
        described = self._call("describe_index", index_name="vector")
        kind = str((described or {}).get("index_type", "FLAT"))

        def parameters(k: int) -> Row:
            if kind.startswith("HNSW"):
                return {"ef": max(2 * k, 512)}  # 128 miss a fifth: benchmarks/growth.py
            return {"nprobe": 64} if kind.startswith("IVF") else {}

        return parameters
