"""FBX files against ufbx, the reader in C: how far joints lie apart, and frames of a skeleton read a second.

    python -m benchmarks.fbx data/mocap/scene

Needs `pip install pufbx`, ufbx's binding, which builds with a C compiler. Timed is what a reader of motion needs of
either: from the path of a file to the world positions, as an array, of its joints at each frame of the file's rate.
ufbx loads the file and bakes its animation at that rate; as its binding has neither the evaluation of a scene nor world
transforms at a time, its local transforms are chained with NumPy, for all nodes. CPU time, the best of some runs, which
alternate.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np
import pufbx
from numpy.typing import NDArray

from encoders.errors import UnreadableMotion
from indexer.formats.fbx.skeleton_animation import animations
from indexer.formats.reading import read_takes
from tests.indexer.formats.ufbx_poses import apart, metres, posed

Floats = NDArray[np.float64]


def seconds(tasks: Sequence[Callable[[], object]], runs: int) -> list[float]:
    """CPU time of the fastest of some runs of each task."""
    best = [np.inf] * len(tasks)
    for _ in range(runs):
        for i, task in enumerate(tasks):
            started = time.process_time()
            task()
            best[i] = min(best[i], time.process_time() - started)
    return best


def ufbx_positions(path: Path, times: Sequence[Floats], rate: float) -> list[Floats]:
    """World positions (N, 3, T) of all nodes at the times (T,) in seconds of each animation."""
    scene = pufbx.load_fbx(str(path))
    return [posed(scene, stack, when, rate=rate).positions for stack, when in enumerate(times)]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder", type=Path)
    parser.add_argument("--runs", type=int, default=5)
    options = parser.parse_args()

    frames, ours, theirs, worst = 0, 0.0, 0.0, (0.0, 0.0)
    for path in sorted(options.folder.rglob("*.fbx")):
        try:
            takes = read_takes(path)
        except UnreadableMotion as error:
            print(f"{path.name:40} {error.reason}")
            continue
        found = list(animations(path.read_bytes()))
        times, rate = [animation.times() / animation.scene.ticks for animation in found], found[0].fps
        units, degrees = apart(path)
        deviation = units * metres(path), degrees
        spent, theirs_spent = seconds(
            [
                lambda path=path: read_takes(path),  # type: ignore[misc]
                lambda path=path, times=times, rate=rate: ufbx_positions(path, times, rate),  # type: ignore[misc]
            ],
            options.runs,
        )
        count = sum(len(take.positions) for take in takes)
        print(
            f"{path.name:40} {count:5} frames  {1000 * deviation[0]:.1e} mm  {deviation[1]:.1e} degrees  "
            f"{1000 * spent:6.1f} ms, ufbx {1000 * theirs_spent:6.1f} ms"
        )
        frames, ours, theirs = frames + count, ours + spent, theirs + theirs_spent
        worst = max(worst[0], deviation[0]), max(worst[1], deviation[1])
    print(f"at most {1000 * worst[0]:.1e} mm and {worst[1]:.1e} degrees apart")
    print(f"{frames / ours:.0f} frames a second, ufbx {frames / theirs:.0f}: {theirs / ours:.2f} times as fast")


if __name__ == "__main__":
    main()
