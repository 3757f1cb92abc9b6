"""The section `Takes`, where FBX before version 7 keeps its animation: channels by the names of models."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from indexer.formats.fbx.animation_curves import (
    CLAMP_PROGRESSIVE,
    CONSTANT,
    CUBIC,
    THIRD,
    TIME_INDEPENDENT,
    TO_NEXT,
    USER,
    Attributes,
    Curve,
    checked,
    extrapolations,
)  # fmt: skip
from indexer.formats.fbx.objects import FbxScene, plain_name
from indexer.formats.fbx.records import DamagedFbx, PackedArray, Record
from indexer.formats.fbx.stacks import AxisCurves, Layer, Stack

_PROPERTIES = {"T": "Lcl Translation", "R": "Lcl Rotation", "S": "Lcl Scaling"}
_LINEAR = 0x4
#: Numbers that follow a key's kind of slope, and how often weights follow them.
_SLOPES = {"s": (2, 1), "b": (2, 1), "a": (0, 1), "p": (2, 2), "t": (3, 0)}
#: Numbers that follow a kind of weights: which of the two they are.
_WEIGHTS: dict[str, tuple[int, ...]] = {"n": (), "c": (), "a": (0, 1), "l": (1,), "r": (0,)}


def read_takes_section(root: Record, scene: FbxScene) -> list[Stack]:
    """The animations of a file before version 7, each of one layer."""
    section = root.find("Takes")
    stacks = []
    for take in section.all("Take") if section is not None else ():
        layer = Layer()
        for model in take.all("Model"):
            place = scene.places.get(model.text(0))
            if place is None:
                continue
            for transform in model.all("Channel"):
                if transform.text(0) == "Transform":
                    for channel in transform.all("Channel"):
                        name = _PROPERTIES.get(channel.text(0))
                        if name is not None:
                            layer.channels[place, name] = _channel(channel)
        span = next((span for name in ("LocalTime", "ReferenceTime") if (span := _span(take, name))), None)
        stacks.append(Stack(plain_name(take.text(0)), span, [layer]))
    return stacks


def _span(take: Record, name: str) -> tuple[float, float] | None:
    numbers = take.numbers(name, "f8")
    return (float(numbers[0]), float(numbers[1])) if len(numbers) == 2 and np.isfinite(numbers).all() else None


def _channel(record: Record) -> AxisCurves:
    defaults, curves = [], []
    for letter in "XYZ":
        axis = next((child for child in record.all("Channel") if child.text(0) == letter), None)
        defaults.append(axis.number("Default", 0.0) if axis is not None else 0.0)
        curves.append(_curve(axis) if axis is not None else None)
    return AxisCurves((defaults[0], defaults[1], defaults[2]), (curves[0], curves[1], curves[2]))


def _curve(record: Record) -> Curve | None:
    """The curve of a channel; its keys stand in one list, each of as many entries as its kind has.

    Raises
    ------
    DamagedFbx
        Where the list ends early, or holds what no key has.
    """
    key = record.find("Key")
    count = int(record.number("KeyCount", 0))
    if key is None or count <= 0:
        return None
    entries: list[Any] = []
    for value in key.values:
        entries += value.unpack().tolist() if isinstance(value, PackedArray) else np.ravel(value).tolist()
    if count > len(entries) // 3:
        raise DamagedFbx(f"a curve announces {count} keys in {len(entries)} entries")
    numbers, flags = np.zeros((count, 6)), np.zeros(count, np.int64)
    rest = iter(entries)
    try:
        for i in range(count):
            numbers[i], flags[i] = _key(rest)
    except (StopIteration, RuntimeError, KeyError, TypeError, ValueError, OverflowError):
        raise DamagedFbx("a curve's keys cannot be told apart") from None
    if not (np.abs(numbers[:, 0]) < 1 << 60).all():
        raise DamagedFbx("a curve has keys at impossible times")
    if flags[0] & CLAMP_PROGRESSIVE:
        numbers[0, 2:4] = 0
    ones = np.ones(count, np.int64)
    attributes = Attributes.of(ones, flags, numbers[:, 2:4], numbers[:, 4:], np.zeros(count))
    return checked(Curve(numbers[:, 0].astype(np.int64), numbers[:, 1], attributes, *extrapolations(record)))


def _key(rest: Iterator[Any]) -> tuple[list[float], int]:
    """Time, value, two slopes and two weights of the key that comes next, and its flags."""
    time, value = float(next(rest)), float(next(rest))
    kind = _letter(next(rest))
    slopes, weights = [0.0, 0.0], [THIRD, THIRD]
    flags = {"U": CUBIC | USER, "L": _LINEAR, "C": CONSTANT}[kind]
    if kind == "C" and _letter(next(rest)) == "n":
        flags |= TO_NEXT
    if kind == "U":
        slope = _letter(next(rest))
        count, repeats = _SLOPES[slope]
        numbers = [float(next(rest)) for _ in range(count)]
        if slope in ("s", "b"):
            slopes = numbers
        elif slope == "a":
            flags = CUBIC | TIME_INDEPENDENT | CLAMP_PROGRESSIVE
        for _ in range(repeats):
            for side in _WEIGHTS[_letter(next(rest))]:
                weights[side] = float(next(rest))
    return [time, value, *slopes, *weights], flags


def _letter(entry: Any) -> str:
    """A letter, which is a number in binary files."""
    return entry if isinstance(entry, str) else chr(int(entry))
