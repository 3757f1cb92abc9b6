"""How well copies of one performance are told from motions that are merely alike, and what that costs in an archive.

    python -m benchmarks.stacks rigs data/mocap [FOLDER...]
    python -m benchmarks.stacks time data/mocap --clips 100000

`rigs` compares all takes of each split with each other. Two that show one trial in two rigs, of which one may be
mirrored, are copies; any others are none. FOLDERs hold other archives, of which no two files are of one trial. `time`
draws shapes from those of the archive, with durations from one second to a minute, and compares them as `motionseek
duplicates` does, and as one plain matrix product of all with all would take, timed on a part of it.
"""

from __future__ import annotations

import argparse
import sys
import time
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from encoders.errors import MotionSeekError
from encoders.motion import Motion
from indexer.datasets.archive_tables import load_row, read_manifest
from indexer.formats.table import READABLE
from indexer.ingest.load import load_motion
from indexer.store import poses
from search.stacks.copies import COPIES_FROM, Shapes, pairs_of
from search.stacks.shapes import shape_of

#: Thresholds beside the one that is used.
_AROUND = (0.85, 0.87, COPIES_FROM, 0.91, 0.93)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("what", choices=["rigs", "time"])
    parser.add_argument("archive", type=Path, help="folder of takes in several rigs, with a manifest.tsv")
    parser.add_argument("others", type=Path, nargs="*", metavar="FOLDER", help="archives without copies")
    parser.add_argument("--clips", type=int, default=100_000)
    arguments = parser.parse_args()
    rows, motions = takes(arguments.archive)
    if arguments.what == "time":
        cost(motions, arguments.clips)
        return
    splits = np.array([row["split"] for row in rows])
    for split in ("train", "val"):
        own = np.flatnonzero(splits == split)
        compare(split, [motions[i] for i in own], [rows[i]["trial"] for i in own])
    for folder in arguments.others:
        files = [path for path in sorted(folder.rglob("*")) if path.suffix.lower() in READABLE]
        others = [read(path) for path in files]
        found = [motion for motion in others if motion is not None]
        compare(folder.name, found, [str(i) for i in range(len(found))])


def takes(archive: Path) -> tuple[list[dict[str, str]], list[Motion]]:
    """The takes of an archive that are not for evaluation only."""
    rows, motions = [], []
    for row in read_manifest(archive, ("use", "rig", "split")):
        if row["kind"] == "take" and row["use"] != "evaluation only":
            try:
                motions.append(load_row(archive, row))
                rows.append(row)
            except MotionSeekError as error:
                print(error, file=sys.stderr)
    return rows, motions


def read(path: Path) -> Motion | None:
    """A motion file; none where it holds no motion."""
    try:
        return load_motion(path, fps=120 if path.suffix.lower() == ".amc" else None)
    except MotionSeekError as error:
        print(error, file=sys.stderr)
        return None


def shapes_of(motions: list[Motion]) -> Shapes:
    """The shapes of motions."""
    found = [shape_of(motion.joints, motion.duration) for motion in motions]
    columns = (np.stack([s.vector for s in found]), [s.duration for s in found], [s.way for s in found])
    return Shapes(columns[0].astype(np.float16), np.array(columns[1], np.float32), np.array(columns[2], np.float32))


def compare(name: str, motions: list[Motion], trials: list[str]) -> None:
    """Print recall and precision of copies, as they are and with one of each pair mirrored."""
    count, named = len(motions), np.array(trials)
    shapes = shapes_of(motions + [motion.mirror() for motion in motions])
    same = np.triu(named[:, None] == named, 1)
    print(f"{name}: {count} files, {same.sum()} pairs of one trial, {count * (count - 1) // 2 - same.sum()} of two")
    for threshold in _AROUND:
        rows, flags = pairs_of(np.arange(2 * count), shapes, threshold=threshold)
        lines = []
        for what, low, high, flipped in (("as they are", 0, 0, False), ("mirrored", 0, count, True)):
            inside = (rows[:, 0] // count == low) & (rows[:, 1] // count == high // count) & (flags == flipped)
            a, b = rows[inside, 0] % count, rows[inside, 1] % count
            a, b = np.minimum(a, b)[a != b], np.maximum(a, b)[a != b]
            found = np.zeros((count, count), bool)
            found[a, b] = True
            right, wrong = int((found & same).sum()), int((found & ~same).sum())
            recall = f"recall {100 * right / same.sum():5.1f} %" if same.any() else ""
            precision = f"precision {100 * right / max(right + wrong, 1):5.1f} %" if same.any() else ""
            lines.append(f"{what}: {recall} {precision} {wrong} wrong")
        print(f"  from {threshold:.2f}{' *' if threshold == COPIES_FROM else '  '} {';  '.join(lines)}")


def cost(motions: list[Motion], count: int) -> None:
    """Print what many clips cost: their shapes from stored poses, and their comparison."""
    rng = np.random.default_rng(0)
    stored = [poses.pack_all(motion.joints) for motion in motions]
    began = time.perf_counter()
    for chunks, motion in zip(stored, motions, strict=True):
        shape_of(np.concatenate([poses.unpack(chunk) for chunk in chunks]), motion.duration)
    each, seconds = (time.perf_counter() - began) / len(motions), np.mean([motion.duration for motion in motions])
    print(
        f"shape of a clip of {seconds:.1f} s from stored poses: {1e3 * each:.2f} ms, {each * count:.0f} s for {count}"
    )
    real = shapes_of(motions)
    picked = rng.integers(0, len(motions), count)
    noise = rng.standard_normal((count, real.vectors.shape[1]), np.float32)
    vectors = real.vectors[picked].astype(np.float32) + noise / np.linalg.norm(noise, axis=1, keepdims=True)
    vectors = (vectors / np.linalg.norm(vectors, axis=1, keepdims=True)).astype(np.float16)
    durations = np.exp(rng.uniform(0, np.log(60), count)).astype(np.float32)
    shapes = Shapes(vectors, durations, real.ways[picked])
    began = time.perf_counter()
    pairs_of(np.arange(count), shapes)
    all_new = time.perf_counter() - began
    began = time.perf_counter()
    pairs_of(rng.choice(count, 100, replace=False), shapes)
    few_new = time.perf_counter() - began
    began = time.perf_counter()
    _plain(vectors[:1000], vectors)
    plain = (time.perf_counter() - began) * count / 1000
    print(f"{count} clips compared: {all_new:.1f} s; 100 new ones with them: {few_new:.2f} s")
    print(f"all with all, plain: {plain:.0f} s, {plain / all_new:.0f} times as long")
    print(f"{vectors.nbytes / 1e6:.0f} MB of shapes")


def _plain(queries: NDArray[np.float16], vectors: NDArray[np.float16]) -> int:
    """Compare queries with all vectors, and with all mirrored, block by block."""
    found = 0
    for first in range(0, len(vectors), 10_000):
        block = vectors[first : first + 10_000].astype(np.float32).T
        found += sum(int((queries.astype(np.float32) @ block >= COPIES_FROM).sum()) for _ in range(2))
    return found


if __name__ == "__main__":
    main()
