"""FBX, binary and ASCII, versions 6.1 to 7.7: each animation stack is a take.

Positions are those of the scene's skeleton in the world, in the file's units and axes, at the file's frame rate.
"""

from __future__ import annotations

import re
from collections import Counter
from dataclasses import replace
from os import PathLike

import numpy as np
from numpy.typing import NDArray

from encoders.errors import UnreadableMotion
from indexer.formats.fbx import binary_records, text_records
from indexer.formats.fbx.objects import FbxScene, read_scene
from indexer.formats.fbx.records import DamagedFbx
from indexer.formats.fbx.skeleton_nodes import joints_of
from indexer.formats.fbx.stacks import ROTATION, Stack, move, read_stacks
from indexer.formats.fbx.takes_section import read_takes_section
from indexer.formats.fbx.world_transforms import Placed, place, with_ancestors
from indexer.formats.kinematics import Axes, Pose, from_rest, tips
from indexer.take import Take

Floats = NDArray[np.float64]

MAX_JOINTS = 4096
#: Places of joints that a take may hold, however few keys they come from; and so many more for each key.
_MAX_PLACES, _PLACES_A_KEY = 8_000_000, 10
_BLOCK = 2048  # frames at a time, which bounds memory
_DEFAULT_FPS = 30.0
_END = re.compile(r"(end|tip|nub|site)[\W_]*\d*$", re.IGNORECASE)  # names of joints that are no more than an end


def read(path: str | PathLike[str], data: bytes, *, fps: float | None = None) -> list[Take]:
    """Read the animations of an FBX file.

    Raises
    ------
    UnreadableMotion
        Where the file is damaged, holds no skeleton or no animation.
    """
    try:
        with np.errstate(all="ignore"):
            return _takes(path, data, fps)
    except DamagedFbx as error:
        raise UnreadableMotion(path, f"the FBX is damaged: {error}") from None


def _takes(path: str | PathLike[str], data: bytes, fps: float | None) -> list[Take]:
    is_binary = data.startswith(binary_records.MAGIC[:18])
    root = binary_records.parse(data) if is_binary else text_records.parse(data)
    scene = read_scene(root)
    stacks = read_stacks(root, scene) or read_takes_section(root, scene)
    turning = {place for stack in stacks for place, name in stack.targets() if name == ROTATION}
    joints = joints_of(scene, turning)
    if not joints:
        raise UnreadableMotion(path, "the FBX holds no skeleton")
    if len(joints) > MAX_JOINTS:
        raise UnreadableMotion(path, f"more than {MAX_JOINTS} joints: this is no skeleton of a person")
    takes = []
    for stack in stacks:
        if any(place in set(joints) for place, _ in stack.targets()) and stack.key_span() is not None:
            takes.append(_take(path, scene, joints, stack, fps))
    if not takes:
        raise UnreadableMotion(path, "the FBX holds no animation of its skeleton: export it with animation baked")
    return _named_apart(takes)


def _take(path: str | PathLike[str], scene: FbxScene, joints: list[int], stack: Stack, fps: float | None) -> Take:
    rate = scene.fps or _DEFAULT_FPS
    ticks = frame_times(path, scene, joints, stack)
    parents, (rest, axes) = _parents(scene, joints), rest_pose(scene, joints)
    turning = {place for place, name in stack.targets() if name == ROTATION}
    ends = [
        (leaf, step)
        for leaf, step in tips(parents, rest)
        if joints[leaf] in turning and not _END.search(scene.models[joints[leaf]].name)
    ]
    positions = np.empty((len(ticks), len(joints) + len(ends), 3))
    for start in range(0, len(ticks), _BLOCK):
        placed = world(scene, joints, stack, ticks[start : start + _BLOCK])
        block = positions[start : start + _BLOCK]
        for i, at in enumerate(joints):
            block[:, i] = placed[at].position.T
        for i, (leaf, step) in enumerate(ends, start=len(joints)):
            block[:, i] = (Pose(placed[joints[leaf]].axes, placed[joints[leaf]].position)).place(axes[leaf].T @ step).T
    if not np.isfinite(positions).all():
        raise UnreadableMotion(path, f"the animation {stack.name!r} holds places that are no numbers")
    names = [scene.models[at].name or f"joint{i}" for i, at in enumerate(joints)]
    names += [f"{names[leaf]}_end" for leaf, _ in ends]
    parents = np.append(parents, np.array([leaf for leaf, _ in ends], np.int64))
    rest = np.concatenate([rest, np.array([rest[leaf] + step for leaf, step in ends]).reshape(-1, 3)])

    def rotations() -> Floats:
        placed = world(scene, joints, stack, ticks)
        turned = from_rest([_over_all(placed[at].axes, len(ticks)) for at in joints], axes)
        return turned[:, [*range(len(joints)), *(leaf for leaf, _ in ends)]]

    warnings = []
    if scene.fps is None:
        warnings.append(f"the file states no frame rate: {_DEFAULT_FPS:g} frames a second are taken")
    if scene.has_constraints:
        warnings.append("constraints are not applied: only what is keyed moves")
    return Take(
        tuple(names),
        parents,
        rest,
        positions,
        fps or rate,
        stack.name,
        scene.up,
        warnings=tuple(warnings),
        rotations=rotations,
    )


def _over_all(axes: Axes, frames: int) -> Axes:
    """Axes (3, T) for all frames, also where they do not change."""
    x, y, z = (np.broadcast_to(axis, (3, frames)) for axis in axes)
    return x, y, z


def frame_times(path: str | PathLike[str], scene: FbxScene, joints: list[int], stack: Stack) -> Floats:
    """The times (T,) of a stack's frames, in ticks: of its span, else from its first key to its last.

    Raises
    ------
    UnreadableMotion
        If these are more frames than the keys account for.
    """
    first, last = stack.key_span() or (0.0, 0.0)
    start, stop = stack.span if stack.span is not None and stack.span[1] > stack.span[0] else (first, last)
    keys = sum(
        len(curve.times)
        for layer in stack.layers
        for channel in layer.channels.values()
        for curve in channel.curves
        if curve is not None
    )
    step = scene.ticks / (scene.fps or _DEFAULT_FPS)
    most = (_MAX_PLACES + _PLACES_A_KEY * keys) // len(joints)
    if not (stop - start) / step < most:
        start, stop = max(start, first), min(stop, last)
    if not 0 <= (stop - start) / step < most:
        hours = (stop - start) / scene.ticks / 3600
        raise UnreadableMotion(path, f"the animation {stack.name!r} lasts {hours:.3g} hours by {keys} keys")
    times: Floats = start + step * np.arange(int((stop - start) / step + 1e-4) + 1, dtype=np.float64)
    return times


def world(scene: FbxScene, joints: list[int], stack: Stack, ticks: Floats) -> dict[int, Placed]:
    """Joints and all above them in the world, at times (T,) in ticks."""
    return place(scene, set(joints), move(stack, scene, with_ancestors(scene, set(joints)), ticks), len(ticks))


def rest_pose(scene: FbxScene, joints: list[int]) -> tuple[Floats, Floats]:
    """Positions (J, 3) and axes, as columns of (J, 3, 3), of the pose in which a mesh was bound to the skeleton.

    Where there is none for a joint, it stands in the next one above as the models' own values say.
    """
    stated: dict[int, Floats] = {}
    bound: dict[int, Floats] = {}
    for at, placed in place(scene, set(joints), {}, 1).items():
        stated[at] = np.eye(4)
        stated[at][:3] = np.concatenate([*placed.scaled, placed.position], axis=1)
        parent = scene.models[at].parent
        if at in scene.bind:
            bound[at] = scene.bind[at]
        elif parent in bound and scene.bind:
            bound[at] = bound[parent] @ np.linalg.pinv(stated[parent]) @ stated[at]
        else:
            bound[at] = stated[at]
    matrices = np.array([bound[at] for at in joints])
    axes = matrices[:, :3, :3]
    axes = axes / np.maximum(np.sqrt((axes**2).sum(axis=1, keepdims=True)), 1e-300)
    return matrices[:, :3, 3], axes


def _parents(scene: FbxScene, joints: list[int]) -> NDArray[np.int64]:
    """Of each joint the next joint above it, -1 where there is none."""
    rows = {at: i for i, at in enumerate(joints)}
    parents = []
    for at in joints:
        above = scene.models[at].parent
        while above >= 0 and above not in rows:
            above = scene.models[above].parent
        parents.append(rows.get(above, -1))
    return np.array(parents, np.int64)


def _named_apart(takes: list[Take]) -> list[Take]:
    """Takes whose names are not empty and differ."""
    seen: Counter[str] = Counter()
    named = []
    for i, take in enumerate(takes, start=1):
        name = take.name or f"take {i}"
        while seen[name]:
            name = f"{name} ({i})"
        seen[name] += 1
        named.append(replace(take, name=name))
    return named
