"""What ufbx, an FBX reader in C, makes of a file: joints in the world, through its Python binding `pufbx`.

`pufbx` is published as source only, so it is no dependency: `pip install pufbx` where there is a C compiler.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from indexer.formats.fbx.skeleton_animation import animations

Floats = NDArray[np.float64]


@dataclass
class Posed:
    """Nodes of a scene at given times: positions (T, 3), axes as columns (T, 3, 3) with their scale."""

    names: list[str]
    positions: list[Floats]
    scaled: list[Floats]


def posed(path: Path, stack: int, times: Floats, *, rate: float) -> Posed:
    """All nodes in the world at times (T,) in seconds, out of an animation baked at a rate that has frames there.

    Only for scenes whose scales are passed on as matrices do (inherit type 1), or are 1.
    """
    import pufbx

    scene = pufbx.load_fbx(str(path))
    anim = scene.anim_stacks[stack].anim
    baked = {
        node.typed_id: node
        for node in pufbx.bake_anim(scene, anim, resample_rate=rate, minimum_sample_rate=1e6).modified_nodes
    }
    nodes = scene.nodes
    rows = {node.element_id: row for row, node in enumerate(nodes)}
    result = Posed([], [], [])
    for node in nodes:
        place, turn, scale = _local(node, baked.get(node.typed_id), times)
        axes = turn * scale[:, None, :]
        if node.parent is not None:
            above = rows[node.parent.element_id]
            place = result.positions[above] + np.einsum("tij,tj->ti", result.scaled[above], place)
            axes = result.scaled[above] @ axes
        result.names.append(node.name)
        result.positions.append(place)
        result.scaled.append(axes)
    return result


def _local(node: Any, baked: Any, times: Floats) -> tuple[Floats, Floats, Floats]:
    """Translation (T, 3), rotation (T, 3, 3) and scale (T, 3) in the parent."""
    still = node.local_transform
    if baked is None:
        rows = [np.repeat([[v.x, v.y, v.z]], len(times), axis=0) for v in (still.translation, still.scale)]
        turn = np.array([still.rotation.x, still.rotation.y, still.rotation.z, still.rotation.w])
        return rows[0], _matrices(np.repeat(turn[None], len(times), axis=0)), rows[1]
    place = _between(baked.translation_keys, "xyz", times)
    scale = _between(baked.scale_keys, "xyz", times)
    return place, _matrices(_between(baked.rotation_keys, "xyzw", times)), scale


def _between(keys: Any, axes: Sequence[str], times: Floats) -> Floats:
    """Keys at times, straight between them; quaternions are near one another, so that this is near enough."""
    return np.stack([np.interp(times, keys["time"], keys["value"][axis]) for axis in axes], axis=1)


def _matrices(quaternions: Floats) -> Floats:
    x, y, z, w = (quaternions / np.linalg.norm(quaternions, axis=1, keepdims=True)).T
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
        ]
    ).transpose(2, 0, 1)


def apart(path: Path, *, rate: float = 120.0) -> tuple[float, float]:
    """How far our joints lie from those of ufbx at all frames of all takes: in the file's units, and degrees of axes.

    `rate` is one at which ufbx has frames where we have them.
    """
    distance, angle = 0.0, 0.0
    for stack, animation in enumerate(animations(path.read_bytes())):
        ticks = animation.times()
        theirs = posed(path, stack, ticks / animation.scene.ticks, rate=rate)
        for joint, placed in zip(animation.joints, animation.world(ticks), strict=True):
            row = theirs.names.index(animation.scene.models[joint].name)
            distance = max(distance, float(np.abs(placed.position.T - theirs.positions[row]).max()))
            unit = [axes / np.linalg.norm(axes, axis=1, keepdims=True)
                    for axes in (placed.scaled.transpose(2, 1, 0), theirs.scaled[row])]  # fmt: skip
            chord = float(np.linalg.norm(unit[0] - unit[1], axis=1).max())
            angle = max(angle, float(np.degrees(2 * np.arcsin(min(chord / 2, 1)))))
    return distance, angle


def metres(path: Path) -> float:
    """Metres in a unit of the file; Blender writes 1 in centimetres."""
    return next(animations(path.read_bytes())).scene.unit / 100
