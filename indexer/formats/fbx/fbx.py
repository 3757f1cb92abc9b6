"""FBX, binary and ASCII, versions 6.1 to 7.7: each animation stack is a take.

Positions are those of the scene's skeleton in the world, in the file's units and axes, at the file's frame rate.
"""

from __future__ import annotations

import re
from dataclasses import replace
from os import PathLike

import numpy as np
from numpy.typing import NDArray

from encoders.errors import UnreadableMotion
from indexer.formats.fbx.records import DamagedFbx
from indexer.formats.fbx.skeleton_animation import DEFAULT_FPS, SkeletonAnimation, animations
from indexer.formats.kinematics import Pose
from indexer.formats.scenes.scene_take import MAX_JOINTS, MAX_PLACES, scene_take
from indexer.formats.scenes.take_names import take_names
from indexer.take import Take

_END = re.compile(r"(end|tip|nub|site)[\W_]*\d*$", re.IGNORECASE)  # names of joints that are no more than an end


def read(path: str | PathLike[str], data: bytes, *, fps: float | None = None) -> list[Take]:
    """Read the animations of an FBX file.

    Raises
    ------
    UnreadableMotion
        Where the file is damaged, holds no skeleton or no animation.
    """
    try:
        with np.errstate(all="ignore"):  # what overflows is no number, and refused
            found = list(animations(data))
            if not found:
                raise UnreadableMotion(path, "the FBX holds no animation of its skeleton: export it with one, baked")
            names = take_names([animation.stack.name for animation in found], "take")
            left, takes = MAX_PLACES, []
            for animation, name in zip(found, names, strict=True):
                takes.append(_take(animation, name, fps, left))
                left -= takes[-1].positions.size // 3
            return takes
    except DamagedFbx as error:
        raise UnreadableMotion(path, f"the FBX cannot be read: {error}") from None


def _take(animation: SkeletonAnimation, name: str, fps: float | None, left: int) -> Take:
    scene, joints = animation.scene, animation.joints
    if len(joints) > MAX_JOINTS:
        raise DamagedFbx(f"more than {MAX_JOINTS} joints are no skeleton of a person")
    ticks, rest = animation.times(), animation.rest()
    if len(ticks) * len(joints) > left:
        raise DamagedFbx("it holds more frames than memory bears; cut it into takes")
    names = [scene.models[joint].name or f"joint{row}" for row, joint in enumerate(joints)]

    def posed(times: NDArray[np.float64]) -> list[Pose]:
        return [
            Pose((placed.scaled[0], placed.scaled[1], placed.scaled[2]), placed.position)
            for placed in animation.world(times)
        ]

    ends = {row for row in animation.turning() if not _END.search(names[row])}
    take = scene_take(
        names, animation.parents(), rest, ends, posed, ticks, fps=fps or animation.fps, name=name, up=scene.up
    )
    if not np.isfinite(take.positions).all() or not np.isfinite(take.rest).all():
        raise DamagedFbx(f"the animation {name!r} holds places that are no numbers")

    return replace(take, warnings=_warnings(animation))


def _warnings(animation: SkeletonAnimation) -> tuple[str, ...]:
    warnings = []
    if animation.scene.fps is None:
        warnings.append(f"the file states no frame rate: {DEFAULT_FPS:g} frames a second are taken")
    if animation.scene.has_constraints:
        warnings.append("constraints are not applied: only what is keyed moves")
    return tuple(warnings)
