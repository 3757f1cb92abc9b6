"""The rows of a collection of Milvus: their fields, the form of a clip and its windows, and what is indexed.

Three partitions have rows of one form. "clips" has a row a clip, its vector as a whole and what is known of it;
"windows" a row a window, with what filters ask; "state" who has written what, and with which model.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

Row = dict[str, Any]

CLIPS, WINDOWS, STATE = "clips", "windows", "state"
#: Fields that every row has besides its key and vector; name -> type of Milvus and, for text, most bytes.
FIELDS: dict[str, tuple[str, int]] = {
    "clip": ("INT64", 0),
    "version": ("INT64", 0),
    "slot": ("INT64", 0),
    "start": ("FLOAT", 0),
    "end": ("FLOAT", 0),
    "length": ("FLOAT", 0),
    "duration": ("DOUBLE", 0),
    "root": ("VARCHAR", 1024),
    "path": ("VARCHAR", 8192),
    "folded": ("VARCHAR", 16384),
    "name": ("VARCHAR", 2048),
    "rig": ("VARCHAR", 2048),
    "format": ("VARCHAR", 64),
    "captioned": ("BOOL", 0),
    "starred": ("BOOL", 0),
    "splits": ("ARRAY", 1024),
    "tags": ("ARRAY", 1024),
    "collections": ("ARRAY", 1024),
    "document": ("JSON", 65_536),
}
#: What Milvus keeps lists of, to filter by.
_INDEXED = ("clip", "slot")
_MOST_OF_ARRAY = 256
#: The kind of index and its parameters: milvus-lite compares all rows, a server walks a graph (Malkov and Yashunin,
#: IEEE TPAMI 42, 2020).
_INDEX_OF_LITE: tuple[str, Row] = ("FLAT", {})
_INDEX: tuple[str, Row] = ("HNSW", {"M": 32, "efConstruction": 256})


@dataclass(frozen=True)
class StoredClip:
    """A clip as it goes into a collection.

    Attributes
    ----------
    fields : dict
        Those of `FIELDS` but for the span.
    vector : float16 array (D,)
    lengths, starts, ends : float32 arrays (n,)
        Of its windows, seconds; of which length of the grid each is.
    vectors : float16 array (n, D)
    """

    fields: Row
    vector: NDArray[np.float16]
    lengths: NDArray[np.float32]
    starts: NDArray[np.float32]
    ends: NDArray[np.float32]
    vectors: NDArray[np.float16]

    def clip_row(self) -> Row:
        """The row of the clip as a whole."""
        end = self.fields["duration"]
        return self._row(f"{self.fields['clip']:x}", self.vector, 0.0, end, 0.0, self.fields["document"])

    def window_rows(self) -> Iterator[Row]:
        """The rows of its windows."""
        parts = zip(self.vectors, self.starts.tolist(), self.ends.tolist(), self.lengths.tolist(), strict=True)
        for number, (vector, start, end, length) in enumerate(parts):
            key = f"{self.fields['clip']:x}.{self.fields['version']:x}.{number:x}"
            yield self._row(key, vector, start, end, length, {})

    def _row(self, key: str, vector: Any, start: float, end: float, length: float, document: Row) -> Row:
        span = {"start": start, "end": end, "length": length, "document": document}
        return self.fields | span | {"key": key, "vector": vector.astype(np.float32)}


def state_row(key: str, document: Row, size: int) -> Row:
    """A row that holds no clip but what a library or the collection says of itself."""
    blank = {"VARCHAR": "", "ARRAY": [], "JSON": document, "BOOL": False}
    row = {field: blank.get(kind, 0) for field, (kind, _) in FIELDS.items()}
    vector = np.zeros(size, np.float32)
    vector[0] = 1.0
    return row | {"key": key, "vector": vector, "length": -1.0}


def schema_of(size: int, *, is_lite: bool) -> tuple[Any, Any]:
    """The schema and the indexes of a collection of vectors of `size` numbers, as pymilvus takes them."""
    from pymilvus import DataType, MilvusClient

    schema = MilvusClient.create_schema(auto_id=False, enable_dynamic_field=False)
    schema.add_field("key", DataType.VARCHAR, max_length=64, is_primary=True)
    schema.add_field("vector", DataType.FLOAT_VECTOR, dim=size)
    for field, (kind, most) in FIELDS.items():
        bounded = {"max_length": most} if kind in ("VARCHAR", "ARRAY") else {}
        if kind == "ARRAY":
            bounded |= {"element_type": DataType.VARCHAR, "max_capacity": _MOST_OF_ARRAY}
        schema.add_field(field, getattr(DataType, kind), **bounded)
    index = MilvusClient.prepare_index_params()
    kind, parameters = _INDEX_OF_LITE if is_lite else _INDEX
    index.add_index("vector", index_type=kind, metric_type="IP", params=parameters)
    for field in _INDEXED:
        index.add_index(field, index_type="INVERTED")
    return schema, index
