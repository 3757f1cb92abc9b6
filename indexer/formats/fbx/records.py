"""Records: the tree that a FBX file is, binary or text. A record has a name, values, and records within it."""

from __future__ import annotations

import zlib
from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

#: What is read of a file, None for a record with all that is in it; meshes, textures and the like are passed over.
Wanted = dict[str, Any]
#: The arrays of a curve, and what it does beyond its keys.
CURVE = ("KeyTime", "KeyValueFloat", "KeyAttrFlags", "KeyAttrDataFloat", "KeyAttrRefCount",
         "Pre-Extrapolation", "Post-Extrapolation")  # fmt: skip
_ROWS: Wanted = {"P": None, "Property": None}
_PROPERTIES: Wanted = {"Properties60": _ROWS, "Properties70": _ROWS}
#: The properties that are read of objects.
PROPERTIES = frozenset(
    """
    Lcl Translation|Lcl Rotation|Lcl Scaling|PreRotation|PostRotation|RotationOrder|InheritType
    RotationOffset|RotationPivot|ScalingOffset|ScalingPivot
    UpAxis|UpAxisSign|UnitScaleFactor|TimeMode|CustomFrameRate|LocalStart|LocalStop|ReferenceStart|ReferenceStop
    BlendMode|Weight|RotationAccumulationMode|ScaleAccumulationMode
    """.strip().replace("\n    ", "|").split("|")
) | {"d|X", "d|Y", "d|Z", "d|Weight"}  # fmt: skip
WANTED: Wanted = {
    "FBXHeaderExtension": {"FBXVersion": None, "OtherFlags": None},
    "GlobalSettings": _PROPERTIES,
    "Definitions": {"ObjectType": {"PropertyTemplate": _PROPERTIES}},
    "Objects": {
        "Model": _PROPERTIES,
        "Deformer": {"TransformLink": None},
        "Pose": None,
        "GlobalSettings": _PROPERTIES,
        "AnimationStack": _PROPERTIES,
        "AnimationLayer": _PROPERTIES,
        "AnimationCurveNode": _PROPERTIES,
        "AnimationCurve": dict.fromkeys(CURVE),
        "Constraint": {},
    },
    "Connections": None,
    "Takes": None,
}
MAX_DEPTH = 40
MAX_RECORDS = 2_000_000
MAX_UNPACKED = 400 << 20

_KINDS = {"f": "<f4", "d": "<f8", "l": "<i8", "i": "<i4", "b": "?", "c": "u1"}


class DamagedFbx(ValueError):
    """The file is not what the format says; the message says where."""


class Record:
    """A name, values (numbers, texts, arrays), and records within it."""

    __slots__ = ("children", "name", "values")

    def __init__(self, name: str, values: list[Any], children: Sequence[Record] = ()) -> None:
        self.name = name
        self.values = values
        self.children = children

    def find(self, name: str) -> Record | None:
        """The first record of a name within this one."""
        for child in self.children:
            if child.name == name:
                return child
        return None

    def all(self, name: str) -> list[Record]:
        """All records of a name within this one."""
        return [child for child in self.children if child.name == name]

    def text(self, at: int) -> str:
        """The value at a place, where that is a text; else an empty one."""
        value = self.values[at] if len(self.values) > at else ""
        return value if isinstance(value, str) else ""

    def numbers(self, name: str, dtype: str) -> NDArray[Any]:
        """The numbers that the record of a name within this one holds; none where there is none."""
        child = self.find(name)
        if child is None or not child.values:
            return np.empty(0, dtype)
        first = child.values[0]
        try:
            if isinstance(first, PackedArray):
                return first.unpack().astype(dtype, copy=False)
            return np.asarray(first if isinstance(first, np.ndarray) else child.values).astype(dtype, copy=False)
        except (TypeError, ValueError, OverflowError):
            raise DamagedFbx(f"{self.name} holds a {name} of other things than numbers") from None

    def number(self, name: str, default: float) -> float:
        """The number that the record of a name within this one holds."""
        child = self.find(name)
        value = child.values[0] if child is not None and child.values else default
        return float(value) if isinstance(value, (int, float)) and abs(value) < 1e300 else default


class Unpacker:
    """Unpacks arrays: each of equal content once, and no more in all than memory bears."""

    def __init__(self) -> None:
        self._left = MAX_UNPACKED
        self._known: dict[tuple[str, bytes], NDArray[Any]] = {}

    def unpack(self, packed: PackedArray) -> NDArray[Any]:
        """The array, read-only."""
        key = packed.kind, packed.data
        if key not in self._known:
            self._known[key] = self._array(packed)
        return self._known[key]

    def _array(self, packed: PackedArray) -> NDArray[Any]:
        dtype = np.dtype(_KINDS[packed.kind])
        size = packed.length * dtype.itemsize
        data = packed.data
        if packed.is_packed:
            self._left -= size
            if self._left < 0:
                raise DamagedFbx(f"its arrays take more than {MAX_UNPACKED >> 20} MB")
            try:
                data = zlib.decompressobj().decompress(data, size + 1)
            except zlib.error as error:
                raise DamagedFbx(f"an array cannot be unpacked: {error}") from None
        if len(data) != size:
            raise DamagedFbx(f"an array of {packed.length} numbers holds others")
        return np.frombuffer(data, dtype)


class PackedArray(NamedTuple):
    """An array as it stands in a binary file."""

    kind: str
    length: int
    is_packed: bool
    data: bytes
    unpacker: Unpacker

    def unpack(self) -> NDArray[Any]:
        """Its numbers, read-only; arrays of equal content are one object."""
        return self.unpacker.unpack(self)
