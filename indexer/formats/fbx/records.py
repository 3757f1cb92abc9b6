"""Records: the tree that a FBX file is, binary or text. A record has a name, values, and records within it."""

from __future__ import annotations

import zlib
from collections.abc import Sequence
from typing import Any

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

_DTYPES = {kind: np.dtype(name) for kind, name in zip("fdlibc", ("<f4", "<f8", "<i8", "<i4", "?", "u1"), strict=True)}


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


class Room:
    """How many bytes the arrays of a file may still take."""

    def __init__(self) -> None:
        self._left = MAX_UNPACKED

    def take(self, size: int) -> None:
        """Take some.

        Raises
        ------
        DamagedFbx
            Where so many are not left.
        """
        self._left -= size
        if self._left < 0:
            raise DamagedFbx(f"its arrays take more than {MAX_UNPACKED >> 20} MB")


class PackedArray:
    """An array as it stands in a binary file."""

    __slots__ = ("_data", "_is_packed", "_kind", "_length", "_numbers", "_room")

    def __init__(self, kind: str, length: int, is_packed: bool, data: bytes, room: Room) -> None:
        self._kind, self._length, self._is_packed, self._data, self._room = kind, length, is_packed, data, room
        self._numbers: NDArray[Any] | None = None

    def unpack(self) -> NDArray[Any]:
        """Its numbers, read-only."""
        if self._numbers is None:
            self._numbers = self._unpacked()
        return self._numbers

    def _unpacked(self) -> NDArray[Any]:
        dtype = _DTYPES[self._kind]
        size, data = self._length * dtype.itemsize, self._data
        if self._is_packed:
            self._room.take(size)
            try:
                data = zlib.decompressobj().decompress(data, size + 1)
            except zlib.error as error:
                raise DamagedFbx(f"an array cannot be unpacked: {error}") from None
        if len(data) != size:
            raise DamagedFbx(f"an array of {self._length} numbers holds others")
        return np.frombuffer(data, dtype)
