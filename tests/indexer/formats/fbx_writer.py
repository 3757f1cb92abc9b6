"""FBX files for tests: a scene in a few words becomes a binary or ASCII file of a version.

A tree of records is a list of `(name, values, children)`. Values are texts, whole numbers, numbers, `Char`, and arrays.
"""

from __future__ import annotations

import struct
import zlib
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

SECOND = 46_186_158_000
LINEAR, CUBIC_AUTO, CUBIC_USER, CUBIC_TCB, CONSTANT, CONSTANT_NEXT = 0x4, 0x108, 0x408, 0x208, 0x2, 0x102
BROKEN, CLAMP, TIME_INDEPENDENT, CLAMP_PROGRESSIVE = 0x800, 0x1000, 0x2000, 0x4000
WEIGHTED, NEXT_WEIGHTED = 0x1000000, 0x2000000

Tree = list[tuple[str, list[Any], "Tree"]]


class Char(str):
    """A letter that stands without quotes."""


@dataclass
class Keys:
    """A curve: times in seconds, values, and for each key flags and four numbers (slopes, weights ...)."""

    times: Sequence[float]
    values: Sequence[float]
    flags: int | Sequence[int] = LINEAR
    data: Sequence[Sequence[float]] = ((0.0, 0.0, 0.0, 0.0),)
    before: tuple[str, int] = ("C", -1)
    after: tuple[str, int] = ("C", -1)

    def ticks(self) -> list[int]:
        return [round(time * SECOND) for time in self.times]


@dataclass
class Node:
    """A model: its properties (`Lcl Translation` ...) and the curves of three of them, by axis."""

    name: str
    kind: str = "LimbNode"
    parent: str = ""
    properties: dict[str, Any] = field(default_factory=dict)


#: (model, property) -> values where no curve is, and curves by axis.
Moves = dict[tuple[str, str], dict[str, Any]]


@dataclass
class Layer:
    """A layer of a stack: what moves, and its own properties."""

    moves: Moves
    properties: dict[str, Any] = field(default_factory=dict)
    weight: Keys | None = None


@dataclass
class Stack:
    """An animation."""

    name: str
    layers: list[Layer]
    span: tuple[float, float] | None = None


SETTINGS = {"UpAxis": 1, "UpAxisSign": 1, "UnitScaleFactor": 1.0, "TimeMode": 3}


def weights(right: float, next_left: float) -> float:
    """Two weights in the bits of one number."""
    return float(np.array([round(right * 1e4) | round(next_left * 1e4) << 16], "<u4").view("<f4")[0])


def scene(nodes: Sequence[Node], stacks: Sequence[Stack], *, settings: dict[str, Any] | None = None) -> Tree:
    """The records of a scene, as FBX 7 has them."""
    numbers = iter(range(1000, 10**9))
    ids = {node.name: next(numbers) for node in nodes}
    objects: Tree = [
        ("Model", [ids[node.name], f"{node.name}\0\1Model", node.kind], [_properties(node.properties)])
        for node in nodes
    ]
    links: Tree = [("C", ["OO", ids[node.name], ids.get(node.parent, 0)], []) for node in nodes]
    for stack in stacks:
        stack_id = next(numbers)
        span = stack.span and {"LocalStart": round(stack.span[0] * SECOND), "LocalStop": round(stack.span[1] * SECOND)}
        objects.append(("AnimationStack", [stack_id, f"{stack.name}\0\1AnimStack", ""], [_properties(span or {})]))
        for layer in stack.layers:
            layer_id = next(numbers)
            objects.append(("AnimationLayer", [layer_id, "L\0\1AnimLayer", ""], [_properties(layer.properties)]))
            links.append(("C", ["OO", layer_id, stack_id], []))
            moves: list[tuple[int, str, dict[str, Any]]] = [(ids[n], p, m) for (n, p), m in layer.moves.items()]
            if layer.weight is not None:
                moves.append((layer_id, "Weight", {"Weight": layer.weight}))
            for target, name, axes in moves:
                node_id = next(numbers)
                defaults = {f"d|{axis}": value for axis, value in axes.items() if not isinstance(value, Keys)}
                objects.append(("AnimationCurveNode", [node_id, "T\0\1AnimCurveNode", ""], [_properties(defaults)]))
                links += [("C", ["OO", node_id, layer_id], []), ("C", ["OP", node_id, target, name], [])]
                for axis, keys in axes.items():
                    if isinstance(keys, Keys):
                        curve_id = next(numbers)
                        objects.append(("AnimationCurve", [curve_id, "\0\1AnimCurve", ""], _curve(keys)))
                        links.append(("C", ["OP", curve_id, node_id, f"d|{axis}"], []))
    return [
        ("FBXHeaderExtension", [], [("FBXHeaderVersion", [1003], []), ("FBXVersion", [7400], [])]),
        ("GlobalSettings", [], [_properties({**SETTINGS, **(settings or {})})]),
        ("Documents", [], [("Document", [1, "", "Scene"], [("RootNode", [0], [])])]),
        ("Objects", [], objects),
        ("Connections", [], links),
    ]


def _properties(stated: dict[str, Any]) -> tuple[str, list[Any], Tree]:
    rows: Tree = []
    for name, value in stated.items():
        values = list(value) if isinstance(value, (tuple, list)) else [value]
        kind = "double" if any(isinstance(v, float) for v in values) else "int"
        if any(abs(v) > 1 << 31 for v in values):
            kind = "KTime"
        kind = "Vector3D" if len(values) == 3 else kind
        kind = name if name.startswith("Lcl") else kind
        rows.append(("P", [name, kind, "", "A", *values], []))
    return ("Properties70", [], rows)


def _curve(keys: Keys) -> Tree:
    count = len(keys.times)
    flags = [keys.flags] if isinstance(keys.flags, int) else list(keys.flags)
    data = [list(row) for row in keys.data]
    runs = max(len(flags), len(data))
    flags, data = flags * (runs // len(flags)), data * (runs // len(data))
    rows: Tree = [
        ("Default", [0.0], []),
        ("KeyVer", [4009], []),
        ("KeyTime", [np.array(keys.ticks(), "<i8")], []),
        ("KeyValueFloat", [np.array(keys.values, "<f4")], []),
        ("KeyAttrFlags", [np.array(flags, "<i4")], []),
        ("KeyAttrDataFloat", [np.array(data, "<f4").ravel()], []),
        ("KeyAttrRefCount", [np.array([count] if runs == 1 else [1] * runs, "<i4")], []),
    ]
    for name, (mode, repeats) in (("Pre-Extrapolation", keys.before), ("Post-Extrapolation", keys.after)):
        if mode != "C":
            rows.append((name, [], [("Type", [Char(mode)], []), ("Repetition", [repeats], [])]))
    return rows


def scene_of_version_6(
    nodes: Sequence[Node], stacks: Sequence[Stack], *, settings: dict[str, Any] | None = None
) -> Tree:
    """The records of a scene, as FBX 6 has them: one layer a take, keys of a few kinds."""
    objects: Tree = [
        ("Model", [f"{node.name}\0\1Model", node.kind], [_old_properties(node.properties)]) for node in nodes
    ]
    objects.append(("GlobalSettings", [], [_old_properties({**SETTINGS, **(settings or {})})]))
    links: Tree = [
        ("Connect", ["OO", f"{node.name}\0\1Model", f"{node.parent or 'Scene'}\0\1Model"], []) for node in nodes
    ]
    takes: Tree = [("Current", [stacks[0].name if stacks else ""], [])]
    for stack in stacks:
        span = stack.span or (0.0, 1.0)
        rows: Tree = [("LocalTime", [round(time * SECOND) for time in span], [])]
        for node in nodes:
            channels: Tree = []
            for letter, name in (("T", "Lcl Translation"), ("R", "Lcl Rotation"), ("S", "Lcl Scaling")):
                axes = stack.layers[0].moves.get((node.name, name))
                if axes is not None:
                    inner: Tree = [("Channel", [axis], _old_curve(axes.get(axis, 0.0))) for axis in "XYZ"]
                    channels.append(("Channel", [letter], [*inner, ("LayerType", [1], [])]))
            if channels:
                rows.append(("Model", [f"{node.name}\0\1Model"], [("Channel", ["Transform"], channels)]))
        takes.append(("Take", [stack.name], rows))
    return [
        ("FBXHeaderExtension", [], [("FBXHeaderVersion", [1003], []), ("FBXVersion", [6100], [])]),
        ("Objects", [], objects),
        ("Connections", [], links),
        ("Takes", [], takes),
    ]


def _old_properties(stated: dict[str, Any]) -> tuple[str, list[Any], Tree]:
    _, _, rows = _properties(stated)
    return ("Properties60", [], [("Property", [*row[1][:2], "A+", *row[1][4:]], []) for row in rows])


def _old_curve(keys: Keys | float) -> Tree:
    if not isinstance(keys, Keys):
        return [("Default", [float(keys)], [])]
    flags = [keys.flags] * len(keys.times) if isinstance(keys.flags, int) else list(keys.flags)
    data = list(keys.data) * (len(keys.times) if len(keys.data) == 1 else 1)
    entries: list[Any] = []
    for time, value, flag, row in zip(keys.ticks(), keys.values, flags, data, strict=True):
        kinds: dict[int, list[Any]] = {
            LINEAR: [Char("L")],
            CONSTANT: [Char("C"), Char("s")],
            CONSTANT_NEXT: [Char("C"), Char("n")],
            CUBIC_USER: [Char("U"), Char("s"), float(row[0]), float(row[1]), Char("n")],
            CUBIC_USER | WEIGHTED: [Char("U"), Char("s"), *map(float, row[:2]), Char("a"), *map(float, row[2:])],
            CUBIC_AUTO: [Char("U"), Char("a"), Char("n")],
        }
        entries += [time, float(value), *kinds[flag]]
    return [
        ("Default", [0.0], []),
        ("KeyVer", [4005], []),
        ("KeyCount", [len(keys.times)], []),
        ("Key", entries, []),
    ]


def binary(tree: Tree, version: int = 7400, *, pack: bool = True) -> bytes:
    """A binary file; `pack` whether its arrays are compressed."""
    wide = version >= 7500
    end = bytes(25 if wide else 13)
    out = b"Kaydara FBX Binary  \x00\x1a\x00" + struct.pack("<I", version)
    for record in tree:
        out += _record(record, len(out), wide, pack)
    return out + end + bytes(range(16)) + bytes(120)


def _record(record: tuple[str, list[Any], Tree], at: int, wide: bool, pack: bool) -> bytes:
    name, values, children = record
    body = b"".join(_value(value, pack) for value in values)
    start = at + (25 if wide else 13) + len(name)
    inside = b""
    for child in children:
        inside += _record(child, start + len(body) + len(inside), wide, pack)
    if children:
        inside += bytes(25 if wide else 13)
    header = start + len(body) + len(inside), len(values), len(body), len(name)
    return struct.pack("<QQQB" if wide else "<IIIB", *header) + name.encode() + body + inside


def _value(value: Any, pack: bool) -> bytes:
    if isinstance(value, Char):
        return b"C" + value.encode()
    if isinstance(value, str):
        return b"S" + struct.pack("<I", len(value.encode())) + value.encode()
    if isinstance(value, np.ndarray):
        data = zlib.compress(value.tobytes()) if pack else value.tobytes()
        kind = {"<f4": b"f", "<f8": b"d", "<i8": b"l", "<i4": b"i"}[value.dtype.str]
        return kind + struct.pack("<III", len(value), int(pack), len(data)) + data
    if isinstance(value, float):
        return b"D" + struct.pack("<d", value)
    return b"I" + struct.pack("<i", value) if abs(value) < 1 << 31 else b"L" + struct.pack("<q", value)


def text(tree: Tree) -> bytes:
    """An ASCII file."""
    version = next(children for name, _, children in tree if name == "FBXHeaderExtension")[1][1][0]
    lines = [f"; FBX {version / 1000:.1f}.0 project file", "; ----------------------------------------------------", ""]
    for record in tree:
        lines += _lines(record, 0)
    return "\n".join(lines).encode() + b"\n"


def _lines(record: tuple[str, list[Any], Tree], depth: int) -> list[str]:
    name, values, children = record
    tab = "\t" * depth
    if len(values) == 1 and isinstance(values[0], np.ndarray):
        numbers = ",".join(repr(number.item()) for number in values[0])
        return [f"{tab}{name}: *{len(values[0])} {{", f"{tab}\ta: {numbers}", f"{tab}}} "]
    line = f"{tab}{name}: " + ", ".join(_word(value) for value in values)
    if not children and name not in ("Objects", "Connections", "Properties70", "Properties60"):
        return [line]
    inside = [inner for child in children for inner in _lines(child, depth + 1)]
    return [line + " {", *inside, tab + "}"]


def _word(value: Any) -> str:
    if isinstance(value, Char):
        return str(value)
    if isinstance(value, str):
        plain, mark, kind = value.partition("\0\1")
        return f'"{kind}::{plain}"' if mark else f'"{value}"'
    return repr(value)
