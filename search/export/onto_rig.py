"""A motion on the skeleton of another file: its joints turn from a known pose as the body turns from that pose."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from encoders.errors import QueryError
from encoders.motion import Motion
from encoders.skeleton import INDEX
from indexer.ingest.file_parts import read_take
from indexer.rigs.landmarks import Landmarks
from indexer.rigs.mapping import RigMap, map_rig
from indexer.rigs.orientation import orientation
from indexer.rigs.rest_pose import standing_axes
from indexer.rigs.retarget import LEG_LENGTH, retarget
from indexer.rigs.topology import ancestry, meeting
from indexer.rigs.up_axis import up_axis
from indexer.take import Take
from search.export.posed_rig import joint_rotations
from search.export.quaternions import between, to_matrices, to_quaternions
from search.export.rig_motion import RigMotion

Array = NDArray[np.float64]


def onto_rig(motion: Motion, like: Path) -> RigMotion:
    """The motion on the skeleton of a file, in the file's units and axes.

    In a pose of the skeleton that is known (the rest pose where it stands, else the first frame) the file's reader
    says how the 22 joints are. From there each joint is turned as the joint of the 22 that it stands for; joints of the
    back turn by shares, others with their parents.

    Raises
    ------
    UnreadableMotion, UnknownRig
        If the file cannot be read, or its skeleton is no body's.
    QueryError
        If it holds no rotations, which a skeleton needs that is to be turned.
    """
    take = read_take(like)
    if take.rotations is None:
        raise QueryError(f"{like}: holds joint positions only; give a file with a skeleton that turns, such as a .bvh")
    rig = map_rig(take, like)
    known, at_first = _known_pose(take, rig)
    joints = motion.joints.astype(np.float64)
    body = joint_rotations(retarget(known, path=like).joints.astype(np.float64)[:1])
    turns = joint_rotations(joints) @ np.swapaxes(body, -1, -2)
    marks, rest = Landmarks.of(known.positions, rig), Landmarks.of(known.rest[None], rig)
    axis = up_axis(marks, rest, take.up, is_certain=take.up_is_certain).axis
    matrix = orientation(axis, marks, rest)  # from the file's axes to ours
    base, turned = _joint_turns(take, rig, turns)
    turned = matrix.T @ turned @ matrix
    pose = known.positions[0]
    positions = np.repeat(pose[None], len(motion), axis=0)
    for joint in _below(take.parents, base)[1:]:
        parent = take.parents[joint]
        positions[:, joint] = positions[:, parent] + turned[:, parent] @ (pose[joint] - pose[parent])
    scale = marks.leg_length / LEG_LENGTH
    ours = joints[:, [_target(mark) for mark in rig.joints]] @ matrix * scale
    theirs = positions[:, list(rig.joints.values())]
    hips = [list(rig.joints).index(f"{side}_hip") for side in ("left", "right")]
    way = (ours[:, hips] - theirs[:, hips]).mean(axis=1)
    up = matrix[1]
    way += up * ((ours @ up).min() - ((theirs + way[:, None]) @ up).min())  # limbs of other lengths reach the floor
    positions[:, _below(take.parents, base)] += way[:, None]
    return RigMotion(take.names, take.parents, take.rest, positions, turned @ at_first, motion.fps)


def _known_pose(take: Take, rig: RigMap) -> tuple[Take, Array]:
    """A take of the one pose in which the skeleton is compared with the body, and its rotations (J, 3, 3)."""
    if standing_axes(Landmarks.of(take.rest[None], rig)) is not None:
        pose, rotations = take.rest[None], np.broadcast_to(np.eye(3), (len(take.names), 3, 3))
    else:
        assert take.rotations is not None
        pose, rotations = take.positions[:1], take.rotations()[0]
    return replace(take, positions=pose, rotations=None, warnings=()), rotations


def _joint_turns(take: Take, rig: RigMap, turns: Array) -> tuple[int, Array]:
    """The joint that carries the body, and how each joint (T, J, 3, 3) turns by how the 22 do (T, 22, 3, 3)."""
    parents = take.parents
    ends = [rig.joints[f"{side}_{joint}"] for joint in ("hip", "shoulder") for side in ("left", "right")]
    base = ends[0]
    for end in ends[1:]:
        found = meeting(parents, base, end)
        base = base if found is None else found
    roles = {joint: _target(mark) for mark, joint in rig.joints.items()}
    spine = [joint for joint in rig.spine if base in ancestry(parents, joint)[1:]]
    low, high = (to_quaternions(turns[:, INDEX[name]]) for name in ("pelvis", "spine3"))
    turned = np.broadcast_to(np.eye(3), (len(turns), len(parents), 3, 3)).copy()
    for joint in _below(parents, base):
        if joint == base:
            turned[:, joint] = turns[:, INDEX["pelvis"]]
        elif joint in roles:
            turned[:, joint] = turns[:, roles[joint]]
        elif joint in spine:
            share = np.full(len(turns), (spine.index(joint) + 1) / len(spine))
            turned[:, joint] = to_matrices(between(low, high, share))
        else:
            turned[:, joint] = turned[:, parents[joint]]
    return base, turned


def _target(mark: str) -> int:
    """Which of the 22 joints a landmark is."""
    return INDEX[mark.replace("toe", "foot")]


def _below(parents: NDArray[np.int64], base: int) -> list[int]:
    """A joint and all below it, parents first."""
    below = {base}
    for joint, parent in enumerate(parents.tolist()):
        if parent in below:
            below.add(joint)
    return sorted(below)
