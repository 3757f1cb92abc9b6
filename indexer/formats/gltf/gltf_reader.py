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
from indexer.formats.kinematics import Pose
from indexer.formats.scenes.key_times import key_rate, sample_times
from indexer.formats.scenes.scene_take import MAX_PLACES, scene_take
from indexer.formats.scenes.take_names import take_names
from indexer.take import Take

MAX_ANIMATIONS = 1000
_LEAST = 64  # frames that a take is counted as, at least, for the time that each joint takes
_LATE = 1.0  # seconds before the first key above which they are no part of the movement

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


def _times(document: Document, channels: Sequence[Channel], rate: float, name: str) -> Array:
    """When an animation is sampled, (T,) seconds: from 0, or from its first key where that comes late, to its last."""
    first = min(float(channel.times[0]) for channel in channels)
    last = max(float(channel.times[-1]) for channel in channels)
    start = 0.0 if 0 <= first <= _LATE else first
    try:
        return sample_times(start, last, rate)
    except ValueError as error:
        raise document.error(f"of the animation {name!r}: {error}") from None


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
    joints = skeleton.moved_by(moves, tree, needed)
    row_of = {joint: row for row, joint in enumerate(joints)}
    locals_ = {node: tree.local(node) for node in needed}

    def posed(at: Array) -> list[Pose]:
        worlds = tree.worlds(locals_, at, moves)
        return [worlds[skeleton.joints[joint]] for joint in joints]

    return scene_take(
        [skeleton.names[joint] for joint in joints],
        np.array([row_of.get(parent, -1) for parent in skeleton.parents[joints].tolist()]),
        skeleton.rest[joints],
        {row for row, joint in enumerate(joints) if skeleton.joints[joint] in moves},
        posed,
        times,
        fps=fps,
        name=name,
        up="y",
    )
