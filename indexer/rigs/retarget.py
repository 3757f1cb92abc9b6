"""Any rig -> Motion: find the body in the take, stand it up, scale it, rebuild it on the 22 joints at 20 fps."""

from __future__ import annotations

from itertools import pairwise
from os import PathLike

import numpy as np
from numpy.typing import NDArray

from encoders.errors import UnreadableMotion
from encoders.geometry import angle_between, interpolate
from encoders.motion import FPS, Motion
from encoders.skeleton import BONE_LENGTHS, INDEX, JOINTS
from indexer.read_motion import Reading
from indexer.rigs.human import check_human
from indexer.rigs.landmarks import Landmarks
from indexer.rigs.mapping import SIDES, RigMap, map_rig
from indexer.rigs.orientation import orientation
from indexer.rigs.own_rig import as_own_rig, own_body
from indexer.rigs.rate_plausibility import rate_warnings
from indexer.rigs.rebuild import ARM, LEG, build, rebuild
from indexer.rigs.rest_pose import rest_pose_correction
from indexer.rigs.up_axis import up_axis
from indexer.take import Take

#: Upper leg and shank of the target skeleton, metres.
LEG_LENGTH = float(
    sum(BONE_LENGTHS[INDEX[f"{side}_{joint}"]] for side in ("left", "right") for joint in ("knee", "ankle")) / 2
)

#: Longer takes are wrong about their frame rate, or should be cut.
MAX_HOURS = 12

#: Share of a leg's length below which two joints are one.
_POINT = 1e-3
#: Mean way of a landmark from the hips, in leg lengths, below which a pose is the same.
_STILL = 0.03
#: Mean speed of all landmarks, in leg lengths a second, that is no movement: out of rest, and at all.
_RUSH = 1.5, 5.0


def retarget(
    take: Take,
    *,
    path: str | PathLike[str],
    joint_map: dict[str, str] | None = None,
    fps: float | None = None,
) -> Motion:
    """The motion that `retarget_with_reading` gives."""
    return retarget_with_reading(take, path=path, joint_map=joint_map, fps=fps)[0]


@np.errstate(over="ignore", invalid="ignore")  # what becomes of absurd values is checked
def retarget_with_reading(
    take: Take,
    *,
    path: str | PathLike[str],
    joint_map: dict[str, str] | None = None,
    fps: float | None = None,
) -> tuple[Motion, Reading]:
    """Bring a take to the 22 joints: metres, Y up, 20 fps, target bone lengths, lowest joint at height 0.

    Heading and place are kept.

    Parameters
    ----------
    take : Take
        As read.
    path : path
        Named in errors.
    joint_map : dict, optional
        Target joint to joint name in the file, over what is found by itself.
    fps : float, optional
        The take's true frame rate, instead of what it says.

    Raises
    ------
    UnknownRig
        Where hips, knees, ankles, shoulders, elbows, wrists or the head cannot be found.
    UnreadableMotion
        Where it is no person, or has no body's shape.
    """
    take = take if joint_map else as_own_rig(take)
    rig = map_rig(take, path, joint_map)
    if not joint_map:
        check_human(take, rig, path)
    rate = fps or take.fps or FPS
    _check_duration(path, len(take.positions) / rate)
    landmarks, rest = Landmarks.of(take.positions, rig), Landmarks.of(take.rest[None], rig)
    posing = frames_before_movement(take, rig, rate)
    if posing:
        landmarks, rest = landmarks[posing:], landmarks[:1]
    at = _grid(len(landmarks), rate)
    landmarks = landmarks.sampled(at)
    _check_bones(path, landmarks)
    up = up_axis(landmarks, rest, take.up, is_certain=take.up_is_certain)
    matrix = orientation(up.axis, landmarks, rest)
    scale = LEG_LENGTH / landmarks.leg_length
    body = None if joint_map else own_body(take, rig)
    if body is not None:
        joints = rebuild(interpolate(take.positions[posing:, body], at) @ matrix.T, scale)
    else:
        landmarks, rest = landmarks.transformed(matrix), rest.transformed(matrix)
        joints = build(landmarks, scale, rest_pose_correction(landmarks, rest))
    joints[..., 1] -= joints[..., 1].min()
    stored = joints.astype(np.float32)
    if not np.isfinite(stored).all():
        raise UnreadableMotion(path, "its values are too large to be places of joints")
    motion = Motion(stored, FPS)
    reading = Reading(
        take=take.name,
        up=up.axis,
        up_reason=up.reason,
        start=posing / rate,
        source_fps=rate,
        source_frames=len(take.positions),
        warnings=(*take.warnings, *up.warnings(), *rate_warnings(motion, rate)),
    )
    return motion, reading


def _check_duration(path: str | PathLike[str], seconds: float) -> None:
    if not 0 < seconds <= MAX_HOURS * 3600:
        raise UnreadableMotion(path, f"it would last {seconds / 3600:.3g} hours; give the true frame rate with fps")


def _check_bones(path: str | PathLike[str], landmarks: Landmarks) -> None:
    """Every limb must have a length, and hips and shoulders a width, for directions to mean anything."""
    size = landmarks.leg_length
    pairs = [(f"{side}_{a}", f"{side}_{b}") for side in SIDES for limb in (LEG, ARM) for a, b in pairwise(limb)]
    pairs += [("left_hip", "right_hip"), ("left_shoulder", "right_shoulder")]
    flat = [pair for pair in pairs if not np.median(np.linalg.norm(landmarks.bone(*pair), axis=-1)) > _POINT * size]
    if not np.isfinite(size) or flat:
        a, b = flat[0] if flat else pairs[0]
        raise UnreadableMotion(path, f"{a} and {b} are at the same place: this skeleton has no body's shape")


def _grid(frames: int, rate: float) -> NDArray[np.float64]:
    """Times of the 20 fps grid, counted in frames of the file."""
    count = int(np.floor((frames - 1) * FPS / rate + 1e-6)) + 1
    at: NDArray[np.float64] = np.arange(count, dtype=np.float64) * (rate / FPS)
    return at


def frames_before_movement(take: Take, rig: RigMap, rate: float) -> int:
    """How many first frames are no movement: a rest pose or T-pose, and the rush from there to the first real pose.

    No person moves all limbs so fast at once; programs do that put a bind pose before the recording and
    smooth over the seam. A cut that was exported has none.
    """
    if take.names == JOINTS and take.up_is_certain:
        return 0
    landmarks, rest = Landmarks.of(take.positions[: round(rate) + 2], rig), Landmarks.of(take.rest[None], rig)
    size = max(landmarks.leg_length, 1e-9)
    both = [name for name in landmarks.marks if name in rest.marks]  # toes may be known in one alone
    shapes = (landmarks.points(both) - landmarks.middle("hip")[:, None]) / size
    at_rest = (rest.points(both) - rest.middle("hip")[:, None]) / size
    posed = np.linalg.norm(shapes - shapes[:1], axis=-1).mean(axis=-1) < _STILL
    count = len(posed) if posed.all() else int(posed.argmin())
    speed = np.linalg.norm(np.diff(shapes, axis=0), axis=-1).mean(axis=-1) * rate
    rush = np.clip(4 * np.median(speed[count - 1 :]) if count < len(shapes) else 0.0, *_RUSH)
    slow = np.flatnonzero(speed[count - 1 :] < rush)
    if not len(slow) or slow[0] == 0:
        return 0
    is_rest = np.linalg.norm(shapes[0] - at_rest[0], axis=-1).mean() < _STILL
    return count - 1 + int(slow[0]) if is_rest or is_t_pose(landmarks[:1]) else 0


def is_t_pose(landmarks: Landmarks) -> bool:
    """A body (T = 1) that stands straight, arms stretched out sideways."""
    trunk = landmarks.marks["neck"] - landmarks.middle("hip")
    bones = [(landmarks.bone(f"{s}_hip", f"{s}_ankle"), -trunk) for s in SIDES]
    bones += [
        (landmarks.bone(f"{s}_{a}", f"{s}_{b}"), sign * landmarks.across("hip"))
        for s, sign in zip(SIDES, (1, -1), strict=True)
        for a, b in (("shoulder", "elbow"), ("elbow", "wrist"))
    ]
    return all(float(angle_between(bone, expected)[0]) < 25 for bone, expected in bones)
