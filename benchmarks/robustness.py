"""Whether a library can be trusted: many trials of what `tests/robustness` tries a few times.

    python -m benchmarks.robustness kills [--trials 500] [--first SEED]      SIGKILL at random instants
    python -m benchmarks.robustness mutations [--trials 5000]                files changed at random, of every kind
    python -m benchmarks.robustness flips [--trials 300]                     bits flipped in every file of a library
    python -m benchmarks.robustness faults [--every 1]                       each write, sync and rename fails once
    python -m benchmarks.robustness readers [--minutes 10]                   eight processes on one library

Each prints the trials that fail, with their seeds, and how many there were. A trial alone: `--first SEED --trials 1`;
of `faults`, trials are counted from 0.
Linux only; `faults` needs a C compiler.
"""

from __future__ import annotations

import argparse
import sys
import tempfile
import time
from collections.abc import Iterable
from pathlib import Path


def kills(scratch: Path, given: argparse.Namespace) -> tuple[int, int]:
    """SIGKILL of index, rebuild, repair and a reader; the works take turns."""
    from tests.robustness.kills import WORKS, Trials

    trials, names = Trials(scratch), list(WORKS)
    return _count((seed, trials.run(names[seed % len(names)], seed)) for seed in _seeds(given, 500))


def mutations(scratch: Path, given: argparse.Namespace) -> tuple[int, int]:
    from tests.robustness.mutations import run

    seeds = _seeds(given, 5000)
    found = zip(seeds, run(seeds), strict=True)
    return _count((seed, f"{kind}: {wrong}" if wrong else "") for seed, (kind, wrong) in found)


def flips(scratch: Path, given: argparse.Namespace) -> tuple[int, int]:
    from tests.robustness.flips import Flips

    trials = Flips(scratch)
    return _count((seed, trials.run(seed)) for seed in _seeds(given, 300))


def faults(scratch: Path, given: argparse.Namespace) -> tuple[int, int]:
    from tests.robustness.faults import run

    found = run(scratch, given.every, _seeds(given, sys.maxsize))
    return _count(("{task}, step {step}, {error}, {where}".format(**line), line["wrong"]) for line in found)


def readers(scratch: Path, given: argparse.Namespace) -> tuple[int, int]:
    from tests.robustness.readers import run

    found = run(scratch, given.minutes * 60)
    for name, (steps, _) in found.items():
        print(f"  {name}: {steps} times")
    return _count((name, error) for name, (_, error) in found.items())


def _seeds(given: argparse.Namespace, usual: int) -> range:
    return range(given.first, given.first + (usual if given.trials is None else given.trials))


def _count(trials: Iterable[tuple[object, str]]) -> tuple[int, int]:
    """Print the trials that fail; how many there were, and how many failed."""
    number = failed = 0
    for number, (name, wrong) in enumerate(trials, start=1):
        if wrong:
            failed += 1
            print(f"  {name}: {wrong}", flush=True)
        if number % 100 == 0:
            print(f"  {number} trials, {failed} failed", flush=True)
    return number, failed


COMMANDS = {"kills": kills, "mutations": mutations, "flips": flips, "faults": faults, "readers": readers}


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("command", choices=COMMANDS)
    parser.add_argument("--trials", type=int)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--every", type=int, default=1)
    parser.add_argument("--minutes", type=float, default=10)
    given = parser.parse_args()
    began = time.monotonic()
    with tempfile.TemporaryDirectory() as scratch:
        number, failed = COMMANDS[given.command](Path(scratch), given)
    print(f"{given.command}: {number} trials, {failed} failed, {time.monotonic() - began:.0f} s")
    raise SystemExit(bool(failed))


if __name__ == "__main__":
    main()
