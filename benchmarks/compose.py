"""Composing out of a large library: seconds of a time line of thirty seconds in three tracks.

    python -m benchmarks.compose FOLDER [--clips 10000] [--rounds 5]

FOLDER is indexed; the library composed from is simulated around its clips, with their poses. Beside it stand the
seconds that searching for each sentence takes, in the same rounds. `motionseek evaluate --protocol compose` tells how
good the motions are.
"""

from __future__ import annotations

import argparse
import tempfile
import time
from pathlib import Path

from benchmarks.simulated import simulate
from motionseek import Interval, Library, Timeline

_LINE = [
    Interval("a person walks forward", 0, 6, frozenset({"legs"})),
    Interval("turns around", 6, 10, frozenset({"legs"})),
    Interval("runs", 10, 16, frozenset({"legs"})),
    Interval("jumps", 16, 20, frozenset({"legs", "spine"})),
    Interval("sits down", 20, 30, frozenset({"legs", "spine"})),
    Interval("waves with the right hand", 1, 5, frozenset({"right arm"})),
    Interval("points ahead with the right hand", 7, 12, frozenset({"right arm"})),
    Interval("raises the left arm", 3, 8, frozenset({"left arm"})),
    Interval("drinks with the left hand", 21, 27, frozenset({"left arm", "head"})),
]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--clips", type=int, default=10_000)
    parser.add_argument("--rounds", type=int, default=5)
    arguments = parser.parse_args()
    line = Timeline.of(_LINE)
    with tempfile.TemporaryDirectory() as place:
        simulate(Path(place, "library"), arguments.folder, arguments.clips, 0.3, poses=True)
        with Library.open(Path(place, "library")) as library:
            library.compose(line)  # the model and the indexes are loaded once
            composing, searching = [], []
            for _ in range(arguments.rounds):
                began = time.perf_counter()
                library.compose(line)
                half = time.perf_counter()
                for one in line.intervals:
                    library.search(one.text, k=1)
                composing.append(half - began)
                searching.append(time.perf_counter() - half)
    print(
        f"{arguments.clips} clips, {len(_LINE)} sentences, {line.duration:g} s: composed in {min(composing):.2f} s; "
        f"searching for each sentence {min(searching):.2f} s (shortest of {arguments.rounds})"
    )


if __name__ == "__main__":
    main()
