"""Skeletons and their animations on a USD stage (UsdSkel), in columns and arrays of NumPy."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from encoders.geometry import unit
from indexer.formats.kinematics import Pose, quaternion_axes

MAX_PRIMS = 1_000_000

Array = NDArray[np.float64]


@dataclass(frozen=True)
class UsdSkeleton:
    """A Skeleton prim.

    Attributes
    ----------
    prim : pxr.Usd.Prim
    joints : list of str
        Their paths, parents before children.
    names : list of str
    parents : int array (J,)
    local : float array (J, 4, 4)
        Their own transforms where nothing moves them, for column vectors.
    bind : float array (J, 4, 4) or None
        The bind pose in the world.
    """

    prim: Any
    joints: list[str]
    names: list[str]
    parents: NDArray[np.int64]
    local: Array
    bind: Array | None

    @classmethod
    def of(cls, prim: Any) -> UsdSkeleton:
        """Read a Skeleton prim.

        Raises
        ------
        ValueError
            If its joints are out of order.
        """
        from pxr import UsdSkel

        schema = UsdSkel.Skeleton(prim)
        tokens = schema.GetJointsAttr().Get() or []
        joints = [str(token) for token in tokens]
        parents = np.array(UsdSkel.Topology(tokens).GetParentIndices(), np.int64).reshape(-1)
        if (parents >= np.arange(len(joints))).any():
            raise ValueError(f"joints of {prim.GetPath()} stand before their parents")
        names = [str(name) for name in schema.GetJointNamesAttr().Get() or []]
        if len(names) != len(joints):
            names = [joint.rpartition("/")[2] for joint in joints]
        bind = _matrices(schema.GetBindTransformsAttr().Get(), len(joints))
        local = _matrices(schema.GetRestTransformsAttr().Get(), len(joints))
        if local is None:
            worlds = np.repeat(np.eye(4)[None], len(joints), axis=0) if bind is None else bind
            above = np.where(parents[:, None, None] >= 0, worlds[parents], np.eye(4))
            local = np.linalg.pinv(above) @ worlds
        return cls(prim, joints, names, parents, local, bind)

    def animation(self) -> Any:
        """The SkelAnimation prim bound to it or to a prim above, or None."""
        prim = self.prim
        while prim and not prim.IsPseudoRoot():
            relation = prim.GetRelationship("skel:animationSource")
            targets = relation.GetForwardedTargets() if relation else []
            if targets:
                found = prim.GetStage().GetPrimAtPath(targets[0])
                return found if found else None
            prim = prim.GetParent()
        return None

    def places(self, codes: Sequence[float]) -> Pose:
        """Where it stands in the world at time codes; axes and position are (3, 1) where that does not change."""
        from pxr import UsdGeom

        above = [prim for prim in _and_above(self.prim) if prim.IsA(UsdGeom.Xformable)]
        varies = any(UsdGeom.Xformable(prim).TransformMightBeTimeVarying() for prim in above)
        matrices = [
            np.array(UsdGeom.XformCache(code).GetLocalToWorldTransform(self.prim))
            for code in (codes if varies else codes[:1])
        ]
        x, y, z, position = np.array(matrices)[:, :, :3].transpose(1, 2, 0)
        return Pose((x, y, z), position)

    def times(self) -> list[float]:
        """Time codes at which what it stands on has keys."""
        from pxr import UsdGeom

        found: list[float] = []
        for prim in _and_above(self.prim):
            if prim.IsA(UsdGeom.Xformable):
                found += UsdGeom.Xformable(prim).GetTimeSamples()
        return found


@dataclass(frozen=True)
class UsdAnimation:
    """A SkelAnimation prim: transforms of joints, each relative to its parent, over time."""

    prim: Any
    joints: list[str]
    _attributes: tuple[Any, Any, Any]

    @classmethod
    def of(cls, prim: Any) -> UsdAnimation:
        """Read a SkelAnimation prim."""
        from pxr import UsdSkel

        schema = UsdSkel.Animation(prim)
        joints = [str(token) for token in schema.GetJointsAttr().Get() or []]
        attributes = (schema.GetTranslationsAttr(), schema.GetRotationsAttr(), schema.GetScalesAttr())
        return cls(prim, joints, attributes)

    def times(self) -> list[float]:
        """Time codes of its keys."""
        return [time for attribute in self._attributes for time in attribute.GetTimeSamples()]

    def locals(self, skeleton: UsdSkeleton, codes: Sequence[float]) -> Iterator[Pose]:
        """Each joint of a skeleton relative to its parent; as it rests where the animation says nothing.

        Raises
        ------
        ValueError
            If there are not as many values as joints.
        """
        translations, rotations, scales = (self._values(attribute, codes) for attribute in self._attributes)
        number = {joint: i for i, joint in enumerate(self.joints)}
        for joint, matrix in zip(skeleton.joints, skeleton.local, strict=True):
            i = number.get(joint)
            size = np.linalg.norm(matrix[:3, :3], axis=0)
            x, y, z = (matrix[:3, :3] / np.where(size > 0, size, 1.0)).T[:, :, None]
            scale, position = size[:, None], matrix[:3, 3:]
            if i is not None and rotations is not None:
                x, y, z = quaternion_axes(unit(rotations[:, i]).T)
            if i is not None and scales is not None:
                scale = scales[:, i].T
            if i is not None and translations is not None:
                position = translations[:, i].T
            yield Pose((x * scale[0], y * scale[1], z * scale[2]), position)

    def _values(self, attribute: Any, codes: Sequence[float]) -> Array | None:
        """Values (T, joints, 3 or 4), T = 1 where they do not change; None where there are none."""
        if not attribute.HasAuthoredValue():
            return None
        rows = [attribute.Get(code) for code in (codes if attribute.ValueMightBeTimeVarying() else codes[:1])]
        if any(row is None or len(row) != len(self.joints) for row in rows):
            raise ValueError(f"{attribute.GetPath()} has not as many values as joints")
        values = np.array([np.asarray(row, np.float64) for row in rows])
        if not np.isfinite(values).all():
            raise ValueError(f"{attribute.GetPath()} holds values that are no numbers")
        return values


def find_skeletons(stage: Any) -> tuple[list[UsdSkeleton], list[UsdAnimation]]:
    """All skeletons of a stage that have joints, and all skeletal animations, in the order of their prims.

    Raises
    ------
    ValueError
        If a skeleton's joints are out of order, or there are too many prims.
    """
    from pxr import Usd, UsdSkel

    skeletons, animations = [], []
    for number, prim in enumerate(Usd.PrimRange.Stage(stage, Usd.TraverseInstanceProxies())):
        if number > MAX_PRIMS:
            raise ValueError(f"it holds more than {MAX_PRIMS} prims")
        if prim.IsA(UsdSkel.Skeleton) and UsdSkel.Skeleton(prim).GetJointsAttr().Get():
            skeletons.append(UsdSkeleton.of(prim))
        elif prim.IsA(UsdSkel.Animation):
            animations.append(UsdAnimation.of(prim))
    return skeletons, animations


def _and_above(prim: Any) -> Iterator[Any]:
    while prim and not prim.IsPseudoRoot():
        yield prim
        prim = prim.GetParent()


def _matrices(values: Any, count: int) -> Array | None:
    """Matrices for column vectors, (J, 4, 4); None where there are not as many as joints or no numbers."""
    if values is None or len(values) != count:
        return None
    matrices: Array = np.array(values, np.float64).reshape(-1, 4, 4).swapaxes(1, 2)
    return matrices if np.isfinite(matrices).all() else None
