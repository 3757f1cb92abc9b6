"""Foot sliding of synthetic clips by action, clips a second, and with `--list` every motion program.

python -m benchmarks.corpus [--clips N] [--list]
"""

from __future__ import annotations

import argparse
import time
from collections import defaultdict

import numpy as np
from numpy.typing import NDArray

from encoders.corpus.actions.programs import programs, sample_step
from encoders.corpus.composition.scene_clips import make_clip
from encoders.corpus.scene import Scene, SceneClip
from encoders.skeleton import INDEX

_ANKLES = [INDEX["left_ankle"], INDEX["right_ankle"]]
_TOES = [INDEX["left_foot"], INDEX["right_foot"]]

#: Actions in which feet slide, are in the air or do not stand on their soles.
NOT_STANDING = frozenset(
    {"moonwalk", "ice skate", "ski", "drag leg", "crawl", "army crawl", "roll over", "lie", "swim"}
)


def stance_speeds(clip: SceneClip) -> NDArray[np.float64]:
    """Horizontal speed (cm/s) of every sole in stance: ankle and toe both within 3 cm of their lowest heights."""
    ankles, toes = clip.joints[:, _ANKLES].astype(np.float64), clip.joints[:, _TOES].astype(np.float64)
    low = (ankles[..., 1] < ankles[..., 1].min() + 0.03) & (toes[..., 1] < toes[..., 1].min() + 0.03)
    stands = low[1:] & low[:-1]
    speed = np.linalg.norm(np.diff(ankles[..., [0, 2]], axis=0), axis=-1) * clip.fps * 100
    return np.asarray(speed[stands])


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--clips", type=int, default=600)
    parser.add_argument("--list", action="store_true", help="list every program")
    arguments = parser.parse_args()
    actions = programs()
    names = list(actions)
    rng = np.random.default_rng(1)
    scenes = [Scene(((sample_step(actions[names[i % len(names)]], rng),),)) for i in range(arguments.clips)]

    sliding: dict[str, list[NDArray[np.float64]]] = defaultdict(list)
    for seed, scene in enumerate(scenes):
        clip = make_clip(scene, np.random.default_rng(seed), variation=0.0)
        sliding[scene.steps[0][0].action].append(stance_speeds(clip))
    standing = [s for name, speeds in sliding.items() if name not in NOT_STANDING for s in speeds]
    together = np.concatenate(standing)
    print(f"foot sliding in stance: mean {together.mean():.1f} cm/s, 95 % below {np.percentile(together, 95):.1f} cm/s")
    worst = sorted(((float(np.concatenate(s).mean()), n) for n, s in sliding.items() if sum(map(len, s))), reverse=True)
    print("most: " + ", ".join(f"{name} {speed:.1f}" for speed, name in worst[:12]))

    started, busy, frames = time.perf_counter(), time.process_time(), 0
    for seed, scene in enumerate(scenes):
        frames += len(make_clip(scene, np.random.default_rng(seed)).joints)
    wall, cpu = time.perf_counter() - started, time.process_time() - busy
    print(
        f"{len(scenes)} clips of {frames / 20 / len(scenes):.1f} s on average: {len(scenes) / wall:.0f} clips/s "
        f"({len(scenes) / cpu:.0f} per second of CPU time)"
    )
    groups: dict[str, list[str]] = defaultdict(list)
    for name, action in actions.items():
        groups[action.group].append(name)
    print(f"{len(actions)} programs: " + ", ".join(f"{len(v)} {k}" for k, v in sorted(groups.items())))
    if arguments.list:
        for group, members in sorted(groups.items()):
            print(f"{group}: {', '.join(members)}")


if __name__ == "__main__":
    main()
