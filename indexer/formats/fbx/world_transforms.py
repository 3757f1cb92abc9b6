"""World transforms: where models are at all frames, by the formula of the FBX SDK.

A model's transform is T Roff Rp Rpre R Rpost^-1 Rp^-1 Soff Sp S Sp^-1 (Autodesk, FBX SDK, "Computing transformation
matrices"): translation, rotation offset and pivot, the rotation between a constant one before and the inverse of a
constant one after it, and scaling about its own pivot. How a model takes over its parent's scale is its inherit type.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from indexer.formats.fbx.euler import axes_of
from indexer.formats.fbx.objects import FbxScene, Model
from indexer.formats.fbx.stacks import ROTATION, SCALING, TRANSLATION, Target
from indexer.formats.kinematics import Axes, turn

Floats = NDArray[np.float64]

#: Inherit types: the parent's scale along the child's axes, and none of it; others take it over as matrices do.
_ALONG_OWN_AXES, _IGNORED = 0, 2
_XYZ = 0


@dataclass(frozen=True)
class Placed:
    """A model at all frames.

    Attributes
    ----------
    position : float array (3, T)
    axes : three float arrays (3, T)
        Where its axes point, unscaled by its own scale.
    scaled : three float arrays (3, T)
        Its axes with its scale.
    scale : float array (3, T)
        What children of some inherit types take over.
    passed_by : float array (3, T) or None
        The scale that a child takes over which ignores that of this model.
    """

    position: Floats
    axes: Axes
    scaled: Axes
    scale: Floats
    passed_by: Floats | None = None


def place(scene: FbxScene, models: set[int], moved: Mapping[Target, Floats], frames: int) -> dict[int, Placed]:
    """Models and all above them, in the world.

    Parameters
    ----------
    models : set of int
        Their places among the scene's models.
    moved : mapping
        Values (3, T) of what moves; what does not has the values that the scene states.
    frames : int
    """
    needed = with_ancestors(scene, models)
    placed: dict[int, Placed] = {}
    identity = np.eye(3)
    world = Placed(
        np.zeros((3, frames)),
        (*(np.repeat(axis[:, None], frames, axis=1) for axis in identity),),  # type: ignore[arg-type]
        (*(np.repeat(axis[:, None], frames, axis=1) for axis in identity),),  # type: ignore[arg-type]
        np.ones((3, 1)),
    )
    for at in sorted(needed):
        model = scene.models[at]
        local = [
            moved[at, name] if (at, name) in moved else constant(model, name, 1.0 if name == SCALING else 0.0)[:, None]
            for name in (TRANSLATION, ROTATION, SCALING)
        ]
        placed[at] = _placed(model, placed.get(model.parent, world), *local)
    return placed


def with_ancestors(scene: FbxScene, models: set[int]) -> set[int]:
    """Models and all that they hang on."""
    found: set[int] = set()
    for at in models:
        while at >= 0 and at not in found:
            found.add(at)
            at = scene.models[at].parent
    return found


def constant(model: Model, name: str, default: float) -> Floats:
    """A property of three numbers, (3,)."""
    value = np.full(3, default)
    stated = model.properties.get(name, ())
    value[: len(stated)] = stated[:3]
    return value


def _placed(model: Model, parent: Placed, translation: Floats, rotation: Floats, scaling: Floats) -> Placed:
    kind = model.properties.get("InheritType", (1,))[0]
    inherits = kind not in (_ALONG_OWN_AXES, _IGNORED)
    base = parent.scaled if inherits else parent.axes
    local = constant(model, "PreRotation", 0.0)
    order = axes_of(model.properties.get("RotationOrder", (0,))[0])
    axes = _turned(_turned(_identity(), local, axes_of(_XYZ)), rotation, order)
    after = constant(model, "PostRotation", 0.0)
    if after.any():
        axes = _mixed(axes, _transposed(_turned(_identity(), after[:, None], axes_of(_XYZ))))
    turned = _mixed(base, axes)

    pivot, rotation_pivot = (
        constant(model, "ScalingPivot", 0.0)[:, None],
        constant(model, "RotationPivot", 0.0)[:, None],
    )
    offset = constant(model, "ScalingOffset", 0.0)[:, None] + pivot - rotation_pivot - scaling * pivot
    step = translation + constant(model, "RotationOffset", 0.0)[:, None] + rotation_pivot
    if offset.any():
        step = step + _along(axes, offset)

    passed_by = None if inherits else parent.scale if kind == _ALONG_OWN_AXES else parent.passed_by
    own = scaling if passed_by is None else scaling * passed_by
    position = parent.position + _along(base, step if inherits else step * parent.scale)
    scaled: Axes = (turned[0] * own[0], turned[1] * own[1], turned[2] * own[2])
    return Placed(position, turned, scaled, own, passed_by)


def _identity() -> Axes:
    x, y, z = np.eye(3)[:, :, None]
    return x, y, z


def _turned(axes: Axes, degrees: Floats, order: tuple[int, int, int]) -> Axes:
    """Frames turned by angles (3, T) about x, y and z, in an order."""
    for axis in reversed(order):
        angle = np.deg2rad(degrees[axis])
        if np.any(angle):
            axes = turn(axes, axis, angle)
    return axes


def _mixed(outer: Axes, inner: Axes) -> Axes:
    """Frames within frames."""
    return _along(outer, inner[0]), _along(outer, inner[1]), _along(outer, inner[2])


def _along(axes: Axes, local: Floats) -> Floats:
    """Directions (3, T) in the world of directions in a frame."""
    turned: Floats = axes[0] * local[0] + axes[1] * local[1] + axes[2] * local[2]
    return turned


def _transposed(axes: Axes) -> Axes:
    x, y, z = np.stack(axes, axis=1)
    return x, y, z
