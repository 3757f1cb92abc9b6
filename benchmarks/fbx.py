"""FBX files against ufbx, the reader in C: how far joints lie apart, and frames of a skeleton read a second.

    python -m benchmarks.fbx data/mocap/scene

Needs `pip install pufbx`, ufbx's binding, which builds with a C compiler. ufbx loads a file and bakes its animation at
the file's rate, to local transforms as arrays; we also place all joints in the world. CPU time, the best of some runs.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pufbx

from encoders.errors import UnreadableMotion
from indexer.formats.reading import read_takes
from tests.indexer.formats.ufbx_poses import apart, metres


def seconds(task: Callable[[], object], runs: int) -> float:
    """CPU time of the fastest of some runs."""
    best = np.inf
    for _ in range(runs):
        started = time.process_time()
        task()
        best = min(best, time.process_time() - started)
    return best


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
        rate, stacks = float(takes[0].fps or 30), range(len(takes))
        units, degrees = apart(path)
        deviation = units * metres(path), degrees
        spent = seconds(lambda path=path: read_takes(path), options.runs)  # type: ignore[misc]
        baked = seconds(
            lambda path=path, rate=rate, stacks=stacks: [  # type: ignore[misc]
                pufbx.anim_to_array(str(path), stack, resample_rate=rate, maximum_sample_rate=rate) for stack in stacks
            ],
            options.runs,
        )
        count = sum(len(take.positions) for take in takes)
        print(
            f"{path.name:40} {count:5} frames  {1000 * deviation[0]:.1e} mm  {deviation[1]:.1e} degrees  "
            f"{1000 * spent:6.1f} ms, ufbx {1000 * baked:6.1f} ms"
        )
        frames, ours, theirs = frames + count, ours + spent, theirs + baked
        worst = max(worst[0], deviation[0]), max(worst[1], deviation[1])
    print(f"at most {1000 * worst[0]:.1e} mm and {worst[1]:.1e} degrees apart")
    print(f"{frames / ours:.0f} frames a second, ufbx {frames / theirs:.0f}: {theirs / ours:.2f} times as fast")


if __name__ == "__main__":
    main()
