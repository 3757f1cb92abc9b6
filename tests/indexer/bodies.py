"""A body in motion as SMPL's parameters, its joints by a plain loop, and the same joints in other orders."""

from __future__ import annotations

import io

import numpy as np
from scipy.spatial.transform import Rotation

from encoders.skeleton import INDEX, PARENTS
from indexer.formats.numpy_files import smpl

#: KIT-ML's and SOMA's joints by those of SMPL, in their order; fingers and face lie in the wrist and the head.
KIT = (
    "pelvis spine1 spine3 neck head left_shoulder left_elbow left_wrist right_shoulder right_elbow right_wrist "
    "left_hip left_knee left_ankle left_foot left_foot right_hip right_knee right_ankle right_foot right_foot"
).split()
_ARM = "{0}_collar {0}_shoulder {0}_elbow {0}_wrist"
_LEG = "{0}_hip {0}_knee {0}_ankle {0}_foot"


def _soma(head: int, hand: int, toe: int) -> list[str]:
    order = ["pelvis", "spine1", "spine2", "spine3", "neck", "neck", *["head"] * (1 + head)]
    for side in ("left", "right"):
        order += [*_ARM.format(side).split(), *[f"{side}_wrist"] * hand]
    for side in ("left", "right"):
        order += [*_LEG.format(side).split(), *[f"{side}_foot"] * toe]
    return order


SOMA_30, SOMA_77 = _soma(3, 2, 0), _soma(4, 24, 1)


def parameters(frames: int = 40, seed: int = 0, up: str = "y") -> tuple[np.ndarray, np.ndarray]:
    """Axis-angle rotations (T, 66) of the body and its translation (T, 3): someone upright who turns and walks."""
    rng = np.random.default_rng(seed)
    times = np.arange(frames) / 20
    size, phase = rng.uniform(0.05, 0.4, (22, 3)), rng.uniform(0, 6, (22, 3))
    angles = size * np.sin(3 * times[:, None, None] + phase)
    heading = Rotation.from_rotvec(np.outer(times, [0, 0.5, 0]))
    stand = Rotation.from_euler("x", 90 if up == "z" else 0, degrees=True)
    angles[:, 0] = (stand * heading).as_rotvec()
    way = np.stack([0.3 * times, 1 + 0 * times, 0.8 * times], axis=-1)
    return angles.reshape(frames, 66), stand.apply(way)


def joints_of(angles: np.ndarray, translation: np.ndarray, rest: np.ndarray | None = None) -> np.ndarray:
    """Joints (T, 22, 3) of parameters, frame by frame and joint by joint, straight from the definition."""
    rest = smpl.rest_joints() if rest is None else rest
    joints = []
    for frame, shift in zip(angles.reshape(-1, 22, 3), translation, strict=True):
        turned, places = [], []
        for joint, parent in enumerate(PARENTS):
            local = Rotation.from_rotvec(frame[joint])
            turned.append(local if parent < 0 else turned[parent] * local)
            places.append(
                rest[0] + shift if parent < 0 else places[parent] + turned[parent].apply(rest[joint] - rest[parent])
            )
        joints.append(places)
    return np.array(joints)


def body(frames: int = 40, seed: int = 0) -> np.ndarray:
    """Joints (T, 22, 3) of someone who walks and turns, metres, Y up."""
    return joints_of(*parameters(frames, seed))


def in_order(joints: np.ndarray, order: list[str]) -> np.ndarray:
    """Joints (T, J, 3) in another order, from the 22."""
    return joints[:, [INDEX[name] for name in order]]


def saved(array: np.ndarray) -> bytes:
    """An array as a `.npy` file."""
    stream = io.BytesIO()
    np.save(stream, array)
    return stream.getvalue()


def archived(packed: bool = True, **arrays: object) -> bytes:
    """Arrays as a `.npz` file."""
    stream = io.BytesIO()
    (np.savez_compressed if packed else np.savez)(stream, **arrays)  # type: ignore[arg-type]
    return stream.getvalue()
