"""Animation stacks: each an animation of the scene, made of layers of curves, one upon the other."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from indexer.formats.fbx.animation_curves import Curve, CurveReader
from indexer.formats.fbx.euler import euler_to_quaternion, multiply, quaternion_to_euler, slerp
from indexer.formats.fbx.key_interpolation import sample
from indexer.formats.fbx.objects import FbxScene, Identity, identity_of, name_of, properties
from indexer.formats.fbx.records import Record

Floats = NDArray[np.float64]
#: A model's place, and the property of it that moves.
Target = tuple[int, str]

TRANSLATION, ROTATION, SCALING = "Lcl Translation", "Lcl Rotation", "Lcl Scaling"
TRANSFORMS = (TRANSLATION, ROTATION, SCALING)
_ADDITIVE, _PASSTHROUGH = 0, 2
_FULL = 0.99999


@dataclass(frozen=True)
class AxisCurves:
    """Three curves of a property, and the values where there is none."""

    defaults: tuple[float, float, float]
    curves: tuple[Curve | None, Curve | None, Curve | None]


@dataclass
class Layer:
    """A layer of an animation.

    Attributes
    ----------
    channels : dict
    is_additive, is_blended : bool
        Whether it is added to the layers below, or mixed with them by its weight; else it replaces them.
    weight : AxisCurves
        Its first curve is the weight in percent.
    turns, scales : bool
        Whether rotations and scalings are composed as such; else their numbers are added.
    """

    channels: dict[Target, AxisCurves] = field(default_factory=dict)
    is_additive: bool = True
    is_blended: bool = True
    weight: AxisCurves = AxisCurves((100.0, 0.0, 0.0), (None, None, None))
    turns: bool = True
    scales: bool = True


@dataclass
class Stack:
    """An animation: its name, its span in ticks where it states one, and its layers from the lowest."""

    name: str
    span: tuple[float, float] | None
    layers: list[Layer]

    def targets(self) -> set[Target]:
        """What moves."""
        return {target for layer in self.layers for target in layer.channels}

    def key_span(self) -> tuple[float, float] | None:
        """The times of the first and the last key, in ticks."""
        times = [(float(curve.times[0]), float(curve.times[-1])) for curve in self._curves()]
        return (min(first for first, _ in times), max(last for _, last in times)) if times else None

    def key_count(self) -> int:
        """How many keys there are."""
        return sum(len(curve.times) for curve in self._curves())

    def _curves(self) -> list[Curve]:
        curves = [curve for layer in self.layers for channel in layer.channels.values() for curve in channel.curves]
        return [curve for curve in curves if curve is not None]


def read_stacks(root: Record, scene: FbxScene) -> list[Stack]:
    """The animations of a file of version 7.

    Raises
    ------
    DamagedFbx
        Where curves are damaged.
    """
    objects = root.find("Objects")
    if objects is None:
        return []
    records = {
        identity_of(record): record
        for kind in ("AnimationStack", "AnimationLayer", "AnimationCurveNode", "AnimationCurve")
        for record in objects.all(kind)
    }
    targets: dict[Identity, tuple[Identity, str]] = {
        source: (target, name) for target, pairs in scene.sources.items() for source, name in pairs if name
    }
    spans, reader = _spans(root), CurveReader()
    stacks = []
    for record in objects.all("AnimationStack"):
        layers = [
            _layer(records[source], scene, records, targets, reader)
            for source, _ in scene.sources.get(identity_of(record), ())
            if source in records and records[source].name == "AnimationLayer"
        ]
        name = name_of(record)
        stacks.append(Stack(name, _span(record) or spans.get(name), layers))
    return stacks


def _span(record: Record) -> tuple[float, float] | None:
    stated = properties(record)
    for start, stop in (("LocalStart", "LocalStop"), ("ReferenceStart", "ReferenceStop")):
        if start in stated and stop in stated:
            return float(stated[start][0]), float(stated[stop][0])
    # a span that begins at 0 may state its end alone
    return (0.0, float(stated["LocalStop"][0])) if "LocalStop" in stated else None


def _spans(root: Record) -> dict[str, tuple[float, float]]:
    """Spans by the names of takes, which repeat the stacks in many files."""
    takes = root.find("Takes")
    spans = {}
    for take in takes.all("Take") if takes is not None else ():
        numbers = take.numbers("LocalTime", "f8")
        if len(numbers) == 2:
            spans[take.text(0)] = float(numbers[0]), float(numbers[1])
    return spans


def _layer(
    record: Record,
    scene: FbxScene,
    records: dict[Identity, Record],
    targets: dict[Identity, tuple[Identity, str]],
    reader: CurveReader,
) -> Layer:
    stated = properties(record)
    blend = int(stated.get("BlendMode", (0,))[0])
    layer = Layer(
        is_additive=blend == _ADDITIVE,
        is_blended=blend in (_ADDITIVE, _PASSTHROUGH),
        weight=AxisCurves((float(stated.get("Weight", (100.0,))[0]), 0.0, 0.0), (None, None, None)),
        turns=stated.get("RotationAccumulationMode", (0,))[0] == 0,
        scales=stated.get("ScaleAccumulationMode", (0,))[0] == 0,
    )
    for identity, _ in scene.sources.get(identity_of(record), ()):
        node = records.get(identity)
        if node is None or node.name != "AnimationCurveNode" or identity not in targets:
            continue
        target, name = targets[identity]
        if target == identity_of(record) and name == "Weight":
            layer.weight = _channel(node, scene, records, reader)
        elif target in scene.places and name in TRANSFORMS:
            layer.channels[scene.places[target], name] = _channel(node, scene, records, reader)
    return layer


def _channel(node: Record, scene: FbxScene, records: dict[Identity, Record], reader: CurveReader) -> AxisCurves:
    stated = properties(node)
    defaults = [float(stated.get(f"d|{axis}", (0.0,))[0]) for axis in "XYZ"]
    curves: list[Curve | None] = [None, None, None]
    for identity, name in scene.sources.get(identity_of(node), ()):
        axis = {"d|X": 0, "d|Y": 1, "d|Z": 2, "d|Weight": 0}.get(name)
        record = records.get(identity)
        if axis is not None and record is not None and record.name == "AnimationCurve":
            curves[axis] = reader.read(record)
    if "d|Weight" in stated:
        defaults[0] = float(stated["d|Weight"][0])
    return AxisCurves((defaults[0], defaults[1], defaults[2]), (curves[0], curves[1], curves[2]))


def move(stack: Stack, scene: FbxScene, models: set[int], ticks: Floats) -> dict[Target, Floats]:
    """Values (3, T) of what moves of some models, at times (T,) in ticks."""
    channels = [
        (layer, target, channel)
        for layer in stack.layers
        for target, channel in layer.channels.items()
        if target[0] in models
    ]
    values = _channel_values([channel for _, _, channel in channels], ticks, scene.ticks)
    weights = _channel_values([layer.weight for layer in stack.layers], ticks, scene.ticks)[:, 0] / 100
    moved: dict[Target, Floats] = {}
    for (layer, target, _), value in zip(channels, values, strict=True):
        if layer is stack.layers[0]:
            moved[target] = value
            continue
        at = next(i for i, other in enumerate(stack.layers) if other is layer)
        weight = np.where(weights[at] > _FULL, 1.0, np.maximum(weights[at], 0.0))
        below = moved[target] if target in moved else _at_rest(scene, target)[:, None]
        moved[target] = _combined(layer, target, scene, below, value, weight)
    return moved


def _at_rest(scene: FbxScene, target: Target) -> Floats:
    place, name = target
    rest = np.full(3, 1.0 if name == SCALING else 0.0)
    stated = scene.models[place].properties.get(name, ())
    rest[: len(stated)] = stated[:3]
    return rest


def _channel_values(channels: list[AxisCurves], ticks: Floats, second: float) -> Floats:
    """Values (C, 3, T) of channels."""
    values = np.empty((len(channels), 3, len(ticks)))
    places, curves = [], []
    for i, channel in enumerate(channels):
        for axis, curve in enumerate(channel.curves):
            if curve is None:
                values[i, axis] = channel.defaults[axis]
            else:
                places.append(3 * i + axis)
                curves.append(curve)
    values.reshape(-1, len(ticks))[places] = sample(curves, ticks, second)
    return values


def _combined(layer: Layer, target: Target, scene: FbxScene, below: Floats, value: Floats, weight: Floats) -> Floats:
    """A layer's values (3, T) upon those of the layers below."""
    place, name = target
    if not layer.is_blended:
        return value
    keep = np.ones_like(weight) if layer.is_additive else 1 - weight
    if name == ROTATION and layer.turns:
        order = int(scene.models[place].properties.get("RotationOrder", (0,))[0])
        over, under = euler_to_quaternion(value, order), euler_to_quaternion(np.broadcast_to(below, value.shape), order)
        if layer.is_additive:
            nothing = np.zeros_like(over)
            nothing[3] = 1
            mixed = multiply(under, slerp(nothing, over, weight))
        else:
            mixed = slerp(under, over, weight)
        return quaternion_to_euler(mixed, order)
    if name == SCALING and layer.scales:
        return _power(below, keep) * _power(value, weight)
    return below * keep + value * weight


def _power(values: Floats, exponent: Floats) -> Floats:
    """Powers of absolute values, with the sign they had."""
    powers: Floats = np.sign(values) * np.abs(values) ** exponent
    return np.where(exponent <= 0, 1.0, np.where(exponent >= 1, values, powers))
