"""Parameters of the body models SMPL, SMPL-H and SMPL-X become joints: forward kinematics on a neutral template.

Every spelling in use is a row of `SPELLINGS`. Only the body is turned: the first 22 joints are those of all three
models, and hands and face hang from them. `betas`, the shape of the person, need a licensed body model, which
`indexer.formats.body_models` reads where the user has one.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from os import PathLike
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from encoders.errors import UnreadableMotion
from encoders.skeleton import JOINTS, PARENTS
from indexer.take import Take

Floats = NDArray[np.float64]

#: Joints of SMPL's mean neutral body in its rest pose, a T-pose that faces +Z with Y up: metres from each joint's
#: parent (the pelvis': from the model's origin), left and right averaged, as published in many open skeletons of SMPL.
_OFFSETS = np.array(
    [
        (0.0, -0.2233, 0.0282), (0.0686, -0.0910, -0.0056), (-0.0686, -0.0910, -0.0056), (0.0, 0.1090, -0.0267),
        (0.0363, -0.3789, -0.0067), (-0.0363, -0.3789, -0.0067), (0.0, 0.1352, 0.0011), (-0.0147, -0.3982, -0.0430),
        (0.0147, -0.3982, -0.0430), (0.0, 0.0529, 0.0254), (0.0259, -0.0520, 0.1213), (-0.0259, -0.0520, 0.1213),
        (0.0, 0.2139, -0.0429), (0.0805, 0.1201, -0.0363), (-0.0805, 0.1201, -0.0363), (0.0, 0.0650, 0.0513),
        (0.0935, 0.0315, -0.0090), (-0.0935, 0.0315, -0.0090), (0.2567, -0.0131, -0.0245), (-0.2567, -0.0131, -0.0245),
        (0.2523, 0.0084, -0.0034), (-0.2523, 0.0084, -0.0034),
    ]
)  # fmt: skip
#: Frames that are turned at once, so that memory stays small.
_CHUNK = 8192
#: How far a product of rows of a rotation matrix may be from 0 or 1.
_ORTHOGONAL = 0.02
#: The frame rate of parameters that state none: what most estimates from video have.
_USUAL_FPS = 30.0


class Spelling(NamedTuple):
    """How a kind of file names its parameters, and what it takes for granted.

    Attributes
    ----------
    poses : tuple of str
        Arrays that side by side are the rotations, the root's first.
    translation : str
    up : str
        The axis that is up in most such files.
    fps : float
        The frame rate of most such files that state none.
    scale : str
        The number by which the translation is divided; there may be none of that name.
    """

    poses: tuple[str, ...]
    translation: str
    up: str
    fps: float = _USUAL_FPS
    scale: str = ""


#: The first is taken whose arrays are all there; without its translation only if no other fits better.
SPELLINGS = (
    Spelling(("root_orient", "pose_body"), "trans", "z"),  # AMASS, stage II
    Spelling(("poses",), "trans", "z"),  # AMASS
    Spelling(("fullpose",), "transl", "z"),  # GRAB, ARCTIC
    Spelling(("smpl_poses",), "smpl_trans", "y", 60.0, "smpl_scaling"),  # AIST++
    Spelling(("global_orient", "body_pose"), "transl", "y"),  # the library smplx, and estimates from video
    Spelling(("global_orient", "body_pose"), "trans", "y"),
    Spelling(("poses",), "transl", "y"),
)

#: Motion-X (Lin et al., NeurIPS 2023) as one array (T, 322): where the parameters lie that are read.
MOTION_X_SIZE = 322
_MOTION_X = {"root_orient": slice(0, 3), "pose_body": slice(3, 66), "trans": slice(309, 312)}


def spelling_of(names: Mapping[str, Any] | set[str]) -> Spelling | None:
    """The spelling whose arrays are among some names; None where they hold no parameters."""
    known = [row for row in SPELLINGS if set(row.poses) <= set(names)]
    return next((row for row in known if row.translation in names), known[0] if known else None)


def take_of(
    path: str | PathLike[str],
    spelling: Spelling,
    load: Callable[[str], NDArray[Any] | None],
    fps: float | None,
    rest: Floats | None = None,
) -> Take:
    """The 22 joints of SMPL parameters.

    Parameters
    ----------
    load : callable
        An array of the file by name, None where it has none.
    rest : float array (22, 3), optional
        The joints of the person's own body at rest; the neutral one's by default.

    Raises
    ------
    UnreadableMotion
        If the arrays have other shapes than rotations and translations of as many frames.
    """
    rotations = [_axis_angles(path, name, load(name)) for name in spelling.poses]
    frames = len(rotations[0])
    stated = load(spelling.translation)
    translation = np.zeros((frames, 3)) if stated is None else stated.astype(np.float64).reshape(len(stated), -1)
    if {len(part) for part in (*rotations, translation)} != {frames} or translation.shape[1] != 3:
        shapes = ", ".join(str(part.shape) for part in (*rotations, translation))
        raise UnreadableMotion(path, f"{', '.join(spelling.poses)} and {spelling.translation} do not match: {shapes}")
    angles = np.concatenate(rotations, axis=1)
    if angles.shape[1] < len(JOINTS):
        raise UnreadableMotion(
            path, f"{' and '.join(spelling.poses)} turn {angles.shape[1]} joints; SMPL's body has {len(JOINTS)}"
        )
    scale = load(spelling.scale) if spelling.scale else None
    if scale is not None:
        translation = translation / _positive(path, spelling.scale, scale)
    warnings = []
    if stated is None:
        warnings.append(f"it has no translation ({spelling.translation}): the body stays where it is")
    if fps is None:
        warnings.append(f"it states no frame rate; {spelling.fps:g} is taken (--fps gives the true one)")
    rest = rest_joints() if rest is None else rest
    turned = rest[:, [0, 2, 1]] * (1, -1, 1) if spelling.up == "z" else rest
    positions = forward_kinematics(angles[:, : len(JOINTS)], translation, rest)
    parents = PARENTS.astype(np.int64)
    return Take(JOINTS, parents, turned, positions, fps or spelling.fps, up=spelling.up, warnings=tuple(warnings))


def take_of_motion_x(path: str | PathLike[str], array: NDArray[Any], fps: float | None) -> Take:
    """The 22 joints of parameters (T, 322) as Motion-X stores them.

    Raises
    ------
    UnreadableMotion
        If there is no frame.
    """
    spelling = Spelling(("root_orient", "pose_body"), "trans", "y")
    return take_of(path, spelling, lambda name: array[:, _MOTION_X[name]], fps)


def rest_joints() -> Floats:
    """The 22 joints (22, 3) of the neutral body at rest, metres."""
    joints: Floats = _OFFSETS.copy()
    for joint, parent in enumerate(PARENTS[1:], start=1):
        joints[joint] += joints[parent]
    return joints


def forward_kinematics(angles: Floats, translation: Floats, rest: Floats) -> Floats:
    """Joints (T, 22, 3) of axis-angle rotations (T, 22, 3), each in the frame of its parent, and a translation (T, 3).

    The body turns about its pelvis, which rests away from the origin, as in SMPL (Loper et al., SIGGRAPH Asia 2015).
    """
    joints = np.empty((len(angles), len(rest), 3))
    for start in range(0, len(angles), _CHUNK):
        part = slice(start, start + _CHUNK)
        local = rotation_matrices(angles[part])
        joints[part, 0] = translation[part] + rest[0]
        world = [local[:, 0]]
        for joint, parent in enumerate(PARENTS[1:], start=1):
            joints[part, joint] = joints[part, parent] + world[parent] @ (rest[joint] - rest[parent])
            world.append(world[parent] @ local[:, joint])
    return joints


def rotation_matrices(angles: Floats) -> Floats:
    """Rotations (..., 3, 3) of axis times angle (..., 3), radians: Rodrigues' formula."""
    angle = np.sqrt((angles**2).sum(-1))[..., None, None]
    x, y, z = np.moveaxis(angles, -1, 0)
    zero = np.zeros_like(x)
    cross = np.stack([zero, -z, y, z, zero, -x, -y, x, zero], axis=-1).reshape(*angles.shape, 3)
    # sin a / a and (1 - cos a) / a^2, whole at zero
    sine = np.sinc(angle / np.pi)
    cosine = np.sinc(angle / (2 * np.pi)) ** 2 / 2
    rotations: Floats = np.eye(3) + sine * cross + cosine * (cross @ cross)
    return rotations


def axis_angles(rotations: Floats) -> Floats:
    """Axis times angle (..., 3), radians, of rotations (..., 3, 3), by their quaternions.

    Of the four ways to a quaternion the one is taken whose divisor is largest (Shepperd, J. Guidance Control, 1978).
    """
    m = rotations
    trace = np.trace(m, axis1=-2, axis2=-1)
    diagonal = np.stack([trace, m[..., 0, 0], m[..., 1, 1], m[..., 2, 2]], axis=-1)
    squares = (1 + 2 * diagonal - trace[..., None]).clip(0)  # four times the squares of w, x, y and z
    squares[..., 0] = (1 + trace).clip(0)
    wx, wy, wz = (m[..., k, j] - m[..., j, k] for j, k in ((1, 2), (2, 0), (0, 1)))
    xy, xz, yz = (m[..., j, k] + m[..., k, j] for j, k in ((0, 1), (0, 2), (1, 2)))
    w, x, y, z = np.moveaxis(squares, -1, 0)
    ways = np.stack([[w, wx, wy, wz], [wx, x, xy, xz], [wy, xy, y, yz], [wz, xz, yz, z]])  # (4, 4, ...)
    best = squares.argmax(axis=-1)
    quaternion = np.take_along_axis(np.moveaxis(ways, (0, 1), (-2, -1)), best[..., None, None], axis=-2)[..., 0, :]
    quaternion *= np.where(quaternion[..., :1] < 0, -1, 1)  # the shorter way round
    axis = quaternion[..., 1:]
    sine = np.sqrt((axis**2).sum(-1, keepdims=True))
    angle = 2 * np.arctan2(sine, quaternion[..., :1])
    found: Floats = axis * angle / np.maximum(sine, 1e-300)
    return found


def _axis_angles(path: str | PathLike[str], name: str, array: NDArray[Any] | None) -> Floats:
    """Rotations as (T, J, 3), of the first 22 joints at most, stored so, flat, or as matrices (T, J, 3, 3)."""
    if array is None or array.ndim not in (2, 3, 4) or not array.size or (array.size // len(array)) % 3:
        shape = None if array is None else array.shape
        raise UnreadableMotion(path, f"{name} of shape {shape} is no rotation of joints (T, 3 J)")
    matrices = _matrices(array)
    if matrices is not None:
        return axis_angles(matrices)
    if array.ndim > 3 or (array.ndim == 3 and array.shape[2] != 3):
        raise UnreadableMotion(
            path, f"{name} of shape {array.shape} is no rotation of joints (T, J, 3), nor matrices (T, J, 3, 3)"
        )
    angles: Floats = array.reshape(len(array), -1, 3)[:, : len(JOINTS)].astype(np.float64)
    return angles


def _matrices(array: NDArray[Any]) -> Floats | None:
    """The first 22 of an array's rotation matrices (T, J, 3, 3), which may be flat; None where it holds others."""
    if (array.size // len(array)) % 9:
        return None
    found: Floats = array.reshape(len(array), -1, 3, 3)[:, : len(JOINTS)].astype(np.float64)
    square = found @ found.swapaxes(-1, -2)
    is_turn = np.abs(square - np.eye(3)).max() < _ORTHOGONAL and float(np.linalg.det(found).min()) > 0
    return found if is_turn else None


def _positive(path: str | PathLike[str], name: str, array: NDArray[Any]) -> float:
    if array.size != 1 or not float(array.reshape(())) > 0:
        raise UnreadableMotion(path, f"{name} must be a positive number")
    return float(array.reshape(()))
