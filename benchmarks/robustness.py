"""Whether a library can be trusted: many trials of what `tests/robustness` tries a few times.

    python -m benchmarks.robustness kills [--trials 500] [--first SEED]

Each prints the trials that fail, with their seeds, and how many there were. A trial alone: `--first SEED --trials 1`.
"""

from __future__ import annotations

import argparse
import tempfile
import time
from collections.abc import Callable
from pathlib import Path


def kills(scratch: Path, seeds: range) -> int:
    """SIGKILL of index, rebuild, repair and a reader; the works take turns."""
    from tests.robustness.kills import WORKS, Trials

    trials, names = Trials(scratch), list(WORKS)
    return _count(seeds, lambda seed: trials.run(names[seed % len(names)], seed))


def _count(seeds: range, trial: Callable[[int], str]) -> int:
    """Run the trials and print those that fail; how many."""
    failed = 0
    for number, seed in enumerate(seeds, start=1):
        if error := trial(seed):
            failed += 1
            print(f"  {seed}: {error}", flush=True)
        if number % 50 == 0:
            print(f"  {number} of {len(seeds)} trials, {failed} failed", flush=True)
    return failed


COMMANDS: dict[str, tuple[Callable[[Path, range], int], int]] = {"kills": (kills, 500)}


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("command", choices=COMMANDS)
    parser.add_argument("--trials", type=int)
    parser.add_argument("--first", type=int, default=0)
    given = parser.parse_args()
    command, usual = COMMANDS[given.command]
    count = usual if given.trials is None else given.trials
    began = time.monotonic()
    with tempfile.TemporaryDirectory() as scratch:
        failed = command(Path(scratch), range(given.first, given.first + count))
    print(f"{given.command}: {count} trials, {failed} failed, {time.monotonic() - began:.0f} s")
    raise SystemExit(bool(failed))


if __name__ == "__main__":
    main()
