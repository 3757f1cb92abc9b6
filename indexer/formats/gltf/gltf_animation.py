"""glTF animations: the channels that move nodes, and their values at any times.

The three interpolations are those of the glTF 2.0 specification, appendix C.
"""

from __future__ import annotations

from collections.abc import Container
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from encoders.geometry import unit
from indexer.formats.gltf.gltf_accessors import read_accessor
from indexer.formats.gltf.gltf_container import Document

#: Which properties of a node are read, and the type of their values.
PROPERTIES = {"translation": "VEC3", "rotation": "VEC4", "scale": "VEC3"}
_INTERPOLATIONS = ("LINEAR", "STEP", "CUBICSPLINE")
_NEARLY_ONE = 0.9995  # cosine of two quaternions that are interpolated linearly

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Channel:
    """How one property of a node moves.

    Attributes
    ----------
    node : int
    target : str
        One of `PROPERTIES`.
    times : float array (K,)
        Seconds, in order.
    values : float array (K, C), or (K, 3, C) for a spline: tangent in, value, tangent out
    interpolation : str
        "LINEAR", "STEP" or "CUBICSPLINE".
    """

    node: int
    target: str
    times: Array
    values: Array
    interpolation: str

    def at(self, times: Array) -> Array:
        """Its values (T, C) at `times` (T,); before the first key and after the last they stand still."""
        last = len(self.times) - 1
        key = np.clip(np.searchsorted(self.times, times, side="right") - 1, 0, max(last - 1, 0))
        after = np.minimum(key + 1, last)
        step = self.times[after] - self.times[key]
        part = np.clip((times - self.times[key]) / np.where(step > 0, step, 1.0), 0.0, 1.0)[:, None]
        if self.interpolation == "STEP":
            values = self.values[np.where(part[:, 0] < 1, key, after)]
        elif self.interpolation == "CUBICSPLINE":
            values = _spline(self.values, key, after, part, step[:, None])
        elif self.target == "rotation":
            values = _slerp(unit(self.values[key]), unit(self.values[after]), part)
        else:
            values = self.values[key] + (self.values[after] - self.values[key]) * part
        return unit(values) if self.target == "rotation" else values


def moved_nodes(document: Document, animation: dict[str, Any], nodes: int) -> set[int]:
    """Which of so many nodes an animation moves, by its list of channels alone."""
    targets = [document.row(row, "target") for row in document.rows(animation, "channels")]
    return {document.number(target, "node", nodes) for target in targets if _moves(target)}


def read_channels(document: Document, animation: dict[str, Any], nodes: Container[int]) -> list[Channel]:
    """The channels of an animation that move some of the nodes.

    Raises
    ------
    UnreadableMotion
        If keys are out of order, or more or fewer than their values.
    """
    samplers = document.rows(animation, "samplers")
    times: dict[int, Array] = {}
    channels = []
    for row in document.rows(animation, "channels"):
        target = document.row(row, "target")
        if not _moves(target) or target["node"] not in nodes:
            continue
        path = target["path"]
        sampler = samplers[document.number(row, "sampler", len(samplers))]
        source = document.whole(sampler, "input")
        if source not in times:
            times[source] = _times(document, source)
        values = read_accessor(document, document.whole(sampler, "output"), PROPERTIES[path])
        interpolation = str(sampler.get("interpolation", "LINEAR"))
        channels.append(_channel(document, target["node"], path, times[source], values, interpolation))
    return channels


def _moves(target: dict[str, Any]) -> bool:
    """Whether a channel moves a node; others are those of morph targets, materials, lights and cameras."""
    return "node" in target and isinstance(target.get("path"), str) and target["path"] in PROPERTIES


def _times(document: Document, accessor: int) -> Array:
    times = read_accessor(document, accessor, "SCALAR")[:, 0]
    if (np.diff(times) < 0).any():
        raise document.damaged(f"the key times of accessor {accessor} are out of order")
    return times


def _channel(document: Document, node: int, path: str, times: Array, values: Array, interpolation: str) -> Channel:
    if interpolation not in _INTERPOLATIONS:
        raise document.damaged(f"there is no interpolation {interpolation[:20]!r}")
    if interpolation == "CUBICSPLINE":
        if len(values) != 3 * len(times):
            raise document.damaged(f"{len(times)} keys of a spline have {len(values)} values and tangents")
        values = values.reshape(len(times), 3, -1)
    elif len(values) != len(times):
        raise document.damaged(f"{len(times)} keys have {len(values)} values")
    return Channel(node, path, times, values, interpolation)


def _spline(values: Array, key: NDArray[np.int64], after: NDArray[np.int64], part: Array, step: Array) -> Array:
    """A cubic Hermite spline; tangents are changes a second."""
    t, t2, t3 = part, part**2, part**3
    start, leaving = values[key, 1], values[key, 2] * step
    end, arriving = values[after, 1], values[after, 0] * step
    value: Array = (2 * t3 - 3 * t2 + 1) * start + (t3 - 2 * t2 + t) * leaving
    value += (3 * t2 - 2 * t3) * end + (t3 - t2) * arriving
    return value


def _slerp(start: Array, end: Array, part: Array) -> Array:
    """Between unit quaternions (T, 4), the shorter way round."""
    cosine = (start * end).sum(axis=-1, keepdims=True)
    end = np.where(cosine < 0, -end, end)
    cosine = np.abs(cosine)
    angle = np.arccos(np.clip(cosine, -1.0, 1.0))
    sine = np.where(cosine < _NEARLY_ONE, np.sin(angle), 1.0)
    curved = (np.sin((1 - part) * angle) * start + np.sin(part * angle) * end) / sine
    straight = start + (end - start) * part
    return np.where(cosine < _NEARLY_ONE, curved, straight)
