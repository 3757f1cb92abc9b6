"""Speed of both kinds of features: clips of five seconds a second on one core, one at a time and 64 at once."""

from __future__ import annotations

import os

os.environ["OMP_NUM_THREADS"] = "1"

import argparse
import time
from collections.abc import Callable

import numpy as np

from encoders.features.canonical import body_features
from encoders.features.humanml3d import joints_to_features
from encoders.skeleton import BONE_LENGTHS, PARENTS, RAW_OFFSETS

CLIPS, FRAMES = 64, 100


def random_motions() -> np.ndarray:
    """Reference poses whose joints drift: (CLIPS, FRAMES, 22, 3)."""
    pose = np.zeros((22, 3))
    for joint, parent in enumerate(PARENTS[1:], start=1):
        pose[joint] = pose[parent] + RAW_OFFSETS[joint] * BONE_LENGTHS[joint]
    drift = np.random.default_rng(0).normal(0, 0.01, (CLIPS, FRAMES, 22, 3)).cumsum(axis=1)
    return (pose + drift).astype(np.float32)


def clips_a_second(compute: Callable[[np.ndarray], np.ndarray], batches: list[np.ndarray], repeats: int = 5) -> float:
    """The best of several runs."""
    seconds = []
    for _ in range(repeats):
        start = time.perf_counter()
        for batch in batches:
            compute(batch)
        seconds.append(time.perf_counter() - start)
    return CLIPS / min(seconds)


def main() -> None:
    argparse.ArgumentParser(description=__doc__).parse_args()
    motions = random_motions()
    print(f"{'kind':<12}{'one at a time':>16}{f'{CLIPS} at once':>16}")
    for name, compute in (("body", body_features), ("humanml3d", joints_to_features)):
        alone, together = clips_a_second(compute, list(motions)), clips_a_second(compute, [motions])
        print(f"{name:<12}{alone:>16,.0f}{together:>16,.0f}")


if __name__ == "__main__":
    main()
