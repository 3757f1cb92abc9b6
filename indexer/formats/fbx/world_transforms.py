"""World transforms: where models are at all frames, by the formula of the FBX SDK.

A model's transform is T Roff Rp Rpre R Rpost^-1 Rp^-1 Soff Sp S Sp^-1 (Autodesk, FBX SDK, "Computing transformation
matrices"): translation, rotation offset and pivot, the rotation between a constant one before and the inverse of a
constant one after it, and scaling about its own pivot. How a model takes over its parent's scale is its inherit type.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from indexer.formats.fbx.euler import ORDERS, axes_of, euler_axes
from indexer.formats.fbx.objects import FbxScene, Model
from indexer.formats.fbx.stacks import ROTATION, SCALING, TRANSLATION, Target

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]

#: Inherit types: the parent's scale along the child's axes, and none of it; others take it over as matrices do.
_ALONG_OWN_AXES, _IGNORED = 0, 2
_OFFSETS = ("RotationOffset", "RotationPivot", "ScalingOffset", "ScalingPivot")
_BLOCK = 256  # frames whose transforms fit the processor's cache


class Placed(NamedTuple):
    """A model at all frames: its position (3, T), and where its axes point (3, 3, T), with their scale."""

    position: Floats
    scaled: Floats


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
    rows = {at: row for row, at in enumerate(needed)}
    chosen = [scene.models[at] for at in needed]
    values = {name: [moved.get((at, name)) for at in needed] for name in (TRANSLATION, ROTATION, SCALING)}
    scales = _scales(chosen, values[SCALING], frames)
    rotations = _rotations(chosen, values[ROTATION], frames)
    steps = _steps(chosen, values[TRANSLATION], rotations, scales)
    levels = list(_levels([rows.get(model.parent, -1) for model in chosen]))
    kinds = np.array([model.properties.get("InheritType", (1,))[0] for model in chosen])
    if not np.isin(kinds, (_ALONG_OWN_AXES, _IGNORED)).any():
        if (scales != 1).any():
            rotations *= scales[:, :, None]
        _chain(levels, steps, rotations)
        scaled = rotations
    else:
        scaled = _chain_by_kind(levels, kinds, steps, rotations, scales)
    return {at: Placed(steps[row], scaled[row]) for at, row in rows.items()}


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


def _stated(models: Sequence[Model], name: str, default: float) -> Floats:
    """A property of three numbers of models, (M, 3, 1)."""
    return np.array([constant(model, name, default) for model in models])[:, :, None]


def _values(models: Sequence[Model], name: str, default: float, moved: Sequence[Floats | None], frames: int) -> Floats:
    """Values (M, 3, T) of a property of models, of which some move."""
    values = np.empty((len(models), 3, frames))
    for row, (model, value) in enumerate(zip(models, moved, strict=True)):
        values[row] = constant(model, name, default)[:, None] if value is None else value
    return values


def _scales(models: Sequence[Model], moved: Sequence[Floats | None], frames: int) -> Floats:
    """Local scales (M, 3, T), or (M, 3, 1) where none changes."""
    if any(value is not None and (value != value[:, :1]).any() for value in moved):
        return _values(models, SCALING, 1.0, moved, frames)
    return _values(models, SCALING, 1.0, [value if value is None else value[:, :1] for value in moved], 1)


def _rotations(models: Sequence[Model], moved: Sequence[Floats | None], frames: int) -> Floats:
    """Local axes (M, 3 axes, 3, T) of models, of those before, in and after their rotation."""
    local = np.empty((len(models), 3, 3, frames))
    of_order: dict[tuple[int, int, int], list[int]] = defaultdict(list)
    for row, model in enumerate(models):
        of_order[axes_of(model.properties.get("RotationOrder", (0,))[0])].append(row)
    for order, rows in of_order.items():
        degrees = _values([models[row] for row in rows], ROTATION, 0.0, [moved[row] for row in rows], frames)
        if len(rows) == len(models):
            euler_axes(degrees, order, local)
        else:
            turned = np.empty((len(rows), 3, 3, frames))
            euler_axes(degrees, order, turned)
            local[rows] = turned
    for name, is_after in (("PreRotation", False), ("PostRotation", True)):
        rows = [row for row, model in enumerate(models) if any(model.properties.get(name, ()))]
        if rows:
            turned = np.empty((len(rows), 3, 3, 1))
            euler_axes(_stated([models[row] for row in rows], name, 0.0), ORDERS[0], turned)
            # an axis is a row here: rotations before turn all axes, those after choose others, and are inverted
            to = "mjit,mjk->mkit" if is_after else "mkjt,mji->mkit"
            local[rows] = np.einsum(to, local[rows], turned[..., 0])
    return local


def _steps(models: Sequence[Model], moved: Sequence[Floats | None], rotations: Floats, scales: Floats) -> Floats:
    """Where models stand in their parents (M, 3, T), with what offsets and pivots add."""
    steps = _values(models, TRANSLATION, 0.0, moved, rotations.shape[-1])
    rows = [row for row, model in enumerate(models) if any(any(model.properties.get(name, ())) for name in _OFFSETS)]
    if rows:
        rotation_offset, rotation_pivot, scaling_offset, pivot = (
            _stated([models[row] for row in rows], name, 0.0) for name in _OFFSETS
        )
        inner = scaling_offset + pivot - rotation_pivot - scales[rows] * pivot
        inner = np.broadcast_to(inner, (len(rows), *steps.shape[1:]))
        steps[rows] += rotation_offset + rotation_pivot + _along(rotations[rows], inner)
    return steps


def _levels(parents: Sequence[int]) -> Iterator[tuple[Integers, Integers]]:
    """Rows of models that have as many above them, and of their parents; from those on, that have one."""
    depths: list[int] = []
    for parent in parents:
        depths.append(depths[parent] + 1 if parent >= 0 else 0)
    for depth in range(1, max(depths, default=0) + 1):
        rows = np.flatnonzero(np.array(depths) == depth)
        yield rows, np.array(parents)[rows]


def _chain(levels: Sequence[tuple[Integers, Integers]], steps: Floats, axes: Floats) -> None:
    """Turn steps (M, 3, T) and axes (M, 3, 3, T) in the parents into those in the world."""
    for start in range(0, steps.shape[-1], _BLOCK):
        step, axis = steps[..., start : start + _BLOCK], axes[..., start : start + _BLOCK]
        for rows, above in levels:
            base = axis[above]
            step[rows] = step[above] + _along(base, step[rows])
            axis[rows] = _turned(base, axis[rows])


def _chain_by_kind(
    levels: Sequence[tuple[Integers, Integers]], kinds: NDArray[Any], steps: Floats, axes: Floats, scales: Floats
) -> Floats:
    """The same where some take their parent's scale over otherwise; the axes with their scale, (M, 3, 3, T)."""
    own, passed_by = scales.copy(), np.ones_like(scales)  # what children take over, and what those that ignore it do
    scaled = axes * scales[:, :, None]
    for rows, above in levels:
        kind = kinds[rows][:, None, None]
        inherits = (kind != _ALONG_OWN_AXES) & (kind != _IGNORED)
        passed_by[rows] = np.where(inherits, 1.0, np.where(kind == _IGNORED, passed_by[above], own[above]))
        own[rows] = scales[rows] * passed_by[rows]
        base = np.where(inherits[..., None], scaled[above], axes[above])
        steps[rows] = steps[above] + _along(base, steps[rows] * np.where(inherits, 1.0, own[above]))
        axes[rows] = _turned(base, axes[rows])
        scaled[rows] = axes[rows] * own[rows][:, :, None]
    return scaled


def _along(axes: Floats, local: Floats) -> Floats:
    """Directions (M, 3, T) in the world of directions in frames."""
    turned: Floats = np.einsum("mjit,mjt->mit", axes, local)
    return turned


def _turned(axes: Floats, local: Floats) -> Floats:
    """Axes (M, 3, 3, T) in the world of axes in frames."""
    turned: Floats = np.einsum("mjit,mkjt->mkit", axes, local)
    return turned
