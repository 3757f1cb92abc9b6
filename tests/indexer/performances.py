"""A small movement on a rig, written as BVH in any dialect."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from scipy.spatial.transform import Rotation

from tests.indexer.example_rigs import RIGS, standing, tree

Z_UP = np.array([[1.0, 0, 0], [0, 0, -1], [0, 1, 0]])
MIRRORED = np.diag([-1.0, 1, 1])


@dataclass(frozen=True)
class Performance:
    """Local rotations (T, J, 3, 3) and the root's way (T, 3) on a skeleton with offsets (J, 3), in metres, Y up."""

    names: list[str]
    parents: list[int]
    offsets: np.ndarray
    rotations: np.ndarray
    root: np.ndarray
    fps: float = 20.0

    def transformed(self, matrix: np.ndarray) -> Performance:
        """The same in other axes: each point times an orthogonal matrix."""
        return replace(
            self,
            offsets=self.offsets @ matrix.T,
            rotations=matrix @ self.rotations @ matrix.T,
            root=self.root @ matrix.T,
        )

    def after_rest_pose(self) -> Performance:
        """With the rest pose put before it, as some programs do."""
        rest = np.broadcast_to(np.eye(3), self.rotations[:1].shape)
        return replace(
            self, rotations=np.concatenate([rest, self.rotations]), root=np.concatenate([self.root[:1], self.root])
        )

    def every(self, step: int) -> Performance:
        """Every `step`-th frame."""
        return replace(self, rotations=self.rotations[::step], root=self.root[::step], fps=self.fps / step)


def performance(rig: str = "bandai", frames: int = 30, fps: float = 20.0, seed: int = 0) -> Performance:
    """Someone who walks forward, turns and swings all limbs a little."""
    names, parents, marks = tree(RIGS[rig])
    places = standing(RIGS[rig])
    offsets = places - places[parents]
    offsets[0] = 0
    rng = np.random.default_rng(seed)
    times = np.arange(frames) / fps
    phase = rng.uniform(0, 2 * np.pi, (len(names), 3))
    size = rng.uniform(5, 25, (len(names), 3))
    angles = size * np.sin(2 * np.pi * 0.7 * times[:, None, None] + phase)
    angles[:, 0] = np.stack([0 * times, 40 * times, 0 * times], axis=-1)
    for side, sign in (("left", -1), ("right", 1)):
        angles[:, marks[f"{side}_shoulder"], 2] += 50 * sign
        angles[:, marks[f"{side}_knee"]] = np.stack([20 + 15 * np.sin(3 * times), 0 * times, 0 * times], axis=-1)
    rotations = Rotation.from_euler("xyz", angles.reshape(-1, 3), degrees=True).as_matrix()
    root = np.stack([0.2 * times, 0.95 + 0.02 * np.sin(5 * times), 0.8 * times], axis=-1)
    return Performance(names, parents, offsets, rotations.reshape(frames, len(names), 3, 3), root, fps)


def bvh(
    acted: Performance,
    *,
    order: str = "ZXY",
    root_order: str | None = None,
    unit: float = 1.0,
    separator: str = " ",
    newline: str = "\n",
    positions_last: bool = False,
) -> str:
    """A performance as BVH text; `unit` is what a metre is in the file."""
    lines = ["HIERARCHY"]
    root_order = root_order or order

    def write(joint: int, depth: int) -> None:
        parent = acted.parents[joint]
        rotations = " ".join(f"{axis}rotation" for axis in (root_order if parent < 0 else order))
        moves = "Xposition Yposition Zposition"
        channels = f"3 {rotations}"
        if parent < 0:
            channels = f"6 {rotations} {moves}" if positions_last else f"6 {moves} {rotations}"
        offset = separator.join(f"{v:.6f}" for v in acted.offsets[joint] * unit)
        tab = "\t" * depth
        lines.extend([f"{tab}{'JOINT' if depth else 'ROOT'} {acted.names[joint]}", f"{tab}{{"])
        lines.extend([f"{tab}\tOFFSET{separator}{offset}", f"{tab}\tCHANNELS {channels}"])
        kids = [kid for kid, above in enumerate(acted.parents) if above == joint]
        for kid in kids:
            write(kid, depth + 1)
        if not kids:
            end = separator.join(f"{v:.6f}" for v in acted.offsets[joint] * unit * 0.3)
            lines.extend([f"{tab}\tEnd Site", f"{tab}\t{{", f"{tab}\t\tOFFSET{separator}{end}", f"{tab}\t}}"])
        lines.append(f"{tab}}}")

    write(0, 0)
    lines += ["MOTION", f"Frames: {len(acted.root)}", f"Frame Time: {1 / acted.fps:.8f}"]
    columns = []
    for joint in _written_order(acted.parents):
        axes = root_order if acted.parents[joint] < 0 else order
        angles = Rotation.from_matrix(acted.rotations[:, joint]).as_euler(axes, degrees=True)
        moves = [acted.root * unit] if acted.parents[joint] < 0 else []
        columns += [angles, *moves] if positions_last else [*moves, angles]
    lines += [separator.join(f"{v:.6f}" for v in row) for row in np.concatenate(columns, axis=1)]
    return newline.join(lines) + newline


def _written_order(parents: list[int]) -> list[int]:
    """Joints in the order a BVH lists them: depth first."""

    def below(joint: int) -> list[int]:
        return [joint, *(j for kid, above in enumerate(parents) if above == joint for j in below(kid))]

    return below(0)


def together(*texts: str) -> str:
    """The figures of several BVH texts of equal length in one, each under a root of its own."""
    parts = [text.split("MOTION\n") for text in texts]
    rows = [motion.splitlines() for _, motion in parts]
    trees = "".join(tree.removeprefix("HIERARCHY\n") for tree, _ in parts)
    values = [" ".join(columns) for columns in zip(*(lines[2:] for lines in rows), strict=True)]
    return "\n".join(["HIERARCHY", trees + "MOTION", *rows[0][:2], *values]) + "\n"
