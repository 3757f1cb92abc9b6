"""World transforms: where models are at all frames, by the formula of the FBX SDK.

A model's transform is T Roff Rp Rpre R Rpost^-1 Rp^-1 Soff Sp S Sp^-1 (Autodesk, FBX SDK, "Computing transformation
matrices"): translation, rotation offset and pivot, the rotation between a constant one before and the inverse of a
constant one after it, and scaling about its own pivot. How a model takes over its parent's scale is its inherit type.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from indexer.formats.fbx.euler import ORDERS, axes_of
from indexer.formats.fbx.objects import FbxScene, Model
from indexer.formats.fbx.stacks import ROTATION, SCALING, TRANSLATION, Target
from indexer.formats.kinematics import Axes, turn

Floats = NDArray[np.float64]

#: Inherit types: the parent's scale along the child's axes, and none of it; others take it over as matrices do.
_ALONG_OWN_AXES, _IGNORED = 0, 2
_XYZ = ORDERS[0]
_OFFSETS = ("RotationOffset", "RotationPivot", "ScalingOffset", "ScalingPivot")


@dataclass(frozen=True)
class Placed:
    """A model at all frames.

    Attributes
    ----------
    position : float array (3, T)
    axes : float array (3, 3, T)
        Where each of its axes points, unscaled by its own scale.
    scaled : float array (3, 3, T)
        Its axes with its scale.
    scale : float array (3, T)
        What children of some inherit types take over.
    passed_by : float array (3, T) or None
        The scale that a child takes over which ignores that of this model.
    """

    position: Floats
    axes: Floats
    scaled: Floats
    scale: Floats
    passed_by: Floats | None = None


def place(scene: FbxScene, models: set[int], moved: Mapping[Target, Floats], frames: int) -> dict[int, Placed]:
    """Models in the world.

    Parameters
    ----------
    models : set of int
        Their places among the scene's models, with all that they hang on.
    moved : mapping
        Values (3, T) of what moves; what does not has the values that the scene states.
    frames : int
    """
    needed = sorted(models)
    rotations = _rotations([scene.models[at] for at in needed], [moved.get((at, ROTATION)) for at in needed], frames)
    axes = np.repeat(np.eye(3)[:, :, None], frames, axis=2)
    world = Placed(np.zeros((3, frames)), axes, axes, np.ones((3, 1)))
    placed: dict[int, Placed] = {}
    for at, rotation in zip(needed, rotations, strict=True):
        model = scene.models[at]
        translation, scaling = (
            moved[at, name] if (at, name) in moved else constant(model, name, default)[:, None]
            for name, default in ((TRANSLATION, 0.0), (SCALING, 1.0))
        )
        placed[at] = _placed(model, placed.get(model.parent, world), translation, rotation, scaling)
    return placed


def with_ancestors(scene: FbxScene, models: Iterable[int]) -> set[int]:
    """Models and all that they hang on."""
    found: set[int] = set()
    for at in models:
        while at >= 0 and at not in found:
            found.add(at)
            at = scene.models[at].parent
    return found


def constant(model: Model, name: str, default: float) -> Floats:
    """A property of three numbers, (3,)."""
    stated = model.properties.get(name, ())
    return np.array((*stated[:3], *(default,) * (3 - len(stated))), np.float64)


def _rotations(models: Sequence[Model], moved: Sequence[Floats | None], frames: int) -> Floats:
    """Local axes (M, 3 axes, 3, T) of models, of those before, in and after their rotation."""
    local = np.empty((len(models), 3, 3, frames))
    of_order: dict[tuple[int, int, int], list[int]] = defaultdict(list)
    for row, model in enumerate(models):
        of_order[axes_of(model.properties.get("RotationOrder", (0,))[0])].append(row)
    for order, rows in of_order.items():
        degrees = np.empty((3, len(rows), 1, frames))
        for i, row in enumerate(rows):
            value = moved[row]
            degrees[:, i, 0] = constant(models[row], ROTATION, 0.0)[:, None] if value is None else value
        local[rows] = np.stack(np.broadcast_arrays(*_turned(degrees, order)), axis=1)
    for name, is_after in (("PreRotation", False), ("PostRotation", True)):
        rows = [row for row, model in enumerate(models) if any(model.properties.get(name, ()))]
        if rows:
            degrees = np.array([constant(models[row], name, 0.0) for row in rows]).T[:, :, None, None]
            axes = np.stack(np.broadcast_arrays(*_turned(degrees, _XYZ)), axis=1)[..., 0]
            # an axis is a row here: rotations before turn all axes, those after choose others, and are inverted
            local[rows] = np.einsum("mjit,mjk->mkit" if is_after else "mkjt,mji->mkit", local[rows], axes)
    return local


def _turned(degrees: Floats, order: tuple[int, int, int]) -> Axes:
    """Axes of frames that are turned by angles (3, M, 1, T) about x, y and z, in an order; each (M, 3, T)."""
    x, y, z = np.eye(3)[:, None, :, None]
    axes: Axes = (x, y, z)
    for axis in reversed(order):
        axes = turn(axes, axis, np.deg2rad(degrees[axis]))
    return axes


def _placed(model: Model, parent: Placed, translation: Floats, rotation: Floats, scaling: Floats) -> Placed:
    kind = model.properties.get("InheritType", (1,))[0]
    inherits = kind not in (_ALONG_OWN_AXES, _IGNORED)
    base = parent.scaled if inherits else parent.axes
    step = translation
    if not model.properties.keys().isdisjoint(_OFFSETS):
        rotation_offset, rotation_pivot, scaling_offset, pivot = (
            constant(model, name, 0.0)[:, None] for name in _OFFSETS
        )
        step = step + rotation_offset + rotation_pivot
        step = step + along(rotation, scaling_offset + pivot - rotation_pivot - scaling * pivot)
    passed_by = None if inherits else parent.scale if kind == _ALONG_OWN_AXES else parent.passed_by
    own = scaling if passed_by is None else scaling * passed_by
    axes = np.einsum("jit,kjt->kit", base, rotation)
    scaled = axes if (own == 1).all() else axes * own[:, None]
    position = parent.position + along(base, step if inherits else step * parent.scale)
    return Placed(position, axes, scaled, own, passed_by)


def along(axes: Floats, local: Floats) -> Floats:
    """Directions (3, T) in the world of directions in a frame."""
    turned: Floats = axes[0] * local[0] + axes[1] * local[1] + axes[2] * local[2]
    return turned
