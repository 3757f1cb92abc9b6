"""Animals and machines that have what a body needs are told from people by their rest pose."""

from __future__ import annotations

from collections.abc import Mapping
from os import PathLike

import numpy as np

from encoders.errors import UnreadableMotion
from encoders.geometry import Array, unit
from indexer.rigs.joint_names import name_words, vocabulary
from indexer.rigs.landmarks import Landmarks
from indexer.rigs.mapping import SIDES, RigMap
from indexer.rigs.topology import ancestry, children
from indexer.take import Take

_LEVEL = 0.5  # cosine between trunk and legs below which the trunk is level; people who crawl have bent knees
_PARALLEL = 0.8  # cosine between arms and legs
_REACH = 0.3  # leg lengths within which hands or feet are at one height
_LONG, _JOINTS = 0.7, 3  # leg lengths and joints that a leg has at least
_APART = 0.15  # leg lengths by which mirrored legs may differ
_TAIL, _WINGS = "tail", {"wing", "wings"}
_ARM = [f"{side}_{joint}" for side in SIDES for joint in ("shoulder", "elbow", "wrist")]


def check_human(take: Take, rig: RigMap, path: str | PathLike[str]) -> None:
    """Refuse a figure that is no person.

    A rest pose that shows a level trunk on four legs, or with a tail, is an animal's; one on more than two legs is an
    animal's or a machine's, and one whose arms are wings a bird's. What a person does in the movement does not matter,
    nor do tails, wings beside arms, and capes.

    Raises
    ------
    UnreadableMotion
        With what is seen.
    """
    rest = Landmarks.of(take.rest[None], rig)
    arm = {word for mark in _ARM for word in name_words(take.names[rig.joints[mark]])}
    if _WINGS & arm:
        raise UnreadableMotion(path, "not a human figure: its arms are wings")
    size = rest.leg_length
    if not np.isfinite(size) or size < 1e-9:
        return
    down = unit(rest.middle("ankle") - rest.middle("hip"))[0]
    trunk = unit(rest.marks["neck"] - rest.middle("hip"))[0]
    arms = unit(rest.middle("wrist") - rest.middle("shoulder"))[0]
    is_level = abs(float(trunk @ down)) < _LEVEL
    ends = abs(float((rest.middle("wrist") - rest.middle("ankle"))[0] @ down)) < _REACH * size
    if is_level and ends and float(arms @ down) > _PARALLEL:
        raise UnreadableMotion(path, "not a human figure: at rest its trunk is level, on four legs")
    if is_level and any(_TAIL in name_words(name) for name in take.names):
        raise UnreadableMotion(path, "not a human figure: at rest its trunk is level, and it has a tail")
    more = _legs(take, rig.joints, rest, down, size)
    if more:
        raise UnreadableMotion(path, f"not a human figure: it has {2 + more} legs")


def _legs(take: Take, joints: Mapping[str, int], rest: Landmarks, down: Array, size: float) -> int:
    """How many limbs beside the two legs reach the height of the feet at rest, in mirrored pairs."""
    below = children(take.parents)
    body = {joint for mark in joints.values() for joint in ancestry(take.parents, mark)}
    feet = float((rest.middle("ankle")[0] - rest.middle("hip")[0]) @ down)
    props = vocabulary().ignored
    tips = []
    for leaf in (joint for joint, kids in enumerate(below) if not kids):
        limb = [joint for joint in ancestry(take.parents, leaf) if joint not in body]
        if len(limb) < _JOINTS or any(props & set(name_words(take.names[joint])) for joint in limb):
            continue
        length = np.linalg.norm(np.diff(take.rest[limb], axis=0), axis=-1).sum()
        reach = float((take.rest[leaf] - rest.middle("hip")[0]) @ down)
        if length > _LONG * size and abs(reach - feet) < _REACH * size:
            tips.append(take.rest[leaf] - rest.middle("hip")[0])
    across = unit(rest.across("hip"))[0]
    mirrored = [tip - 2 * (tip @ across) * across for tip in tips]
    return sum(
        any(i != k and np.linalg.norm(tip - other) < _APART * size for k, other in enumerate(mirrored))
        and abs(float(tip @ across)) > _APART * size / 2
        for i, tip in enumerate(tips)
    )
