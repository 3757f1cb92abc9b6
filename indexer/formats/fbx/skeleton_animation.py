"""An animation of a scene's skeleton: its frames' times, joints in the world, and the rest pose."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from indexer.formats.fbx import binary_records, text_records
from indexer.formats.fbx.objects import FbxScene, read_scene
from indexer.formats.fbx.records import DamagedFbx
from indexer.formats.fbx.skeleton_nodes import joints_of
from indexer.formats.fbx.stacks import ROTATION, Stack, Target, move, read_stacks
from indexer.formats.fbx.takes_section import read_takes_section
from indexer.formats.fbx.world_transforms import Placed, place, with_ancestors

Floats = NDArray[np.float64]

DEFAULT_FPS = 30.0
#: Places of joints that an animation may have, however few keys it has; and so many more for each key.
_MAX_PLACES, _PLACES_A_KEY = 4_000_000, 10
_ALONG, _BOTH_WAYS = 0.95, 0.08  # of a T-pose: cosine of bones along an axis, share of their length on either way
_ON_GRID = 1e-3  # frames by which the last one may lie beyond the span, which programs round


@dataclass(frozen=True)
class SkeletonAnimation:
    """A stack of a scene, and the places of the joints among the scene's models, parents before children."""

    scene: FbxScene
    joints: tuple[int, ...]
    stack: Stack

    @property
    def fps(self) -> float:
        """Frames a second."""
        return self.scene.fps or DEFAULT_FPS

    def times(self) -> Floats:
        """The times (T,) of the frames, in ticks: of the stack's span, else from its first key to its last.

        Raises
        ------
        DamagedFbx
            If these are more frames than the keys account for.
        """
        first, last = self.stack.key_span() or (0.0, 0.0)
        span = self.stack.span
        start, stop = span if span is not None and span[1] > span[0] else (first, last)
        step = self.scene.ticks / self.fps
        keys = self.stack.key_count()
        most = (_MAX_PLACES + _PLACES_A_KEY * keys) // len(self.joints)
        if not (stop - start) / step < most:
            start, stop = max(start, first), min(stop, last)
        if not 0 <= (stop - start) / step < most:
            hours = (stop - start) / self.scene.ticks / 3600
            raise DamagedFbx(f"the animation {self.stack.name!r} lasts {hours:.3g} hours by {keys} keys")
        times: Floats = start + step * np.arange(int((stop - start) / step + _ON_GRID) + 1, dtype=np.float64)
        return times

    def world(self, ticks: Floats) -> list[Placed]:
        """The joints in the world at times (T,) in ticks."""
        needed = with_ancestors(self.scene, self.joints)
        placed = place(self.scene, needed, move(self.stack, self.scene, needed, ticks), len(ticks))
        return [placed[joint] for joint in self.joints]

    def turning(self) -> set[int]:
        """The rows of the joints whose rotation moves."""
        turning = {model for model, name in self.stack.targets() if name == ROTATION}
        return {row for row, joint in enumerate(self.joints) if joint in turning}

    def parents(self) -> NDArray[np.int64]:
        """Of each joint the next joint above it, -1 where there is none."""
        rows = {joint: row for row, joint in enumerate(self.joints)}
        parents = []
        for joint in self.joints:
            above = self.scene.models[joint].parent
            while above >= 0 and above not in rows:
                above = self.scene.models[above].parent
            parents.append(rows.get(above, -1))
        return np.array(parents, np.int64)

    def rest(self) -> Floats:
        """World matrices (J, 4, 4) of the pose in which a mesh was bound to the skeleton.

        Where there is none for a joint, it stands in the next one above as the models' own values say. Where there is
        none at all and joints that turn by nothing make a T-pose, that: the values are but a frame of the animation.

        Raises
        ------
        DamagedFbx
            Where these are no numbers.
        """
        stated = self._standing({})
        if not self.scene.bind:
            unturned = self._standing({(joint, ROTATION): np.zeros((3, 1)) for joint in self.joints})
            pose = np.array([unturned[joint] for joint in self.joints])
            return pose if is_t_pose(pose[:, :3, 3], self.parents()) else np.array([stated[j] for j in self.joints])
        bound: dict[int, Floats] = {}
        for model in stated:
            parent = self.scene.models[model].parent
            if model in self.scene.bind:
                bound[model] = self.scene.bind[model]
            elif parent in bound:
                bound[model] = bound[parent] @ np.linalg.pinv(stated[parent]) @ stated[model]
            else:
                bound[model] = stated[model]
        return np.array([bound[joint] for joint in self.joints])

    def _standing(self, moved: Mapping[Target, Floats]) -> dict[int, Floats]:
        """World matrices (4, 4) of the joints and all they hang on, parents first; `moved` values (3, 1), else stated.

        Raises
        ------
        DamagedFbx
            Where these are no numbers.
        """
        found: dict[int, Floats] = {}
        for model, placed in place(self.scene, with_ancestors(self.scene, self.joints), moved, 1).items():
            found[model] = np.eye(4)
            found[model][:3] = np.concatenate([placed.scaled[:, :, 0].T, placed.position], axis=1)
            if not np.isfinite(found[model]).all():
                raise DamagedFbx(f"{self.scene.models[model].name!r} stands at a place that is no number")
        return found


def is_t_pose(places: Floats, parents: NDArray[np.int64]) -> bool:
    """Whether bones of joints (J, 3) point both ways along two axes: legs and trunk, and arms stretched out."""
    inner = np.flatnonzero(parents >= 0)
    bones = places[inner] - places[parents[inner]]
    lengths = np.linalg.norm(bones, axis=-1)
    along = bones / np.maximum(lengths, 1e-9)[:, None]
    ways = np.minimum(*((lengths[:, None] * (sign * along > _ALONG)).sum(axis=0) for sign in (1, -1)))
    return bool((ways > _BOTH_WAYS * lengths.sum()).sum() >= 2)


def animations(data: bytes) -> Iterator[SkeletonAnimation]:
    """The animations of a file that move its skeleton; without joints there are none.

    Raises
    ------
    DamagedFbx
        Where the file is damaged.
    """
    is_binary = data.startswith(binary_records.MAGIC[:18])
    root = binary_records.parse(data) if is_binary else text_records.parse(data)
    scene = read_scene(root)
    stacks = read_stacks(root, scene) or read_takes_section(root, scene)
    turning = {model for stack in stacks for model, name in stack.targets() if name == ROTATION}
    joints = joints_of(scene, turning)
    if not joints:
        raise DamagedFbx("it holds no skeleton")
    for stack in stacks:
        if stack.key_count() and any(model in set(joints) for model, _ in stack.targets()):
            yield SkeletonAnimation(scene, tuple(joints), stack)
