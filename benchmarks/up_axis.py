"""How often up is found, and how often a wrong axis is taken without a word: postures in files that say little.

    python -m benchmarks.up_axis [--seeds 6]

Each posture is performed once a seed and carried by arrays and rigs with Y or Z up, on a floor at height 0 or 1 m off,
or with the root pinned. Prints for each carrier how many readings are wrong, how many of these say nothing, and how
many that are right say that they are not certain.
"""

from __future__ import annotations

import argparse
from collections import Counter
from collections.abc import Callable

import numpy as np

from indexer.formats.numpy_files.array_layouts import takes_of
from indexer.rigs.retarget import retarget_with_reading
from indexer.take import Take
from tests.indexer.carriers import POSTURES, along_x, performed, rig, t_pose
from tests.indexer.performances import Z_UP

Array = np.ndarray
_ONE_UP = np.array([0.0, 1.0, 0.0])


def _take(joints: Array, rest: Array) -> Take:
    motion = rig(joints, rest)
    return Take(motion.names, motion.parents, motion.rest, motion.positions, motion.fps)


def _array(joints: Array) -> Take:
    return takes_of("array.npy", joints, 20.0)[0]


def _pinned(joints: Array) -> Array:
    return joints - joints[:, :1]


CARRIERS: dict[str, tuple[Callable[[Array], Take], str]] = {
    "standing rest pose": (lambda j: _take(j, t_pose()), "y"),
    "standing rest pose, floor 1 m off": (lambda j: _take(j + _ONE_UP, t_pose()), "y"),
    "standing rest pose, root pinned": (lambda j: _take(_pinned(j), t_pose()), "y"),
    "z up": (lambda j: _take(j @ Z_UP.T, t_pose() @ Z_UP.T), "z"),
    "z up, floor 1 m off": (lambda j: _take((j + _ONE_UP) @ Z_UP.T, t_pose() @ Z_UP.T), "z"),
    "z up, rest pose along y": (lambda j: _take(j @ Z_UP.T, t_pose()), "z"),
    "rest pose along x": (lambda j: _take(j, along_x()), "y"),
    "rest pose along x, z up": (lambda j: _take(j @ Z_UP.T, along_x()), "z"),
    "array": (_array, "y"),
    "array, floor 1 m off": (lambda j: _array(j + _ONE_UP), "y"),
    "array, root pinned": (lambda j: _array(_pinned(j)), "y"),
    "array, z up": (lambda j: _array(j @ Z_UP.T), "z"),
}


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--seeds", type=int, default=6)
    seeds = parser.parse_args().seeds
    print(f"{'carrier':36}{'read':>6}{'wrong':>7}{'silent':>8}{'unsure':>8}  wrong postures")
    for carrier, (carry, axis) in CARRIERS.items():
        count, wrong = Counter[str](), Counter[str]()
        for posture in POSTURES:
            for seed in range(seeds):
                _, reading = retarget_with_reading(carry(performed(posture, seed)), path=carrier)
                says = any("up is not certain" in warning for warning in reading.warnings)
                right = reading.up == axis
                count.update(read=1, silent=not right and not says, unsure=right and says)
                wrong[posture] += not right
        named = ", ".join(f"{posture} {number}" for posture, number in wrong.items() if number)
        print(f"{carrier:36}{count['read']:6}{wrong.total():7}{count['silent']:8}{count['unsure']:8}  {named}")


if __name__ == "__main__":
    main()
