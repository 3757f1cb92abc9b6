"""A motion in a notebook, as HTML: whole, small, and harmless."""

from __future__ import annotations

import base64
import re
import struct

import numpy as np
import pytest

from encoders.drawing.player import player
from encoders.motion import Motion
from tests.search.conftest import made_motion


def shown(motion: Motion, text: str) -> tuple[np.ndarray, float, str]:
    return motion.joints, motion.fps, text


def _bytes(html: str) -> bytes:
    found = re.search(r'data-motionseek="([^"]+)"', html)
    assert found is not None
    return base64.b64decode(found.group(1))


def _joints(data: bytes) -> tuple[np.ndarray, float]:
    """What the script makes of the bytes: joints relative to where the first frame stands, and frames a second."""
    frames, joints, fps, far, near = struct.unpack_from("<2I3f", data)
    pelvis = np.frombuffer(data, "<i2", 3 * frames, 32).reshape(frames, 1, 3) * far
    others = np.frombuffer(data, "i1", 3 * frames * (joints - 1), 32 + 10 * frames).reshape(frames, joints - 1, 3)
    return np.concatenate([pelvis, pelvis + others * near], axis=1), fps


def test_the_joints_survive_within_a_centimetre() -> None:
    motion = made_motion(6, 3)
    joints, fps = _joints(_bytes(player([shown(motion, "")])))
    wanted = motion.resample(10).joints - motion.joints[0, 0] * [1, 0, 1]
    assert fps == 10
    assert joints.shape == wanted.shape
    assert np.abs(joints - wanted).max() < 0.01


@pytest.mark.parametrize("seconds", [0.05, 5, 48, 400])
def test_a_motion_of_any_length_is_small(seconds: float) -> None:
    assert len(made_motion(seconds, 0)._repr_html_()) < 60_000


def test_a_long_motion_says_how_much_of_it_is_shown() -> None:
    html = player([shown(made_motion(70, 0), "take")], seconds=30)
    assert "take (the first 30 s of 70)" in html
    assert len(_joints(_bytes(html))[0]) == 300


def test_many_motions_share_one_script() -> None:
    html = player(shown(made_motion(1, i), f"clip {i}") for i in range(5))
    assert (html.count("<script>"), html.count("data-motionseek=")) == (1, 5)


def test_it_needs_nothing_from_anywhere() -> None:
    html = player([shown(made_motion(1, 0), "")])
    assert not re.search(r"https?:|//[a-z]|src=|href=|import\b|fetch\(", html)


def test_text_stays_text() -> None:
    html = player([shown(made_motion(1, 0), '</script><img src=x onerror="alert(1)">')])
    assert "<img" not in html
    assert html.count("</script>") == 1
    assert "&lt;/script&gt;&lt;img src=x onerror=&quot;alert(1)&quot;&gt;" in html


def test_where_no_script_runs_a_pose_is_seen() -> None:
    html = player([shown(made_motion(2, 0), "bows")])
    assert 'role="img" aria-label="bows"' in html
    numbers = [float(n) for n in re.findall(r"[ML]([\d.-]+) ([\d.-]+)", html) for n in n]
    assert len(numbers) == 26 * 4
    assert -5 < min(numbers) < 45
    assert 55 < max(numbers) < 105


def test_a_single_frame_shows_itself() -> None:
    assert _joints(_bytes(Motion(made_motion(1, 0).joints[:1])._repr_html_()))[0].shape == (1, 22, 3)
