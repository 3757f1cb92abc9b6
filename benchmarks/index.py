"""Processor seconds that indexing a folder takes: by this checkout and, in turn with it, by another one."""

from __future__ import annotations

import argparse
import os
import resource
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

HERE = Path(__file__).resolve().parents[1]


def seconds(checkout: Path, folder: Path, jobs: int) -> float:
    """User time of the command and its reading processes; it writes a library that is thrown away."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime
    with tempfile.TemporaryDirectory() as library:
        subprocess.run(
            [sys.executable, "-m", "motionseek_main", "index", folder, "--library", library, "--jobs", str(jobs)],
            cwd=checkout,
            env={**os.environ, "PYTHONPATH": str(checkout)},
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
            check=False,  # files that cannot be read are no matter
        )
    return resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime - before


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", type=Path, help="of files that both checkouts read")
    parser.add_argument("--against", type=Path, help="another checkout, such as `git worktree add` makes")
    parser.add_argument("--repeats", type=int, default=2)
    parser.add_argument("--jobs", type=int, default=1)
    options = parser.parse_args()
    checkouts = [HERE] if options.against is None else [options.against.resolve(), HERE]
    times = np.empty((options.repeats, len(checkouts)))
    print(f"{'other':>12}{'this':>12}{'this : other':>14}" if options.against else f"{'this':>12}")
    for row in times:
        row[:] = [seconds(checkout, options.folder.resolve(), options.jobs) for checkout in checkouts]
        print_row(row)
    print_row(times.min(axis=0))


def print_row(row: NDArray[np.float64]) -> None:
    ratio = f"{row[-1] / row[0]:>14.2f}" if len(row) > 1 else ""
    print("".join(f"{time:>12.1f}" for time in row) + ratio, flush=True)


if __name__ == "__main__":
    main()
