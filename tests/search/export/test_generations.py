"""What is exported and read again, four times over, stays the same movement."""

from __future__ import annotations

import zlib
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from encoders.corpus.composition.scene_clips import make_clip
from encoders.corpus.scene import ActionStep, Scene
from encoders.motion import Motion
from indexer.ingest.file_parts import read_take
from indexer.ingest.load import load_motion
from indexer.rigs.rebuild import rebuild
from search.export.cut import WRITERS, write_cut
from search.source import MotionSource

#: Centimetres that a joint may be off in any generation.
NEAR = 0.5


def _clip(action: str, **more: str) -> Motion:
    scene = Scene(((ActionStep(action, **more),),))
    clip = make_clip(scene, np.random.default_rng(zlib.crc32(action.encode())), variation=0.0)
    return Motion(rebuild(clip.joints.astype(np.float64), 1.0).astype(np.float32))


MOTIONS: dict[str, Callable[[], Motion]] = {
    "a walk": lambda: _clip("walk"),
    "a crawl": lambda: _clip("crawl"),
    "a handstand": lambda: _clip("handstand"),
    "a gesture with both arms": lambda: _clip("clap"),
    "a walk on the ceiling": lambda: _upside_down(_clip("walk")),
}


def _upside_down(motion: Motion) -> Motion:
    """Turned by half a turn about the z axis."""
    return Motion(motion.joints * np.array([-1, -1, 1], np.float32), motion.fps)


@pytest.mark.parametrize("ending", [ending for ending in WRITERS if ending != ".npy"])
@pytest.mark.parametrize("name", MOTIONS)
def test_four_generations_are_one_movement(name: str, ending: str, tmp_path: Path) -> None:
    first = tmp_path / f"0{ending}"
    write_cut(MotionSource.of_motion(MOTIONS[name]()), first)
    motion = load_motion(first)
    for generation in range(1, 5):
        write_cut(MotionSource.of_motion(load_motion(tmp_path / f"{generation - 1}{ending}")), tmp_path / f"x{ending}")
        (tmp_path / f"x{ending}").rename(tmp_path / f"{generation}{ending}")
        again = load_motion(tmp_path / f"{generation}{ending}")
        assert np.abs(again.joints - motion.joints).max() * 100 < (1e-3 if ending == ".npz" else NEAR)
        assert np.abs(_from_pelvis(again) - _from_pelvis(MOTIONS[name]())).max() * 100 < NEAR


def test_the_exported_rig_turns_its_joints_and_moves_none(tmp_path: Path) -> None:
    write_cut(MotionSource.of_motion(MOTIONS["a walk"]()), tmp_path / "walk.bvh")
    channels = [line.split() for line in (tmp_path / "walk.bvh").read_text().splitlines() if "CHANNELS" in line]
    assert [line[1] for line in channels] == ["6", *["3"] * 21]


def test_bones_that_stretch_keep_every_joint(tmp_path: Path) -> None:
    joints = MOTIONS["a walk"]().joints.copy()
    joints[:, 20:] += np.linspace(0, 0.2, len(joints), dtype=np.float32)[:, None, None]
    write_cut(MotionSource.of_motion(Motion(joints)), tmp_path / "x.bvh")
    take = read_take(tmp_path / "x.bvh")
    wrist = take.names.index("left_wrist")
    np.testing.assert_allclose(take.positions[:, wrist] / 100, joints[:, 20], atol=1e-3)


def _from_pelvis(motion: Motion) -> np.ndarray:
    joints: np.ndarray = motion.joints - motion.joints[:, :1]
    return joints
