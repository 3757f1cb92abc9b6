"""The node tree of a glTF document: parents, names, and where nodes are in the world as some of them move."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from encoders.geometry import unit
from indexer.formats.gltf.gltf_animation import Channel
from indexer.formats.gltf.gltf_container import Document
from indexer.formats.kinematics import Axes, Pose, quaternion_axes

Array = NDArray[np.float64]

#: A node's channels: target ("translation", "rotation", "scale") to channel.
Moves = Mapping[str, Channel]


@dataclass(frozen=True)
class Local:
    """A node's own transform: it scales by (3,), turns to the axes, each (3, 1), and shifts by (3,)."""

    translation: Array
    axes: Axes
    scale: Array

    def at(self, times: Array, moves: Moves) -> Pose:
        """The transform at times (T,), as columns (3, T), or (3, 1) where nothing moves it."""
        found = {target: channel.at(times).T for target, channel in moves.items()}
        scale = found.get("scale", self.scale[:, None])
        x, y, z = quaternion_axes(found["rotation"]) if "rotation" in found else self.axes
        return Pose((x * scale[0], y * scale[1], z * scale[2]), found.get("translation", self.translation[:, None]))


class NodeTree:
    """All nodes of a document.

    Attributes
    ----------
    rows : list of dict
        As in the JSON.
    parents : list of int
        -1 for a root.
    order : list of int
        All nodes, parents first.
    """

    def __init__(self, document: Document) -> None:
        """Check that each node has one parent and that no node is below itself.

        Raises
        ------
        UnreadableMotion
            Where that is not so.
        """
        self._document = document
        self.rows = document.rows(document.json, "nodes")
        self.parents = [-1] * len(self.rows)
        children = [_children(document, row, len(self.rows)) for row in self.rows]
        for parent, below in enumerate(children):
            for child in below:
                if self.parents[child] >= 0:
                    raise document.damaged(f"node {child} has two parents")
                self.parents[child] = parent
        self.order = [node for node, parent in enumerate(self.parents) if parent < 0]
        for node in self.order:  # grows on the way
            self.order.extend(children[node])
        if len(self.order) < len(self.rows):
            raise document.damaged("a node is below itself")

    def above(self, node: int) -> Iterable[int]:
        """The parents of a node up to the root, the nearest first."""
        while (node := self.parents[node]) >= 0:
            yield node

    def with_ancestors(self, nodes: Iterable[int]) -> list[int]:
        """The nodes and all above them, parents first."""
        found: set[int] = set()
        for node in nodes:
            while node >= 0 and node not in found:
                found.add(node)
                node = self.parents[node]
        return [node for node in self.order if node in found]

    def local(self, node: int) -> Local:
        """A node's transform where nothing moves it; of a matrix, so that turn times scale gives the matrix back."""
        row = self.rows[node]
        if "matrix" in row:
            matrix = self._numbers(row, "matrix", np.eye(4).ravel()).reshape(4, 4).T
            scale = np.linalg.norm(matrix[:3, :3], axis=0)
            x, y, z = (matrix[:3, :3] / np.where(scale > 0, scale, 1.0)).T[:, :, None]
            return Local(matrix[:3, 3], (x, y, z), scale)
        quaternion = unit(self._numbers(row, "rotation", np.array([0.0, 0, 0, 1])))
        scale = self._numbers(row, "scale", np.ones(3))
        return Local(self._numbers(row, "translation", np.zeros(3)), quaternion_axes(quaternion[:, None]), scale)

    def worlds(self, locals_: Mapping[int, Local], times: Array, moves: Mapping[int, Moves]) -> dict[int, Pose]:
        """World transforms at times (T,) of nodes, given parents first, with all their ancestors."""
        poses: dict[int, Pose] = {}
        for node, still in locals_.items():
            local = still.at(times, moves.get(node, {}))
            parent = self.parents[node]
            poses[node] = local if parent < 0 else poses[parent].below(local)
        return poses

    def _numbers(self, row: dict[str, Any], key: str, default: Array) -> Array:
        try:
            values = np.array(row.get(key, default), np.float64)
        except (TypeError, ValueError):
            values = np.empty(0)
        if values.shape != default.shape or not np.isfinite(values).all():
            raise self._document.damaged(f"the {key} of a node is no {len(default)} numbers")
        return values


def _children(document: Document, row: dict[str, Any], nodes: int) -> list[int]:
    children = row.get("children", [])
    if not isinstance(children, list):
        raise document.damaged("the children of a node are no list")
    return [document.number({"child": child}, "child", nodes) for child in children]
