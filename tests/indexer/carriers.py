"""A performance of the 22 joints in any posture, and the files that may carry it: BVH of any rest pose, arrays."""

from __future__ import annotations

import io

import numpy as np

from encoders.corpus.composition.scene_clips import make_clip
from encoders.corpus.engine.posing import OFFSETS
from encoders.corpus.scene import ActionStep, Scene
from encoders.geometry import length, rotation_between
from encoders.skeleton import JOINTS, PARENTS
from search.export import bvh_writer
from search.export.rig_motion import RigMotion

#: Posture -> action and direction of its program.
POSTURES = {
    "stand": ("stand", ""),
    "walk": ("walk", "forward"),
    "crawl": ("crawl", "forward"),
    "crawl backwards": ("crawl", "backward"),
    "lie on the back": ("lie", "backward"),
    "lie on the belly": ("lie", "forward"),
    "lie on the left side": ("lie", "left"),
    "lie on the right side": ("lie", "right"),
    "push-up": ("push-up", ""),
    "handstand": ("handstand", ""),
    "cartwheel": ("cartwheel", "left"),
    "climb": ("climb ladder", "up"),
    "sit on the floor": ("sit-up", ""),
}
_OTHER_NAMES = {
    "pelvis": "Hips", "spine1": "Spine", "spine2": "Spine1", "spine3": "Chest", "neck": "Neck", "head": "Head",
    "hip": "UpLeg", "knee": "Leg", "ankle": "Foot", "foot": "ToeBase", "collar": "Shoulder", "shoulder": "Arm",
    "elbow": "ForeArm", "wrist": "Hand",
}  # fmt: skip
_CHILDREN = [np.flatnonzero(joint == PARENTS) for joint in range(len(JOINTS))]


def performed(posture: str, seed: int = 0) -> np.ndarray:
    """Joints (T, 22, 3) in metres, Y up, the floor at height 0, heading somewhere, away from the origin."""
    rng = np.random.default_rng([seed, *posture.encode()])
    action, direction = POSTURES[posture]
    joints = make_clip(Scene(((ActionStep(action, direction=direction),),)), rng, variation=0).joints[:80]
    angle = rng.uniform(0, 2 * np.pi)
    cos, sin = np.cos(angle), np.sin(angle)
    turned = joints.astype(np.float64) @ np.array([[cos, 0, sin], [0, 1, 0], [-sin, 0, cos]]).T
    return turned + rng.normal(0, 0.5, 3) * np.array([1, 0, 1])


def t_pose() -> np.ndarray:
    """Joints (22, 3) of the performer, who stands with the arms out."""
    return _chained({
        joint: [length(OFFSETS[joint]) * (1 if name.startswith("left") else -1), 0, 0]
        for joint, name in enumerate(JOINTS)
        if name.endswith(("elbow", "wrist"))
    })  # fmt: skip


def along_x() -> np.ndarray:
    """The performer's rest pose as solvers write it: bones along +X, the trunk upright along it."""
    up_to_x = np.array([[0.0, 1, 0], [-1, 0, 0], [0, 0, 1]])
    bones: dict[int, list[float]] = {}
    for children in _CHILDREN:
        for joint in children:
            one = len(children) == 1
            bones[joint] = [length(OFFSETS[joint]), 0, 0] if one else (up_to_x @ OFFSETS[joint]).tolist()
    return _chained(bones)


def rig(joints: np.ndarray, rest: np.ndarray, fps: float = 20.0) -> RigMotion:
    """A skeleton with the names of another program, turned from a rest pose (22, 3) to where joints (T, 22, 3) are."""
    turns = np.empty((*joints.shape, 3))
    for joint, children in enumerate(_CHILDREN):
        above = turns[:, PARENTS[joint]] if joint else np.broadcast_to(np.eye(3), turns[:, 0].shape)
        bones, posed = rest[children] - rest[joint], joints[:, children] - joints[:, [joint]]
        if len(children) > 1:
            u, _, vt = np.linalg.svd(np.einsum("tca,cb->tab", posed, bones))
            u[..., 2] *= np.linalg.det(u @ vt)[:, None]
            turns[:, joint] = u @ vt
        elif len(children):
            turns[:, joint] = rotation_between((above @ bones[0]), posed[:, 0]) @ above
        else:
            turns[:, joint] = above
    names = tuple(_other_name(name) for name in JOINTS)
    return RigMotion(names, PARENTS.astype(np.int64), rest, joints, turns, fps)


def bvh_text(joints: np.ndarray, rest: np.ndarray, fps: float = 20.0) -> bytes:
    """A BVH file, in centimetres, of joints (T, 22, 3) on a skeleton with a rest pose (22, 3)."""
    out = io.BytesIO()
    bvh_writer.write_rig(out, rig(joints, rest, fps).scaled(100))
    return out.getvalue()


def apart(joints: np.ndarray, others: np.ndarray) -> float:
    """The farthest that a joint (T, 22, 3) is from the other's, in metres: about the pelvis, headings laid together."""
    one, other = joints - joints[:, :1], others - others[:, :1]
    cos = (one[..., 0] * other[..., 0] + one[..., 2] * other[..., 2]).sum()
    sin = (one[..., 2] * other[..., 0] - one[..., 0] * other[..., 2]).sum()
    angle = np.arctan2(sin, cos)
    cos, sin = np.cos(angle), np.sin(angle)
    turned = one @ np.array([[cos, 0, sin], [0, 1, 0], [-sin, 0, cos]]).T
    return float(length(turned - other).max())


def _chained(bones: dict[int, list[float]]) -> np.ndarray:
    """Joints (22, 3) with some bones given, and the others as the performer has them."""
    places = np.zeros((len(JOINTS), 3))
    for joint, parent in enumerate(PARENTS[1:], start=1):
        places[joint] = places[parent] + bones.get(joint, OFFSETS[joint])
    return places


def _other_name(name: str) -> str:
    side, _, joint = name.rpartition("_")
    return side.capitalize() + _OTHER_NAMES[joint]
