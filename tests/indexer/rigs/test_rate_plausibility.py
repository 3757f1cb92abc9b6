"""A frame rate at which nobody moves is named, with one that would fit; others are not."""

from __future__ import annotations

import numpy as np
import pytest

from encoders.motion import Motion
from encoders.skeleton import INDEX
from indexer.rigs.rate_plausibility import rate_warnings


def walk(speed: float, way: float = 0.7, seconds: float = 10) -> Motion:
    """A body whose hands and feet swing by so many metres, at so many times the speed of a walk."""
    time = np.arange(0, seconds, 1 / 20)
    joints = np.zeros((len(time), 22, 3))
    swing = way / 2 * np.sin(2 * np.pi * speed * time)
    for name in ("left_ankle", "right_wrist"):
        joints[:, INDEX[name], 2] = swing
    for name in ("right_ankle", "left_wrist"):
        joints[:, INDEX[name], 2] = -swing
    return Motion(joints.astype(np.float32), 20.0)


@pytest.mark.parametrize("speed", [0.5, 1, 2])
def test_who_walks_is_not_named(speed: float) -> None:
    assert rate_warnings(walk(speed), 30) == ()


def test_a_walk_that_lasts_minutes_is_named_with_its_rate() -> None:
    (warning,) = rate_warnings(walk(1 / 20, seconds=100), 2)
    assert "slower" in warning
    assert "perhaps 60" in warning or "perhaps 30" in warning


def test_a_walk_of_a_moment_is_named() -> None:
    (warning,) = rate_warnings(walk(5, way=1.2), 240)
    assert "faster" in warning
    assert "perhaps 30" in warning or "perhaps 60" in warning


def test_who_stands_idle_is_not_named() -> None:
    assert rate_warnings(walk(0.05, way=0.3, seconds=100), 24) == ()
