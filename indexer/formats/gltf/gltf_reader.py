"""glTF 2.0 (.gltf, .glb) and what is made of it (.vrm, .vrma): each animation that moves a skeleton is a take.

glTF states no frame rate, only the times of keys: an animation is sampled at the rate that most of its keys have.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from os import PathLike

import numpy as np
from numpy.typing import NDArray

from indexer.formats.gltf.gltf_animation import Channel, moved_nodes, read_channels
from indexer.formats.gltf.gltf_container import Document
from indexer.formats.gltf.gltf_nodes import NodeTree
from indexer.formats.gltf.gltf_skeleton import NodeSkeleton, find_skeleton
from indexer.formats.kinematics import tips
from indexer.formats.take_names import take_names
from indexer.take import Take

#: Where keys are sparse an animation is sampled at the usual rate; none is sampled faster than the fastest cameras.
SPARSE_FPS, USUAL_FPS, MAX_FPS = 20, 30, 240
#: Frames times joints of all takes of a file, which a few bytes of keys can ask for: a gigabyte.
MAX_PLACES = 40_000_000
MAX_ANIMATIONS = 1000
MAX_HOURS = 12
_BLOCK = 4096  # frames whose poses fit the processor's cache, and bound the memory they need
_LEAST = 64  # frames that a take is counted as, at least, for the time that each joint takes
_LATE = 1.0  # seconds before the first key above which they are no part of the movement
_ON_GRID = 0.01  # frames by which the last key may lie before a frame

Array = NDArray[np.float64]


def read(path: str | PathLike[str], data: bytes, *, fps: float | None = None) -> list[Take]:
    """Read the animations of a glTF or GLB file.

    Joints are those of its skins, or of a VRM humanoid, whose bones have the humanoid's names; without either, all
    nodes that are animated and those below. Morph targets are passed over. Up is Y, as the format has it, which
    exporters do not always observe.

    Raises
    ------
    UnreadableMotion
        If the file is damaged, holds no animation, or none that moves nodes.
    """
    document = Document(path, data)
    animations = document.rows(document.json, "animations")
    if not animations:
        raise document.error("it holds no animation, only a model")
    if len(animations) > MAX_ANIMATIONS:
        raise document.error(f"it holds more than {MAX_ANIMATIONS} animations; cut it into parts")
    tree = NodeTree(document)
    moved = [moved_nodes(document, animation, len(tree.rows)) for animation in animations]
    skeleton = find_skeleton(document, tree, set().union(*moved))
    needed = tree.with_ancestors(skeleton.joints)
    names = take_names([animation.get("name") for animation in animations], "animation")
    takes: list[Take] = []
    places = 0
    for animation, nodes, name in zip(animations, moved, names, strict=True):
        if nodes.isdisjoint(needed):
            continue
        channels = read_channels(document, animation, set(needed))
        rate = key_rate([channel.times for channel in channels])
        times = _times(document, channels, rate, name)
        places += max(len(times), _LEAST) * len(needed)
        if places > MAX_PLACES:
            raise document.error("its animations are too long; cut the file into parts")
        takes.append(_take(tree, skeleton, needed, channels, times, fps or rate, name))
    if not takes:
        raise document.error("its animations move no skeleton, only cameras or other objects")
    return takes if len(takes) > 1 else [replace(takes[0], name="")]


def key_rate(keys: Sequence[Array]) -> float:
    """Frames a second of key times (K,): the most common spacing; `USUAL_FPS` where keys are sparse."""
    spacings = np.concatenate([np.diff(times) for times in keys])
    rates = np.round(1 / spacings[(spacings > 1 / (4 * MAX_FPS)) & (spacings < 10)]).astype(np.int64)
    if not len(rates):
        return float(USUAL_FPS)
    common = int(np.bincount(rates).argmax())
    return float(min(common, MAX_FPS) if common >= SPARSE_FPS else USUAL_FPS)


def _times(document: Document, channels: Sequence[Channel], rate: float, name: str) -> Array:
    """When an animation is sampled, (T,) seconds: from 0, or from its first key where that comes late, to its last."""
    first = min(float(channel.times[0]) for channel in channels)
    last = max(float(channel.times[-1]) for channel in channels)
    start = 0.0 if 0 <= first <= _LATE else first
    if last - start > MAX_HOURS * 3600:
        raise document.error(f"the animation {name!r} lasts {(last - start) / 3600:.3g} hours")
    times: Array = start + np.arange(int((last - start) * rate + _ON_GRID) + 1) / rate
    return times


def _take(
    tree: NodeTree,
    skeleton: NodeSkeleton,
    needed: Sequence[int],
    channels: Sequence[Channel],
    times: Array,
    fps: float,
    name: str,
) -> Take:
    """The figures that an animation moves, sampled at `times` (T,)."""
    moves: dict[int, dict[str, Channel]] = {}
    for channel in channels:
        moves.setdefault(channel.node, {})[channel.target] = channel
    joints = skeleton.moved_by(tree, moves)
    rest = skeleton.rest[joints]
    parents = np.array([joints.index(parent) if parent >= 0 else -1 for parent in skeleton.parents[joints].tolist()])
    ends = [(leaf, step) for leaf, step in tips(parents, rest[:, :3, 3]) if skeleton.joints[joints[leaf]] in moves]
    names = [skeleton.names[joint] for joint in joints]
    steps = [np.linalg.pinv(rest[leaf, :3, :3]) @ step for leaf, step in ends]
    locals_ = {node: tree.local(node) for node in needed}
    positions = np.empty((len(joints) + len(ends), 3, len(times)))
    for start in range(0, len(times), _BLOCK):
        block = slice(start, start + _BLOCK)
        worlds = tree.worlds(locals_, times[block], moves)
        poses = [worlds[skeleton.joints[joint]] for joint in joints]
        for joint, pose in enumerate(poses):
            positions[joint, :, block] = pose.position
        for row, ((leaf, _), step) in enumerate(zip(ends, steps, strict=True), start=len(joints)):
            positions[row, :, block] = poses[leaf].place(step)
    return Take(
        (*names, *(f"{names[leaf]}_end" for leaf, _ in ends)),
        np.concatenate([parents, np.array([leaf for leaf, _ in ends], np.int64)]),
        np.concatenate([rest[:, :3, 3], np.array([rest[leaf, :3, 3] + step for leaf, step in ends]).reshape(-1, 3)]),
        positions.transpose(2, 0, 1),
        fps,
        name=name,
        up="y",
    )
