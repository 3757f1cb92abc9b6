"""Which nodes of a glTF document are the skeleton, how they are called, and how they stand at rest."""

from __future__ import annotations

from collections.abc import Container, Iterable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from indexer.formats.gltf.gltf_accessors import read_accessor
from indexer.formats.gltf.gltf_container import Document
from indexer.formats.gltf.gltf_nodes import NodeTree
from indexer.formats.kinematics import Pose
from indexer.formats.scenes.bind_pose import bind_pose
from indexer.formats.scenes.scene_take import MAX_JOINTS

Array = NDArray[np.float64]


@dataclass(frozen=True)
class NodeSkeleton:
    """Joints among the nodes of a document.

    Attributes
    ----------
    joints : list of int
        Nodes, parents first.
    parents : int array (J,)
        Number among `joints` of the nearest joint above, -1 for none.
    names : tuple of str
    rest : float array (J, 4, 4)
        World matrices at rest.
    """

    joints: list[int]
    parents: NDArray[np.int64]
    names: tuple[str, ...]
    rest: Array

    def moved_by(self, nodes: Container[int], tree: NodeTree, needed: Iterable[int]) -> list[int]:
        """Numbers of the joints in those trees of the skeleton that some of `nodes` move or carry.

        `needed` are the joints' nodes and all above them, parents first.
        """
        carried: set[int] = set()
        for node in needed:
            if node in nodes or tree.parents[node] in carried:
                carried.add(node)
        root = np.arange(len(self.joints))
        for joint, parent in enumerate(self.parents.tolist()):
            root[joint] = root[parent] if parent >= 0 else joint
        moving = {int(root[joint]) for joint, node in enumerate(self.joints) if node in carried}
        return [joint for joint in range(len(root)) if int(root[joint]) in moving]


def find_skeleton(document: Document, tree: NodeTree, moved: set[int]) -> NodeSkeleton:
    """The joints of all skins and of a VRM humanoid, or else the nodes that animations move, and what belongs to them.

    Nodes below joints belong to it where they carry no mesh, and nodes above that an animation moves, which carry the
    body along. How joints stand at rest is the bind pose of their skin, else the nodes' own transforms.

    Parameters
    ----------
    moved : set of int
        Nodes that any animation of the document moves.
    """
    bones = humanoid_bones(document, len(tree.rows))
    skins = document.rows(document.json, "skins")
    members = [_members(document, skin, len(tree.rows)) for skin in skins]
    chosen = {node for joints in members for node in joints} | set(bones)
    is_skinned = bool(chosen)
    chosen |= {node for node in tree.with_ancestors(chosen) if node in moved}
    if not is_skinned:
        chosen = set(moved)
    for node in tree.order:
        is_bare = not is_skinned or not ("mesh" in tree.rows[node] or "camera" in tree.rows[node])
        if tree.parents[node] in chosen and is_bare:
            chosen.add(node)
    needed = tree.with_ancestors(chosen)
    if len(needed) > MAX_JOINTS:
        raise document.error(f"more than {MAX_JOINTS} joints: this is no skeleton of a person")
    joints = [node for node in needed if node in chosen]
    number = {node: i for i, node in enumerate(joints)}
    above = {-1: -1}
    for node in needed:
        parent = tree.parents[node]
        above[node] = number.get(parent, above[parent])
    parents = np.array([above[node] for node in joints], np.int64)
    names = tuple(bones.get(node) or _name(tree.rows[node], node) for node in joints)
    return NodeSkeleton(joints, parents, names, _rest(document, tree, joints, members))


def humanoid_bones(document: Document, nodes: int) -> dict[int, str]:
    """Node to bone of a VRM humanoid: "hips", "leftUpperLeg", ...; empty where the file describes none."""
    extensions = document.row(document.json, "extensions")
    pairs: list[tuple[Any, dict[str, Any]]] = []
    old = document.row(document.row(extensions, "VRM"), "humanoid")
    pairs += [(row.get("bone"), row) for row in document.rows(old, "humanBones")]
    for name in ("VRMC_vrm", "VRMC_vrm_animation"):
        bones = document.row(document.row(document.row(extensions, name), "humanoid"), "humanBones")
        pairs += [(bone, document.row(bones, bone)) for bone in bones]
    return {document.number(row, "node", nodes): bone for bone, row in pairs if isinstance(bone, str) and "node" in row}


def _members(document: Document, skin: dict[str, Any], nodes: int) -> list[int]:
    joints = skin.get("joints", [])
    if not isinstance(joints, list):
        raise document.damaged("the joints of a skin are no list")
    return [document.number({"joint": joint}, "joint", nodes) for joint in joints]


def _name(row: dict[str, Any], node: int) -> str:
    name = row.get("name")
    return (" ".join(name.split()) if isinstance(name, str) else "") or f"node{node}"


def _rest(document: Document, tree: NodeTree, joints: list[int], members: list[list[int]]) -> Array:
    """World matrices of joints at rest, (J, 4, 4)."""
    skins = document.rows(document.json, "skins")
    wearers = {row["skin"]: node for node, row in enumerate(tree.rows) if isinstance(row.get("skin"), int)}
    needed = tree.with_ancestors([*joints, *wearers.values()])
    own = {node: _matrix(tree.local(node).at(np.zeros(1), {})) for node in needed}
    still = _worlds(tree, own, {})
    bound: dict[int, Array] = {}
    for number, (skin, nodes) in enumerate(zip(skins, members, strict=True)):
        if "inverseBindMatrices" in skin and nodes:
            accessor = document.whole(skin, "inverseBindMatrices")
            inverse = read_accessor(document, accessor, "MAT4").reshape(-1, 4, 4).swapaxes(1, 2)
            if len(inverse) < len(nodes):
                raise document.damaged(f"skin {number} has {len(nodes)} joints and {len(inverse)} bind matrices")
            places = [still[wearers[number]]] if number in wearers else []
            index = {node: i for i, node in enumerate(nodes)}
            parents = [index.get(tree.parents[node], -1) for node in nodes]
            now = np.array([still[node] for node in nodes])
            placed = bind_pose(now, inverse[: len(nodes)], parents, places)
            bound = {**dict(zip(nodes, placed, strict=True)), **bound}
    rest = _worlds(tree, own, bound)
    return np.array([rest[node] for node in joints]).reshape(-1, 4, 4)


def _worlds(tree: NodeTree, own: Mapping[int, Array], known: Mapping[int, Array]) -> dict[int, Array]:
    """World matrices (4, 4) from nodes' own, parents first, but for those that are known."""
    worlds: dict[int, Array] = {-1: np.eye(4)}
    for node, matrix in own.items():
        worlds[node] = known[node] if node in known else worlds[tree.parents[node]] @ matrix
    return worlds


def _matrix(pose: Pose) -> Array:
    """A still transform as a matrix (4, 4)."""
    matrix = np.eye(4)
    matrix[:3] = np.column_stack([*(axis[:, 0] for axis in pose.axes), pose.position[:, 0]])
    return matrix
