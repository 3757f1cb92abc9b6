"""Flipped bits in a file of a library: harmless, or named and mended."""

from __future__ import annotations

import random
import shutil
from pathlib import Path

from indexer.maintenance.check import check
from indexer.maintenance.repair import repair
from indexer.store.library_reader import FILE, FOLDER
from tests.indexer.folders import SmallBundle
from tests.robustness.content import content, differences, make


class Flips:
    """Trials in a scratch folder; each flips bits in one file of a copy of the same library."""

    def __init__(self, scratch: Path) -> None:
        self.made, self.folder = make(scratch / "made"), scratch / "flipped"
        self.expected = content(self.made, SmallBundle())

    def run(self, seed: int) -> str:
        """One trial; what is wrong, empty where nothing is. Every other trial is in the database."""
        rng = random.Random(seed)
        shutil.rmtree(self.folder, ignore_errors=True)
        shutil.copytree(self.made, self.folder)
        files = sorted(path for path in (self.folder / FOLDER).rglob("*") if path.is_file() and path.stat().st_size)
        path = self.folder / FOLDER / FILE if seed % 2 else files[seed // 2 % len(files)]
        data = bytearray(path.read_bytes())
        for _ in range(rng.choice((1, 1, 4))):
            data[rng.randrange(len(data))] ^= 1 << rng.randrange(8)
        path.write_bytes(data)
        if check(self.folder / FOLDER).faults and (left := repair(self.folder / FOLDER, SmallBundle())):
            return f"{path.name}: {left[0]}"
        found = differences(self.expected, content(self.folder, SmallBundle()))
        return f"{path.name}: {found[0]}" if found else ""
