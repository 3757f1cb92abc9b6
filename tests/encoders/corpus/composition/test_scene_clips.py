"""Clips of scenes: deterministic, varied between performers, with exact spans."""

from __future__ import annotations

import numpy as np
import pytest

from encoders.corpus.composition.scene_clips import make_clip
from encoders.corpus.engine.curves import HANGING
from encoders.corpus.scene import ActionStep, Scene
from encoders.skeleton import INDEX
from tests.encoders.corpus.performances import joint, plain


def test_the_same_seed_makes_the_same_clip() -> None:
    scene = Scene(((ActionStep("walk"), ActionStep("wave", side="left")), (ActionStep("sit down"),)))
    first, second, other = (make_clip(scene, np.random.default_rng(seed)) for seed in (3, 3, 4))
    np.testing.assert_array_equal(first.joints, second.joints)
    assert first.spans == second.spans
    assert first.joints.shape != other.joints.shape or not np.allclose(first.joints, other.joints)


def test_spans_lie_within_the_clip() -> None:
    scene = Scene(((ActionStep("walk"),), (ActionStep("wave"),)))
    for seed in range(30):
        clip = make_clip(scene, np.random.default_rng(seed))
        assert all(0 <= a < b <= len(clip.joints) / clip.fps + 1e-6 for a, b in clip.spans)


def test_bodies_and_performers_differ() -> None:
    scene = Scene(((ActionStep("stand"),),))
    clips = [make_clip(scene, np.random.default_rng(seed)) for seed in range(10)]
    across = [np.linalg.norm(joint(c, "left_shoulder") - joint(c, "right_shoulder"), axis=1).mean() for c in clips]
    assert np.std(across) > 0.015
    assert 0.2 < min(across) < max(across) < 0.6
    assert HANGING[1] < 0
    plain_bones = (
        plain(ActionStep("stand")).joints[0, INDEX["left_knee"]]
        - plain(ActionStep("stand")).joints[0, INDEX["left_hip"]]
    )
    assert np.linalg.norm(plain_bones) == pytest.approx(0.4, abs=1e-3)


def test_unknown_actions_and_styles_are_refused() -> None:
    with pytest.raises(KeyError):
        plain(ActionStep("levitate"))
    with pytest.raises(KeyError):
        plain(ActionStep("walk", style="quantum"))
