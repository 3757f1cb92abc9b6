"""Posing keeps bone lengths and bends limbs the human way."""

from __future__ import annotations

import numpy as np

from encoders.corpus.composition.scene_clips import perform_scene
from encoders.corpus.engine.curves import Curves, standing
from encoders.corpus.engine.posing import OFFSETS, pose, random_geometry
from encoders.corpus.scene import ActionStep, Scene
from encoders.motion import Motion
from encoders.skeleton import PARENTS
from tests.encoders.corpus.performances import joint, plain


def test_bones_keep_their_lengths() -> None:
    rng = np.random.default_rng(0)
    curves = perform_scene(Scene(((ActionStep("run"),), (ActionStep("squat", count=2),))), rng)
    joints = pose(curves, random_geometry(rng))
    bones = np.linalg.norm(joints[:, 1:] - joints[:, PARENTS[1:]], axis=-1)
    np.testing.assert_allclose(bones, np.broadcast_to(bones[0], bones.shape), atol=1e-9)


def test_knees_bend_forward_and_elbows_back() -> None:
    clip = plain(ActionStep("walk", direction="forward"))
    for side in ("left", "right"):
        hip, knee, ankle = (joint(clip, f"{side}_{n}") for n in ("hip", "knee", "ankle"))
        assert ((knee - (hip + ankle) / 2)[:, 2] > -0.01).all()
        shoulder, elbow, wrist = (joint(clip, f"{side}_{n}") for n in ("shoulder", "elbow", "wrist"))
        assert ((elbow - (shoulder + wrist) / 2)[:, 2] < 0.02).mean() > 0.95


def test_mirrored_curves_are_the_mirrored_motion() -> None:
    curves = perform_scene(
        Scene(((ActionStep("lunge", side="left"),), (ActionStep("turn", direction="left"),))), np.random.default_rng(1)
    )
    mirrored = Motion(pose(curves, OFFSETS).astype(np.float32)).mirror().joints
    np.testing.assert_allclose(pose(curves.mirrored(), OFFSETS), mirrored, atol=1e-5)
    arm = Curves(standing(4).data, [(0, 4)], frozenset({"left_arm"}))
    assert arm.mirrored().parts == {"right_arm"}
