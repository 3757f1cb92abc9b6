"""Arrays as takes: which of its axes are time, joints and coordinates, and in which order the joints stand.

An array says neither. Its shape proposes layouts, and where several are possible, the one is taken under which bones
keep their length and left and right are alike.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace
from os import PathLike
from typing import Any

import numpy as np
from numpy.typing import NDArray

from encoders.errors import UnreadableMotion
from encoders.geometry import length
from encoders.skeleton import JOINTS, PARENTS
from indexer.take import Take

Floats = NDArray[np.float64]

SHAPES = (
    "joints (T, J, 3) or (J, 3, T) in the order of SMPL (J = 22, 24, 45, 52, 55, 73, 127 or 144), KIT-ML (21) or "
    "SOMA (30, 77), several of them as (B, T, J, 3) or (B, J, 3, T), features (T, 263) or (T, 251), or Motion-X's "
    "(T, 322)"
)
#: The most takes in an array, as in a generator's results.
MAX_TAKES = 10_000


@dataclass(frozen=True, eq=False)
class Layout:
    """An order of joints, of which those of the body are kept.

    Attributes
    ----------
    title : str
        Whose order it is.
    names : tuple of str
        Joints that are kept, parents first.
    parents : int array (J,)
    columns : tuple of int
        Where they stand among the joints of an array.
    fps : float or None
        The frame rate at which such motions are published; None where there is no one rate.
    """

    title: str
    names: tuple[str, ...]
    parents: NDArray[np.int64]
    columns: tuple[int, ...]
    fps: float | None = None

    def fits(self, count: int) -> bool:
        """Whether an array of so many joints can hold it."""
        return max(self.columns) < count

    def take(self, joints: NDArray[Any], fps: float | None) -> Take:
        """A take of the joints (T, J, 3) of an array; its rest pose is unknown, hence zeros."""
        positions = joints[:, self.columns].astype(np.float64)
        return Take(self.names, self.parents, np.zeros((len(self.names), 3)), positions, fps or self.fps)


def _tree(text: str) -> tuple[tuple[str, ...], NDArray[np.int64]]:
    """Names and parents of joints given as chains, each begun by a joint of one before it."""
    parents: dict[str, str] = {}
    for chain in text.strip().split("\n"):
        joints = chain.split()
        parents.setdefault(joints[0], "")
        parents.update(zip(joints[1:], joints, strict=False))
    names = tuple(parents)
    return names, np.array([names.index(parent) if parent else -1 for parent in parents.values()])


#: SMPL, SMPL-H and SMPL-X begin with the 22 joints of the body; hands, face and landmarks of the surface follow.
SMPL = Layout("SMPL", JOINTS, PARENTS.astype(np.int64), tuple(range(len(JOINTS))))
#: The same, cut off after 21.
_NO_WRIST = Layout("SMPL", JOINTS[:-1], SMPL.parents[:-1], tuple(range(21)))
#: Numbers of joints that SMPL's models and their libraries give.
_SMPL_COUNTS = (22, 24, 45, 52, 55, 73, 127, 144)

#: KIT-ML's 21 joints, of the Master Motor Map (Terlemez et al., Humanoids 2014); published at 12.5 frames a second.
KIT = Layout(
    "KIT-ML",
    *_tree("""
pelvis spine1 spine2 neck head
neck left_shoulder left_elbow left_wrist
neck right_shoulder right_elbow right_wrist
pelvis left_hip left_knee left_ankle left_heel left_foot
pelvis right_hip right_knee right_ankle right_heel right_foot
"""),
    tuple(range(21)),
    12.5,
)
#: The body of SOMA, the skeleton of NVIDIA's motion models such as Kimodo; 30 joints, or 77 with all fingers.
_SOMA = _tree("""
Hips Spine1 Spine2 Chest Neck1 Neck2 Head
Chest LeftShoulder LeftArm LeftForeArm LeftHand
Chest RightShoulder RightArm RightForeArm RightHand
Hips LeftLeg LeftShin LeftFoot LeftToeBase
Hips RightLeg RightShin RightFoot RightToeBase
""")
LAYOUTS = {
    **dict.fromkeys(_SMPL_COUNTS, SMPL),
    21: KIT,
    30: Layout("SOMA", *_SOMA, (*range(7), *range(10, 14), *range(16, 20), *range(22, 30)), 30.0),
    77: Layout("SOMA", *_SOMA, (*range(7), *range(11, 15), *range(39, 43), *range(67, 71), *range(72, 76)), 30.0),
}
#: Features of HumanML3D and KIT-ML (12 J - 1 numbers): number of joints.
_FEATURES = {12 * count - 1: count for count in (22, 21)}

#: Frames that are looked at, and what is asked of limbs there: how much their lengths vary (standard deviation over
#: mean), and how unlike left and right are (longer over shorter).
_FRAMES, _STEADY, _ALIKE = 256, 0.1, 1.5
_LIMBS = ("knee", "ankle", "elbow", "wrist", "shin", "leftfoot", "rightfoot", "forearm", "hand")


def takes_of(path: str | PathLike[str], array: NDArray[Any], fps: float | None) -> list[Take]:
    """The takes of an array, several where it is a batch.

    Raises
    ------
    UnreadableMotion
        If it has a shape of none of the layouts, or one that means two things.
    """
    if array.ndim == 2 and array.shape[1] in _FEATURES and len(array):
        return [_of_features(array, fps)]
    batch = _batch(path, array)
    takes = [_of_joints(path, joints, fps, is_flat=array.ndim == 2) for joints in batch]
    return takes if len(takes) == 1 else [replace(take, name=str(n)) for n, take in enumerate(takes, start=1)]


def fits(shape: tuple[int, ...]) -> bool:
    """Whether an array of a shape can be a motion."""
    if len(shape) == 2:
        return shape[0] > 0 and shape[1] in _FEATURES
    return bool(0 not in shape and len(shape) in (3, 4) and _axes(shape))


def _axes(shape: tuple[int, ...]) -> str:
    """What the axes of three or four are: T, J and C in their order, after B where there are several; else nothing."""
    *before, a, b, c = shape
    batch = "B" if before else ""
    if b == c == 3:
        return ""  # rotations (J, 3, 3)
    if c == 3 and b > 3:
        return batch + "TJC"
    return batch + "JCT" if b == 3 and a in LAYOUTS else ""


def _batch(path: str | PathLike[str], array: NDArray[Any]) -> Iterable[NDArray[Any]]:
    """The motions (T, J, 3) in an array."""
    shape = array.shape
    if 0 in shape:
        raise UnreadableMotion(path, f"an array of shape {shape} is empty")
    if len(shape) == 2 and shape[1] % 3 == 0 and shape[1] // 3 in LAYOUTS:
        return [array.reshape(len(array), -1, 3)]
    axes = _axes(shape) if len(shape) in (3, 4) else ""
    if not axes:
        raise UnreadableMotion(path, f"an array of shape {shape} is no motion; it must be {SHAPES}{_hint(shape)}")
    if len(shape) == 4 and len(array) > MAX_TAKES:
        raise UnreadableMotion(path, f"{len(array)} takes in one file are more than {MAX_TAKES}; save them in several")
    batch = array if len(shape) == 4 else array[None]
    return batch.transpose(0, 3, 1, 2) if axes.endswith("JCT") else batch


def _hint(shape: tuple[int, ...]) -> str:
    """What an array that is no motion may be instead."""
    if len(shape) == 1 and shape[0] in _FEATURES:
        return ". This looks like means or deviations of features"
    if shape[-2:] == (3, 3) or (len(shape) == 2 and shape[1] in (63, 66, 69, 72, 75, 135, 156, 159, 165, 168)):
        return ". Rotations of SMPL are read from .npz, under the names poses and trans"
    return ""


def _of_features(array: NDArray[Any], fps: float | None) -> Take:
    from encoders.features.humanml3d import features_to_joints

    count = _FEATURES[array.shape[1]]
    joints = features_to_joints(array, joint_count=count)
    return replace(LAYOUTS[count].take(joints, fps), up="y", up_is_certain=True)


def _of_joints(path: str | PathLike[str], joints: NDArray[Any], fps: float | None, *, is_flat: bool) -> Take:
    """A take of joints (T, J, 3) in the first of the possible orders in which they look like a body.

    Where they do so in none, they are taken as what their number stands for, with a warning.
    """
    count = joints.shape[1]
    known = LAYOUTS.get(count)
    possible = dict.fromkeys([layout for layout in (known, SMPL, _NO_WRIST) if layout and layout.fits(count)])
    found = next((layout for layout in possible if _is_body(layout, joints)), None)
    if found is not None:
        take = found.take(joints, fps)
        return _with_wrist(take) if found is _NO_WRIST else take
    if known is None or is_flat:
        shape = (len(joints), 3 * count) if is_flat else joints.shape
        what = f"{3 * count} numbers a frame are no joints" if is_flat else f"{count} joints are of no known order"
        reason = f"{what}: in that of {(known or SMPL).title} their bones change length"
        raise UnreadableMotion(path, f"{reason}; an array must be {SHAPES}{_hint(shape)}")
    warning = f"its bones change length: are these {count} joints in another order than {known.title}'s?"
    return replace(known.take(joints, fps), warnings=(warning,))


def _is_body(layout: Layout, joints: NDArray[Any]) -> bool:
    """Whether limbs keep their length over time, left and right alike."""
    some = joints[:: max(len(joints) // _FRAMES, 1), layout.columns].astype(np.float64)
    bones = {
        name: length(some[:, at] - some[:, layout.parents[at]])
        for at, name in enumerate(layout.names)
        if any(part in name.lower() for part in _LIMBS)
    }
    steady = [lengths.std() <= _STEADY * lengths.mean() for lengths in bones.values()]
    pairs = [(bones[name], bones.get(_other_side(name), bones[name])) for name in bones]
    alike = [0 < left.mean() <= _ALIKE * right.mean() for left, right in pairs]
    return all(steady) and all(alike)


def _other_side(name: str) -> str:
    swapped = name.replace("left", "right").replace("Left", "Right")
    return name.replace("right", "left").replace("Right", "Left") if swapped == name else swapped


def _with_wrist(take: Take) -> Take:
    """The 22 joints of SMPL where the last is missing: the right forearm goes straight on."""
    shoulder, elbow = (take.positions[:, JOINTS.index(f"right_{joint}")] for joint in ("shoulder", "elbow"))
    positions = np.concatenate([take.positions, (2 * elbow - shoulder)[:, None]], axis=1)
    warning = "the right wrist is missing; the forearm is taken to go straight on"
    return replace(
        take, names=JOINTS, parents=SMPL.parents, rest=np.zeros((22, 3)), positions=positions, warnings=(warning,)
    )
