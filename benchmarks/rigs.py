"""Distances in cm between the joints of one performance in several rigs, and the files that cannot be read.

    python -m benchmarks.rigs data/mocap [data/bandai1 ...] [--sheet rigs.png] [--joints]

For each trial that the folder's manifest.tsv lists in several rigs, both are read, brought to 20 frames a second
and the target bone lengths, aligned in time, and compared in the body's own frame: pelvis at the origin,
heading removed. Prints the mean distance of a joint in cm for each pair of rigs, then what could not be read.
"""

from __future__ import annotations

import argparse
import csv
import itertools
import time
from collections import Counter, defaultdict
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from encoders.errors import UnreadableMotion
from encoders.motion import Motion
from encoders.skeleton import INDEX, JOINTS, PARENTS
from indexer.formats.table import READABLE
from indexer.ingest.load import load_motion

#: Frames at 20 fps by which two recordings of a trial may begin apart.
MAX_SHIFT = 40
#: Endings of files that cannot be read; they are counted as failures.
UNSUPPORTED = (".c3d",)

Array = NDArray[np.float64]


def body_frame(motion: Motion) -> Array:
    """Joints (T, 22, 3) with the pelvis at the origin and the hips' heading removed."""
    joints = motion.joints.astype(np.float64)
    joints = joints - joints[:, :1]
    across = joints[:, INDEX["left_hip"]] - joints[:, INDEX["right_hip"]]
    angle = np.arctan2(across[:, 2], across[:, 0])
    cos, sin = np.cos(angle)[:, None], np.sin(angle)[:, None]
    x, y, z = joints[..., 0], joints[..., 1], joints[..., 2]
    return np.stack([cos * x + sin * z, y, cos * z - sin * x], axis=-1)


def distances(a: Array, b: Array) -> Array:
    """Distance of each joint (22,) in metres at the best alignment in time."""
    best = np.full(len(JOINTS), np.inf)
    for shift in range(-min(MAX_SHIFT, len(b) - 1), min(MAX_SHIFT, len(a) - 1) + 1):
        first, second = a[max(shift, 0) :], b[max(-shift, 0) :]
        length = min(len(first), len(second))
        if length < 0.6 * min(len(a), len(b)):
            continue
        apart = np.linalg.norm(first[:length] - second[:length], axis=-1).mean(axis=0)
        if apart.mean() < best.mean():
            best = apart
    return best


def read_all(folders: list[Path], rates: dict[Path, float]) -> tuple[dict[Path, Motion], dict[Path, str]]:
    """Motions of all motion files under some folders, and the reason for each that is none."""
    motions: dict[Path, Motion] = {}
    failures: dict[Path, str] = {}
    paths = sorted(p for folder in folders for p in folder.rglob("*") if p.suffix.lower() in (*READABLE, *UNSUPPORTED))
    for path in paths:
        try:
            motions[path] = load_motion(path, fps=rates.get(path))
        except UnreadableMotion as error:
            failures[path] = error.reason
    return motions, failures


def sheet(motions: dict[Path, Motion], file: Path) -> None:
    """One frame of each folder's first motion, seen from the front and from its left; left blue, right red."""
    import matplotlib

    matplotlib.use("Agg")
    from matplotlib import pyplot

    shown = {path.parent: path for path in sorted(motions, reverse=True)}
    columns = 10
    _, axes = pyplot.subplots(-(-len(shown) // columns), columns, figsize=(24, 2.6 * -(-len(shown) // columns)))
    for axis in axes.flat:
        axis.axis("off")
    for path, axis in zip(sorted(shown.values()), axes.flat, strict=False):
        pose = body_frame(motions[path])[len(motions[path]) // 2]
        for child, parent in enumerate(PARENTS):
            if parent >= 0:
                colour = {"l": "tab:blue", "r": "tab:red"}.get(JOINTS[child][0], "black")
                bone = pose[[child, parent]]
                axis.plot(bone[:, 0], bone[:, 1], color=colour)
                axis.plot(bone[:, 2] + 1.6, bone[:, 1], color=colour)
        axis.set(aspect="equal", xlim=(-0.9, 2.5), ylim=(-1.1, 1.1))
        axis.set_title("/".join(path.parts[-2:])[-36:], fontsize=7)
    pyplot.savefig(file, dpi=90, bbox_inches="tight")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folders", nargs="+", type=Path)
    parser.add_argument("--sheet", type=Path, help="write a picture of one pose a folder")
    parser.add_argument("--joints", action="store_true", help="also print the distance of each joint")
    options = parser.parse_args()

    rows = [row for folder in options.folders for row in manifest(folder)]
    rates = {row["file"]: float(row["fps_true"]) for row in rows if row["fps_true"]}
    started = time.process_time()
    motions, failures = read_all(options.folders, rates)
    seconds = time.process_time() - started
    size = sum(path.stat().st_size for path in motions) / 1e6
    speed = f"{size:.0f} MB in {seconds:.1f} s of CPU time, {size / seconds:.0f} MB/s"
    print(f"{len(motions)} files read, {len(failures)} not; {speed}")
    print_pairs(rows, motions, options.joints)
    print("\nnot read")
    for (reason, ending), count in Counter((reason, p.suffix) for p, reason in failures.items()).most_common():
        example = next(p for p, r in failures.items() if r == reason and p.suffix == ending)
        print(f"{count:4}  {example}{' and others' if count > 1 else ''}: {reason}")
    if options.sheet:
        sheet(motions, options.sheet)


def manifest(folder: Path) -> list[dict[str, object]]:
    """Rows of the folder's manifest.tsv, each with its `file`; none where there is no manifest."""
    file = folder / "manifest.tsv"
    if not file.is_file():
        return []
    with file.open(encoding="utf-8", newline="") as lines:
        return [{**row, "file": folder / row["path"]} for row in csv.DictReader(lines, delimiter="\t")]


def print_pairs(rows: list[dict[str, object]], motions: dict[Path, Motion], joints: bool) -> None:
    """The table of rig pairs, in cm."""
    trials = defaultdict(list)
    for row in rows:
        if row["kind"] == "take" and row["file"] in motions:
            trials[row["trial"]].append((str(row["rig"]).replace("asf_amc_30fps", "asf_amc"), row["file"]))
    pairs: dict[tuple[str, str], list[tuple[str, Array]]] = defaultdict(list)
    for trial, files in trials.items():
        for (rig_a, a), (rig_b, b) in itertools.combinations(sorted(files), 2):
            apart = distances(body_frame(motions[a]), body_frame(motions[b]))
            pairs[rig_a, rig_b].append((str(trial), apart))
    print(f"\n{'pair of rigs':32}{'trials':>7}{'mean cm':>9}{'worst':>7}  {'in trial':10}{'over 8 cm':>9}")
    for (rig_a, rig_b), found in sorted(pairs.items()):
        means = np.array([100 * apart.mean() for _, apart in found])
        worst = int(means.argmax())
        print(
            f"{rig_a + ' / ' + rig_b:32}{len(found):7}{means.mean():9.2f}{means[worst]:7.1f}"
            f"  {found[worst][0]:10}{(means >= 8).sum():9}"
        )
    if joints:
        for pair, found in sorted(pairs.items()):
            mean = 100 * np.mean([apart for _, apart in found], axis=0)
            print("\n" + " / ".join(pair), *(f"{n} {m:.1f}" for n, m in zip(JOINTS, mean, strict=True)), sep="  ")
    everything = [100 * apart.mean() for found in pairs.values() for _, apart in found]
    if everything:
        print(f"{'all':32}{len(everything):7}{np.mean(everything):9.2f}{np.max(everything):7.1f}")


if __name__ == "__main__":
    main()
