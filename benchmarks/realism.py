"""How made walking, running and standing differ from real: mean, spread between clips and movement of every feature.

    python benchmarks/realism.py data/mocap captions.jsonl [--worst 12]

Real clips are the captioned spans of the split `train` whose captions all name the gait and nothing besides; made ones
act the same step forward. Frames count where the body goes. Printed are the features that differ most: their mean,
how far clips differ from each other (std), and how much they move within a clip (std), made -> real.
"""

from __future__ import annotations

import argparse
import re
from collections.abc import Iterable
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from encoders.body import LAYOUT, POINTS
from encoders.corpus.made import make
from encoders.corpus.real import real_clips
from encoders.corpus.scene import Scene, Step
from encoders.kinds import FEATURE_KINDS
from indexer.captioned import captioned_takes

Array = NDArray[np.float32]

_BODY = FEATURE_KINDS["body"]
_AHEAD = LAYOUT["root_velocity"].start + 2
#: Action, what its captions say, and the speed (m/s) from which it is under way.
_GAITS = (("walk", r"walk", 0.5), ("run", r"\brun", 1.2), ("jog", r"\bjog", 1.2))
_BESIDES = re.compile(
    r"turn|back|circle|side|left|right|diag|veer|around|zig|curv|stair|step|climb|bend|crouch|limp|tip|sneak|march|jump|"
    r"danc|wave|carr|hold|arm|hand|hill"
)


def main() -> None:
    """Print a table a gait."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=Path)
    parser.add_argument("captions", type=Path)
    parser.add_argument("--worst", type=int, default=12)
    parser.add_argument("--made", type=int, default=150, help="clips of each gait")
    arguments = parser.parse_args()
    takes = captioned_takes(arguments.folder, arguments.captions, "train")
    real = [clip for take in takes for clip in real_clips(take, _BODY, varied=False)]
    rng = np.random.default_rng(0)
    for action, said, speed in _GAITS:
        fitting = [x for x, captions in real if all(re.search(said, c) and not _BESIDES.search(c) for c in captions)]
        scene = Scene(((Step(action, direction="forward"),),))
        acted = [make(scene, rng, _BODY, count=1).features for _ in range(arguments.made)]
        print(f"\n{action}: {len(fitting)} real clips, {len(acted)} made")
        _compare(_figures(acted, speed), _figures(fitting, speed), arguments.worst)


def _figures(clips: Iterable[Array], speed: float) -> tuple[Array, Array, Array]:
    """Mean, std between clips and mean std within clips of each feature (F,), of the frames under way."""
    going = [x[x[:, _AHEAD] > speed] for x in clips]
    going = [x for x in going if len(x) >= 8]
    means, moves = np.stack([x.mean(0) for x in going]), np.stack([x.std(0) for x in going])
    return means.mean(0), means.std(0), np.median(moves, axis=0)


def _compare(made: tuple[Array, Array, Array], real: tuple[Array, Array, Array], worst: int) -> None:
    spread = np.sqrt(made[1] ** 2 + real[1] ** 2) + 0.01
    moves = [np.abs(np.log((real[i] + 0.004) / (made[i] + 0.004))) for i in (1, 2)]
    apart = (np.abs(real[0] - made[0]) / spread, *moves)
    for name, difference, a, b in zip(("mean", "between clips", "within clips"), apart, made, real, strict=True):
        rows = np.argsort(-difference)[:worst]
        print(f"  {name}: " + ", ".join(f"{_NAMES[i]} {a[i]:.3f} -> {b[i]:.3f}" for i in rows))


def _names() -> list[str]:
    names = []
    for group, place in LAYOUT.items():
        count = place.stop - place.start
        of_points = [f"{group} {point}.{axis}" for point in POINTS for axis in "xyz"]
        names += of_points if count == len(of_points) else [f"{group}.{i}" for i in range(count)]
    return names


_NAMES = _names()

if __name__ == "__main__":
    main()
