"""Prints nothing: writes the clips of `motionseek demo`, CMU motion capture thinned to 30 frames a second.

    python -m benchmarks.make_demo data/mocap search/demo_data

File names say nothing about the motion, as in most archives; SOURCES.tsv has the trial of each and TERMS.txt the terms.
Files are edited as text: frames are left out and numbers rounded, skeletons stay as they are.
"""

from __future__ import annotations

import argparse
import json
import random
import shutil
from pathlib import Path

from indexer.datasets.archive_tables import read_manifest

#: Short clips (mostly trials that the default model was not trained on) and long takes, by path in the archive.
CLIPS = """
motionbuilder/02/02_02.bvh motionbuilder/05/05_03.bvh motionbuilder/05/05_20.bvh motionbuilder/06/06_12.bvh
motionbuilder/07/07_05.bvh motionbuilder/07/07_08.bvh motionbuilder/08/08_01.bvh motionbuilder/11/11_01.bvh
motionbuilder/27/27_01.bvh motionbuilder/29/29_01.bvh motionbuilder/35/35_03.bvh motionbuilder/35/35_18.bvh
motionbuilder/39/39_04.bvh motionbuilder/49/49_05.bvh motionbuilder/49/49_12.bvh motionbuilder/02/02_05.bvh
daz/09/09_01.bvh daz/09/09_08.bvh daz/13/13_07.bvh daz/13/13_32.bvh daz/13/13_34.bvh daz/13/13_37.bvh
daz/13/13_41.bvh rig_75a3da/131/131_02.bvh
motionbuilder/124/124_01.bvh daz/85/85_02.bvh rig_75a3da/131/131_03.bvh motionbuilder/49/49_18.bvh
motionbuilder/06/06_14.bvh motionbuilder/06/06_02.bvh motionbuilder/49/49_06.bvh motionbuilder/05/05_06.bvh
motionbuilder/05/05_02.bvh motionbuilder/49/49_10.bvh daz/14/14_37.bvh motionbuilder/49/49_03.bvh
motionbuilder/02/02_04.bvh daz/10/10_01.bvh motionbuilder/02/02_08.bvh daz/03/03_01.bvh
motionbuilder/08/08_07.bvh
""".split()
LONG = ("asf_amc_30fps/86/86_09.amc", "asf_amc_30fps/14/14_25.amc")
TERMS = (
    "Carnegie Mellon University Graphics Lab Motion Capture Database, mocap.cs.cmu.edu; created with funding from "
    "NSF EIA-0196217. Free for all uses, also in products; the files themselves may not be resold."
)

#: What the demo searches for.
QUESTIONS = ("a person kicks a ball", "someone climbs up a ladder", "running and then jumping")
MOMENT = {"sentence": "a person sits down", "clip": "session_01.amc"}


def thin(source: Path, target: Path, rate: float, keep: float = 30.0, decimals: int = 2) -> None:
    """Write every n-th frame of a BVH, with numbers rounded."""
    step = max(1, round(rate / keep))
    head, _, motion = source.read_text(encoding="latin-1").partition("MOTION")
    lines = [line for line in motion.splitlines() if line.strip()]
    frames = lines[2::step]
    rows = [" ".join(f"{float(v):.{decimals}f}".rstrip("0").rstrip(".") for v in frame.split()) for frame in frames]
    body = "\n".join(["MOTION", f"Frames: {len(rows)}", f"Frame Time: {step / rate:.6f}", *rows])
    target.write_text(head.replace("\r", "") + body + "\n", encoding="utf-8")


def write_demo(archive: Path, target: Path) -> None:
    """Fill `target` with clips, SOURCES.tsv, TERMS.txt and a captions.tsv that only gives frame rates."""
    manifest = read_manifest(archive, ("split", "use", "description"))
    rows = {row["path"]: row for row in manifest if row["use"] in ("train", "val")}
    chosen = [f"cmu/{path}" for path in CLIPS if f"cmu/{path}" in rows]
    random.Random(7).shuffle(chosen)
    shutil.rmtree(target, ignore_errors=True)
    target.mkdir(parents=True)
    sources = []
    for number, path in enumerate(chosen, 1):
        row = rows[path]
        name = f"take_{number:03d}.bvh"
        thin(archive / path, target / name, float(row["fps_true"] or row["fps_in_file"]))
        sources.append((name, row["trial"], row["split"], row["description"]))
    rates = []
    for number, path in enumerate(LONG, 1):
        source, row = archive / "cmu" / path, rows[f"cmu/{path}"]
        name = f"session_{number:02d}"
        skeleton = next(source.parent.glob("*.asf"))
        shutil.copyfile(source, target / f"{name}.amc")
        shutil.copyfile(skeleton, target / f"{name}.asf")
        rates.append((f"{name}.amc", row["fps_true"]))
        sources.append((f"{name}.amc", row["trial"], row["split"], row["description"]))
    _table(target / "captions.tsv", ("path", "text", "fps"), [(name, "", rate) for name, rate in rates])
    _table(target / "SOURCES.tsv", ("file", "CMU trial", "split", "CMU's description"), sources)
    script = {"questions": QUESTIONS, "moment": MOMENT}
    (target / "demo.json").write_text(json.dumps(script, indent=1) + "\n", encoding="utf-8")
    (target / "TERMS.txt").write_text(TERMS + "\n", encoding="utf-8")


def _table(path: Path, header: tuple[str, ...], rows: list[tuple[str, ...]]) -> None:
    path.write_text("".join("\t".join(row) + "\n" for row in (header, *rows)), encoding="utf-8")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("archive", type=Path, help="folder of the CMU takes with a manifest.tsv")
    parser.add_argument("target", type=Path, help="folder of the demo; what it holds is replaced")
    given = parser.parse_args()
    write_demo(given.archive, given.target)


if __name__ == "__main__":
    main()
