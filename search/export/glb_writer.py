"""Writing glTF 2.0 in one binary file: the 22 joints as a skinned figure with one animation, in metres, Y up."""

from __future__ import annotations

import json
import struct
from typing import IO, Any

import numpy as np
from numpy.typing import NDArray

from encoders.geometry import length
from search.export.quaternions import to_quaternions
from search.export.rig_motion import RigMotion

Array = NDArray[np.float64]

_FLOAT, _UNSIGNED_BYTE, _UNSIGNED_SHORT = 5126, 5121, 5123
_VERTICES, _TRIANGLES = 34962, 34963  # what a buffer view of a mesh is for
_SHAPES = {1: "SCALAR", 3: "VEC3", 4: "VEC4", 16: "MAT4"}

#: An octahedron along +Y, of length 1: a bone, widest near its beginning.
_WIDTH, _WIDEST = 0.12, 0.15
_CORNERS = np.array(
    [[0, 0, 0], [_WIDTH, _WIDEST, 0], [0, _WIDEST, _WIDTH], [-_WIDTH, _WIDEST, 0], [0, _WIDEST, -_WIDTH], [0, 1, 0]]
)
_FACES = np.array([[0, 1, 2], [0, 2, 3], [0, 3, 4], [0, 4, 1], [5, 2, 1], [5, 3, 2], [5, 4, 3], [5, 1, 4]])


class _Buffer:
    """The binary part, with the accessors and views that describe it."""

    def __init__(self) -> None:
        self.data = bytearray()
        self.views: list[dict[str, int]] = []
        self.accessors: list[dict[str, Any]] = []

    def add(self, array: NDArray[Any], kind: int, *, target: int = 0, bounds: bool = False) -> int:
        """The number of a new accessor of an array (N,) or (N, K)."""
        array = np.ascontiguousarray(array)
        packed = array.tobytes()
        view = {"buffer": 0, "byteOffset": len(self.data), "byteLength": len(packed)}
        self.views.append(view | ({"target": target} if target else {}))
        self.data += packed + bytes(-len(packed) % 4)
        shape = _SHAPES[1 if array.ndim == 1 else array.shape[1]]
        accessor: dict[str, Any] = {"bufferView": len(self.views) - 1, "componentType": kind}
        accessor |= {"count": len(array), "type": shape}
        if bounds:
            accessor |= {"min": _numbers(array.min(axis=0)), "max": _numbers(array.max(axis=0))}
        self.accessors.append(accessor)
        return len(self.accessors) - 1


def _numbers(values: Any) -> list[float]:
    return [float(value) for value in np.atleast_1d(values)]


def write(out: IO[bytes], motion: RigMotion) -> None:
    """Write a skeleton in motion, in metres and Y up; its rest pose stands on the floor."""
    buffer = _Buffer()
    offsets = motion.offsets.copy()
    offsets[motion.parents < 0] += [0, -float(motion.rest[:, 1].min()), 0]
    count = len(motion.names)
    document = {
        "asset": {"version": "2.0", "generator": "motionseek"},
        "scene": 0,
        "scenes": [{"nodes": [count, *(int(root) for root in np.flatnonzero(motion.parents < 0))]}],
        "nodes": [*_joints(motion, offsets), {"name": "figure", "mesh": 0, "skin": 0}],
        "materials": [{"doubleSided": True, "pbrMetallicRoughness": {"metallicFactor": 0.0, "roughnessFactor": 0.9}}],
        "meshes": [_mesh(buffer, motion, _in_world(offsets, motion.parents))],
        "skins": [_skin(buffer, _in_world(offsets, motion.parents))],
        "animations": [_animation(buffer, motion)],
        "accessors": buffer.accessors,
        "bufferViews": buffer.views,
        "buffers": [{"byteLength": len(buffer.data)}],
    }
    text = json.dumps(document, separators=(",", ":")).encode()
    text += b" " * (-len(text) % 4)
    out.write(struct.pack("<4sII", b"glTF", 2, 12 + 8 + len(text) + 8 + len(buffer.data)))
    for kind, chunk in ((b"JSON", text), (b"BIN\0", bytes(buffer.data))):
        out.write(struct.pack("<I4s", len(chunk), kind) + chunk)


def _in_world(offsets: Array, parents: NDArray[np.int64]) -> Array:
    """Positions (J, 3) of the rest pose, in which nothing is turned."""
    world: Array = offsets.copy()
    for joint, parent in enumerate(parents):
        if parent >= 0:
            world[joint] += world[parent]
    return world


def _joints(motion: RigMotion, offsets: Array) -> list[dict[str, Any]]:
    """The nodes of the joints, in the rest pose."""
    nodes: list[dict[str, Any]] = []
    for name, offset, children in zip(motion.names, offsets, motion.children, strict=True):
        node: dict[str, Any] = {"name": name, "translation": offset.tolist()}
        nodes.append(node | ({"children": children} if children else {}))
    return nodes


def _skin(buffer: _Buffer, rest: Array) -> dict[str, Any]:
    matrices = np.tile(np.eye(4, dtype="<f4"), (len(rest), 1, 1))
    matrices[:, 3, :3] = -rest  # by columns
    return {"joints": list(range(len(rest))), "inverseBindMatrices": buffer.add(matrices.reshape(-1, 16), _FLOAT)}


def _mesh(buffer: _Buffer, motion: RigMotion, rest: Array) -> dict[str, Any]:
    """An octahedron for each bone, which moves with the joint where it begins."""
    ends = np.flatnonzero(motion.parents >= 0)
    starts = motion.parents[ends]
    along = rest[ends] - rest[starts]
    sizes = length(along)
    least = np.eye(3)[np.abs(along).argmin(axis=1)]
    side = np.cross(along, least)
    side *= (sizes / np.maximum(length(side), 1e-9))[:, None]
    other = np.cross(side, along) / np.maximum(sizes, 1e-9)[:, None]
    frames = np.stack([side, along, other], axis=-1)
    corners = rest[starts][:, None] + np.einsum("bij,cj->bci", frames, _CORNERS)
    owners = np.zeros((len(ends), len(_CORNERS), 4), "u1")
    owners[..., 0] = starts[:, None]
    weights = np.zeros(owners.shape, "<f4")
    weights[..., 0] = 1
    faces = _FACES[None] + len(_CORNERS) * np.arange(len(ends))[:, None, None]
    attributes = {
        "POSITION": buffer.add(corners.reshape(-1, 3).astype("<f4"), _FLOAT, target=_VERTICES, bounds=True),
        "JOINTS_0": buffer.add(owners.reshape(-1, 4), _UNSIGNED_BYTE, target=_VERTICES),
        "WEIGHTS_0": buffer.add(weights.reshape(-1, 4), _FLOAT, target=_VERTICES),
    }
    indices = buffer.add(faces.reshape(-1).astype("<u2"), _UNSIGNED_SHORT, target=_TRIANGLES)
    return {"name": "figure", "primitives": [{"attributes": attributes, "indices": indices, "material": 0}]}


def _animation(buffer: _Buffer, motion: RigMotion) -> dict[str, Any]:
    """The turns of all joints that have children, and the places of those that move on their parents."""
    times = buffer.add((np.arange(len(motion)) / motion.fps).astype("<f4"), _FLOAT, bounds=True)
    quaternions = to_quaternions(motion.turns)
    samplers: list[dict[str, Any]] = []
    channels: list[dict[str, Any]] = []

    def add(joint: int, path: str, values: Array) -> None:
        output = buffer.add(values.astype("<f4"), _FLOAT)
        channels.append({"sampler": len(samplers), "target": {"node": joint, "path": path}})
        samplers.append({"input": times, "output": output, "interpolation": "LINEAR"})

    for joint, children in enumerate(motion.children):
        if children:
            add(joint, "rotation", quaternions[:, joint])
        if motion.moving[joint]:
            add(joint, "translation", motion.places[:, joint])
    return {"name": "motion", "samplers": samplers, "channels": channels}
