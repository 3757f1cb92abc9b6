"""glTF accessors as arrays: any component type, normalized, strided or sparse; checked before anything is allocated."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from indexer.formats.gltf.gltf_container import Document

#: An accessor may hold so many elements: 12 hours at 240 frames a second.
MAX_COUNT = 12 * 3600 * 240
_COMPONENTS = {5120: "<i1", 5121: "<u1", 5122: "<i2", 5123: "<u2", 5125: "<u4", 5126: "<f4"}
_SIZES = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4, "MAT2": 4, "MAT3": 9, "MAT4": 16}
_INDICES = (5121, 5123, 5125)
_COMPRESSIONS = ("EXT_meshopt_compression", "KHR_meshopt_compression")


def read_accessor(document: Document, number: int, kind: str) -> NDArray[np.float64]:
    """The elements of an accessor as numbers (count, components); normalized integers become 0 to 1 or -1 to 1.

    Parameters
    ----------
    document : Document
    number : int
        Which accessor.
    kind : str
        What its type must be: "SCALAR", "VEC3", "VEC4" or "MAT4".

    Raises
    ------
    UnreadableMotion
        If it is of another type, lies outside its buffer, is compressed, or holds values that are no numbers.
    """
    accessors = document.rows(document.json, "accessors")
    row = accessors[document.number({"accessor": number}, "accessor", len(accessors))]
    if row.get("type") != kind or kind not in _SIZES:
        raise document.damaged(f"accessor {number} is {str(row.get('type'))[:10]}, not {kind}")
    count, size = document.whole(row, "count"), _SIZES[kind]
    if not 0 < count <= MAX_COUNT:
        raise document.damaged(f"accessor {number} has {count} elements")
    document.spend(count * size)
    component = document.whole(row, "componentType")
    values = _elements(document, row, component, count, size).copy()
    sparse = document.row(row, "sparse")
    if sparse:
        _replace(document, sparse, component, values)
    numbers: NDArray[np.float64] = values.astype(np.float64)
    if row.get("normalized") is True and values.dtype.kind in "iu":
        numbers = np.maximum(numbers / np.iinfo(values.dtype).max, -1.0)
    if not np.isfinite(numbers).all():
        raise document.damaged(f"accessor {number} holds values that are no numbers")
    return numbers


def _replace(document: Document, sparse: dict[str, Any], component: int, values: NDArray[Any]) -> None:
    """Put the few elements that a sparse accessor gives in their places."""
    count = document.whole(sparse, "count")
    if count > len(values):
        raise document.damaged(f"a sparse accessor replaces {count} of {len(values)} elements")
    indices, given = document.row(sparse, "indices"), document.row(sparse, "values")
    kind = document.whole(indices, "componentType")
    if "bufferView" not in indices or "bufferView" not in given or kind not in _INDICES:
        raise document.damaged("a sparse accessor has no indices or values")
    at = _elements(document, indices, kind, count, 1)[:, 0]
    if count and int(at.max()) >= len(values):
        raise document.damaged("a sparse accessor replaces elements that are not there")
    values[at] = _elements(document, given, component, count, values.shape[1])


def _elements(document: Document, row: dict[str, Any], component: int, count: int, size: int) -> NDArray[Any]:
    """Elements (count, size) as they are stored, seen in place; zeros without a buffer view."""
    if component not in _COMPONENTS:
        raise document.damaged(f"there is no component type {component}")
    dtype = np.dtype(_COMPONENTS[component])
    if "bufferView" not in row or not count:
        return np.broadcast_to(np.zeros((), dtype), (count, size))
    views = document.rows(document.json, "bufferViews")
    view = views[document.number(row, "bufferView", len(views))]
    for name in _COMPRESSIONS:
        if name in document.row(view, "extensions"):
            raise document.error(f"its animation is compressed ({name}); export it without compression")
    offset, length = document.whole(view, "byteOffset", 0), document.whole(view, "byteLength")
    start, width = document.whole(row, "byteOffset", 0), size * dtype.itemsize
    stride = document.whole(view, "byteStride", 0) or width
    if start + stride * (count - 1) + width > length:
        raise document.damaged("an accessor is longer than its buffer view")
    data = document.buffer(document.whole(view, "buffer"))
    if offset + length > len(data):
        raise document.damaged("a buffer view is longer than its buffer")
    elements: NDArray[Any] = np.ndarray((count, size), dtype, data, offset + start, (stride, dtype.itemsize))
    return elements
