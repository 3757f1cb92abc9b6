"""Megabytes of BVH text a second on one core: a parser of lists of lines, ours, and the whole reading of a take."""

from __future__ import annotations

import argparse
import re
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np

from indexer.formats.bvh import bvh_reader
from indexer.formats.numbers import parse_lines

LEAST = 4_000_000  # characters that each file's motion is repeated to


def lists_of_lines(text: bytes) -> None:
    """What a plain reader does."""
    np.array([[float(word) for word in line.split()] for line in text.splitlines() if line.strip()])


def seconds(call: Callable[[], object], repeats: int) -> float:
    """The shortest time on the processor."""
    times = []
    for _ in range(repeats):
        start = time.process_time()
        call()
        times.append(time.process_time() - start)
    return min(times)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--every", type=int, default=40, help="only each so-many-th file")
    parser.add_argument("--repeats", type=int, default=3)
    options = parser.parse_args()
    totals = np.zeros(4)
    print(f"{'MB/s':<40}{'lists of lines':>16}{'ours':>8}{'whole take':>12}{'ours : lists':>14}")
    for path in sorted(options.folder.rglob("*.bvh"))[:: options.every]:
        data = path.read_bytes()
        header = re.match(rb".*?frame time:\s*\S+\s*?\n", data, re.IGNORECASE | re.DOTALL)
        if header is None:
            continue
        text = data[header.end() :].strip() + b"\n"
        text *= -(-LEAST // len(text))
        whole = header[0] + text
        calls = (lambda: lists_of_lines(text), lambda: parse_lines(text), lambda: bvh_reader.read(path, whole, fps=30))  # noqa: B023
        times = [seconds(call, options.repeats) for call in calls]
        totals += [len(text), *times]
        lists, ours, take = (len(text) / 1e6 / t for t in times)
        print(f"{path.name[:38]:<40}{lists:>16.1f}{ours:>8.1f}{take:>12.1f}{ours / lists:>14.2f}")
    lists, ours, take = (totals[0] / 1e6 / t for t in totals[1:])
    print(f"{'all':<40}{lists:>16.1f}{ours:>8.1f}{take:>12.1f}{ours / lists:>14.2f}")


if __name__ == "__main__":
    main()
