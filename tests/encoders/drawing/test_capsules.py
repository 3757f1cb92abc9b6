"""The capsule model of a body, and where a camera aims."""

from __future__ import annotations

import json
import re

import numpy as np

from encoders.drawing.capsules import CAPSULES, aim, capsules, heading, view_axes
from tests.conftest import ROOT
from tests.search.conftest import made_motion


def test_the_aim_is_the_pelvis_smoothed_and_keeps_its_ends() -> None:
    motion = made_motion(5, 2)
    pelvis = motion.joints[:, 0, [0, 2]]
    assert np.allclose(aim(motion.joints, motion.fps)[[0, -1]], pelvis[[0, -1]], atol=1e-5)
    assert np.abs(aim(motion.joints, motion.fps) - pelvis).max() < 0.5


def test_capsules_span_their_joints_and_go_on_beyond_the_last() -> None:
    joints = made_motion(1, 0).joints
    ends = capsules(joints)
    assert ends.shape == (20, len(CAPSULES), 2, 3)
    for i, c in enumerate(CAPSULES):
        if c.beyond:
            assert np.allclose(np.linalg.norm(ends[:, i, 1] - ends[:, i, 0], axis=-1), c.beyond, atol=1e-5)
        else:
            assert np.array_equal(ends[:, i], joints[:, [c.start, c.end]])


def test_the_page_draws_the_same_person() -> None:
    script = (ROOT / "search" / "page" / "figure.js").read_text(encoding="utf-8")
    table = re.search(r"const BONES = \[(.*?)\]; //", script, re.DOTALL)
    assert table is not None
    rows = json.loads(f"[{table.group(1).strip().rstrip(',')}]")
    ours = [
        [c.start, -c.end if c.beyond else c.end, c.near, c.far, c.part, *([c.beyond] if c.beyond else [])]
        for c in CAPSULES
    ]
    assert rows == ours


def test_a_viewer_ahead_sees_the_left_hip_on_the_right() -> None:
    joints = made_motion(2, 0).joints
    right, up, towards = view_axes(heading(joints))
    assert np.allclose(np.cross(right, up), towards, atol=1e-6)
    assert up.tolist() == [0, 1, 0]
    assert ((joints[:, 1] - joints[:, 2]) @ right).sum() > 0


def test_a_viewer_who_looks_down_sees_what_is_in_front_lower() -> None:
    _, up, towards = view_axes(0.3, pitch=0.2)
    ahead = np.array([np.sin(0.3), 0, np.cos(0.3)])
    assert ahead @ up < 0 < ahead @ towards
