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
from indexer.formats.kinematics import quaternion_axes

Floats = NDArray[np.float64]


@dataclass
class Posed:
    """Nodes of a scene at given times: positions (N, 3, T), and axes (N, 3 axes, 3, T) with their scale."""

    names: list[str]
    positions: Floats
    scaled: Floats


def posed(scene: Any, stack: int, times: Floats, *, rate: float) -> Posed:
    """All nodes in the world at times (T,) in seconds, out of an animation baked at a rate that has frames there.

    The binding has neither evaluation of a scene nor node_to_world at a time, so that ufbx's local transforms are
    chained here. Only for scenes whose scales are passed on as matrices do (inherit type 1), or are 1.
    """
    import pufbx

    baked = pufbx.bake_anim(scene, scene.anim_stacks[stack].anim, resample_rate=rate, minimum_sample_rate=1e6)
    nodes = list(scene.nodes)
    places, turns, scales = _local(nodes, {node.typed_id: node for node in baked.modified_nodes}, times)
    rows = {node.element_id: row for row, node in enumerate(nodes)}
    axes = np.stack(quaternion_axes(turns / np.linalg.norm(turns, axis=0)), axis=0).transpose(2, 0, 1, 3)
    if (scales != 1).any():
        axes = axes * scales[:, :, None]
    positions, scaled = places, np.ascontiguousarray(axes)
    for row, node in enumerate(nodes):
        if node.parent is not None:
            above = rows[node.parent.element_id]
            positions[row] = positions[above] + np.einsum("jit,jt->it", scaled[above], places[row])
            scaled[row] = np.einsum("jit,kjt->kit", scaled[above], scaled[row])
    return Posed([node.name for node in nodes], positions, scaled)


def _local(nodes: Sequence[Any], baked: dict[int, Any], times: Floats) -> tuple[Floats, Floats, Floats]:
    """Translations (N, 3, T), rotations (4, N, T) and scales (N, 3, T) in the parents."""
    places, turns, scales = (
        np.empty((*shape, len(times))) for shape in ((len(nodes), 3), (4, len(nodes)), (len(nodes), 3))
    )
    for row, node in enumerate(nodes):
        moving = baked.get(node.typed_id)
        if moving is None:
            still = node.local_transform
            places[row] = np.array([[still.translation.x], [still.translation.y], [still.translation.z]])
            scales[row] = np.array([[still.scale.x], [still.scale.y], [still.scale.z]])
            turn = still.rotation
            turns[:, row] = np.array([[turn.x], [turn.y], [turn.z], [turn.w]])
        else:
            _fill(places[row], moving.translation_keys, times)
            _fill(scales[row], moving.scale_keys, times)
            _fill(turns[:, row], moving.rotation_keys, times)
    return places, turns, scales


def _fill(values: Floats, keys: Any, times: Floats) -> None:
    """Keys at times, straight between them; quaternions are near one another, so that this is near enough."""
    found, at = keys["value"], keys["time"]
    is_frame_by_frame = len(at) == len(times) and np.abs(at - times).max() < 1e-9
    for row, axis in zip(values, "xyzw", strict=False):
        row[:] = found[axis] if is_frame_by_frame else np.interp(times, at, found[axis])


def apart(path: Path, *, rate: float = 120.0) -> tuple[float, float]:
    """How far our joints lie from those of ufbx at all frames of all takes: in the file's units, and degrees of axes.

    `rate` is one at which ufbx has frames where we have them.
    """
    distance, angle = 0.0, 0.0
    import pufbx

    scene = pufbx.load_fbx(str(path))
    for stack, animation in enumerate(animations(path.read_bytes())):
        ticks = animation.times()
        theirs = posed(scene, stack, ticks / animation.scene.ticks, rate=rate)
        for joint, placed in zip(animation.joints, animation.world(ticks), strict=True):
            row = theirs.names.index(animation.scene.models[joint].name)
            distance = max(distance, float(np.abs(placed.position - theirs.positions[row]).max()))
            unit = [axes / np.linalg.norm(axes, axis=1, keepdims=True)
                    for axes in (placed.scaled, theirs.scaled[row])]  # fmt: skip
            chord = float(np.linalg.norm(unit[0] - unit[1], axis=1).max())
            angle = max(angle, float(np.degrees(2 * np.arcsin(min(chord / 2, 1)))))
    return distance, angle


def metres(path: Path) -> float:
    """Metres in a unit of the file; Blender writes 1 in centimetres."""
    return next(animations(path.read_bytes())).scene.unit / 100
