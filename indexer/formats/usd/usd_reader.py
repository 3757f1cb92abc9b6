"""USD: every skeletal animation (UsdSkel) of a stage is a take. It needs usd-core, the extra `usd`."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from os import PathLike
from typing import Any

import numpy as np
from numpy.typing import NDArray

from encoders.errors import UnreadableMotion
from indexer.formats.kinematics import Pose
from indexer.formats.scenes.bind_pose import bind_pose
from indexer.formats.scenes.key_times import key_rate, sample_times
from indexer.formats.scenes.scene_take import MAX_JOINTS, MAX_PLACES, scene_take
from indexer.formats.scenes.take_names import take_names
from indexer.formats.usd.usd_skeleton import UsdAnimation, UsdSkeleton, find_skeletons
from indexer.formats.usd.usd_stage import opened_stage
from indexer.take import Take

MAX_ANIMATIONS = 1000

Array = NDArray[np.float64]


def read(path: str | PathLike[str], data: bytes, *, fps: float | None = None) -> list[Take]:
    """Read the skeletal animations of a USD file, with the layers beside it that it refers to.

    An animation belongs to the skeletons it is bound to; one that is bound to none, to the first with all its joints.
    Up is what the stage says; the rest pose is the bind pose.

    Raises
    ------
    UnreadableMotion
        If usd-core is missing, the file damaged, or without skeletal animation.
    """
    with opened_stage(path, data) as stage:
        return _takes(path, stage, fps)


def _takes(path: str | PathLike[str], stage: Any, fps: float | None) -> list[Take]:
    from pxr import UsdGeom

    skeletons, animations = find_skeletons(stage)
    pairs = list(_pairs(skeletons, animations))
    if not pairs:
        held = "skeletons without animation" if skeletons else "animations without a skeleton" if animations else ""
        raise UnreadableMotion(path, f"it holds {held or 'no skeletal animation (UsdSkel)'}")
    if len(pairs) > MAX_ANIMATIONS or max(len(skeleton.joints) for skeleton, _ in pairs) > MAX_JOINTS:
        raise UnreadableMotion(path, f"it holds more than {MAX_ANIMATIONS} animations, or {MAX_JOINTS} joints in one")
    names = take_names([animation.prim.GetName() for _, animation in pairs], "animation")
    per_second = float(stage.GetTimeCodesPerSecond())
    if not 0 < per_second < 1e6:
        raise ValueError(f"there are {per_second:g} time codes a second")
    up = str(UsdGeom.GetStageUpAxis(stage)).lower()
    takes: list[Take] = []
    places = 0
    for (skeleton, animation), name in zip(pairs, names, strict=True):
        keys = np.unique([*animation.times(), *skeleton.times()]) / per_second
        rate = key_rate([keys])
        times = sample_times(float(keys[0]), float(keys[-1]), rate)
        places += len(times) * len(skeleton.joints)
        if places > MAX_PLACES:
            raise UnreadableMotion(path, "its animations are too long; cut the file into parts")
        takes.append(_take(stage, skeleton, animation, times, fps or rate, name, up))
    return takes if len(takes) > 1 else [replace(takes[0], name="")]


def _pairs(
    skeletons: Sequence[UsdSkeleton], animations: Sequence[UsdAnimation]
) -> Iterator[tuple[UsdSkeleton, UsdAnimation]]:
    """Skeletons and the animations that move them."""
    moving = {animation.prim.GetPath(): animation for animation in animations if animation.times()}
    bound = [(skeleton, moving.get(prim.GetPath())) for skeleton in skeletons if (prim := skeleton.animation())]
    for skeleton, animation in bound:
        if animation is not None:
            yield skeleton, animation
    for path, animation in moving.items():
        if all(other is None or other.prim.GetPath() != path for _, other in bound):
            fitting = next((s for s in skeletons if animation.joints and {*animation.joints} <= {*s.joints}), None)
            if fitting is not None:
                yield fitting, animation


def _take(
    stage: Any, skeleton: UsdSkeleton, animation: UsdAnimation, times: Array, fps: float, name: str, up: str
) -> Take:
    def posed(at: Array) -> list[Pose]:
        # Holds the stage: prims live as long as it does, and rotations are asked for after reading.
        codes = (at * float(stage.GetTimeCodesPerSecond())).tolist()
        return _worlds(skeleton, skeleton.places(codes), animation.locals(skeleton, codes))

    return scene_take(
        skeleton.names,
        skeleton.parents,
        _rest(skeleton, float(times[0] * stage.GetTimeCodesPerSecond())),
        {i for i, joint in enumerate(skeleton.joints) if joint in animation.joints},
        posed,
        times,
        fps=fps,
        name=name,
        up=up,
    )


def _worlds(skeleton: UsdSkeleton, place: Pose, local: Iterator[Pose]) -> list[Pose]:
    """World poses of joints from their own, below where the skeleton stands."""
    poses: list[Pose] = []
    for parent, own in zip(skeleton.parents.tolist(), local, strict=True):
        poses.append((place if parent < 0 else poses[parent]).below(own))
    return poses


def _rest(skeleton: UsdSkeleton, code: float) -> Array:
    """World matrices (J, 4, 4) of the bind pose, or else of the rest pose."""
    place = np.eye(4)
    pose = skeleton.places([code])
    place[:3] = np.column_stack([*(axis[:, 0] for axis in pose.axes), pose.position[:, 0]])
    now = np.empty_like(skeleton.local)
    for joint, parent in enumerate(skeleton.parents.tolist()):
        now[joint] = (place if parent < 0 else now[parent]) @ skeleton.local[joint]
    if skeleton.bind is None:
        return now
    inverse = np.asarray(np.linalg.pinv(skeleton.bind), np.float64)
    return bind_pose(now, inverse, skeleton.parents.tolist(), [np.eye(4), place])
