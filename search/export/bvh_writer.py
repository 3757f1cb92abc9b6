"""Writing BVH: any skeleton with rotations; positions only where a joint moves on its parent."""

from __future__ import annotations

from typing import IO

import numpy as np
from numpy.typing import NDArray

from encoders.motion import Motion
from search.export.posed_rig import posed_rig
from search.export.rig_motion import RigMotion

Array = NDArray[np.float64]

CENTIMETRES = 100.0
_ROTATIONS = "Zrotation Xrotation Yrotation"
_ALL = f"Xposition Yposition Zposition {_ROTATIONS}"


def write(out: IO[bytes], motion: Motion) -> None:
    """Write a motion on the rig of the 22 joints, in centimetres."""
    write_rig(out, posed_rig(motion).scaled(CENTIMETRES))


def write_rig(out: IO[bytes], motion: RigMotion) -> None:
    """Write a skeleton in motion; a last joint that is called as its parent with `_end` becomes an end site.

    A moving joint's position channels hold its whole place on its parent, which the usual reading of BVH expects.
    """
    angles = np.degrees(np.unwrap(_angles(motion.turns), axis=0))
    lines: list[str] = ["HIERARCHY"]
    columns: list[Array] = []
    for root in np.flatnonzero(motion.parents < 0):
        _node(motion, angles, int(root), lines, columns)
    lines += ["MOTION", f"Frames: {len(motion)}", f"Frame Time: {1 / motion.fps:.8g}", ""]
    out.write("\n".join(lines).encode())
    np.savetxt(out, np.concatenate(columns, axis=1), fmt="%.6f")


def _node(motion: RigMotion, angles: Array, root: int, lines: list[str], columns: list[Array]) -> None:
    """Add the lines of a joint and of those below it, and the channels of each."""
    waiting: list[tuple[int, int]] = [(root, 0)]
    while waiting:
        joint, depth = waiting.pop()
        tab, inner = "\t" * depth, "\t" * (depth + 1)
        if joint < 0:  # all below the joint are written
            lines.append(f"{tab}}}")
            continue
        name, offset = motion.names[joint], " ".join(f"{x:.6f}" for x in motion.offsets[joint])
        if _is_site(motion, joint):
            lines += [f"{tab}End Site", f"{tab}{{", f"{inner}OFFSET {offset}", f"{tab}}}"]
            continue
        kind = "JOINT" if depth else "ROOT"
        lines += [f"{tab}{kind} {'_'.join(name.split())}", f"{tab}{{", f"{inner}OFFSET {offset}"]
        lines.append(f"{inner}CHANNELS {f'6 {_ALL}' if motion.moving[joint] else f'3 {_ROTATIONS}'}")
        if motion.moving[joint]:
            columns.append(motion.places[:, joint])
        columns.append(angles[:, joint])
        if not motion.children[joint]:
            lines += [f"{inner}End Site", f"{inner}{{", f"{inner}\tOFFSET 0 0 0", f"{inner}}}"]
        waiting.append((-1, depth))
        waiting += [(child, depth + 1) for child in reversed(motion.children[joint])]


def _is_site(motion: RigMotion, joint: int) -> bool:
    parent = motion.parents[joint]
    return bool(
        parent >= 0
        and not motion.children[joint]
        and not motion.moving[joint]
        and motion.names[joint] == f"{motion.names[parent]}_end"
    )


def _angles(turns: Array) -> Array:
    """Angles about Z, X and Y (..., 3) in radians of rotations Rz Rx Ry (..., 3, 3)."""
    first, second, third = (turns[..., row, :] for row in range(3))
    x = np.arcsin(np.clip(third[..., 1], -1, 1))
    locked = np.hypot(first[..., 1], second[..., 1]) < 1e-7  # Z and Y turn alike: all of it is told as Z
    z = np.where(locked, np.arctan2(second[..., 0], first[..., 0]), np.arctan2(-first[..., 1], second[..., 1]))
    y = np.where(locked, 0.0, np.arctan2(-third[..., 0], third[..., 2]))
    return np.stack([z, x, y], axis=-1)
