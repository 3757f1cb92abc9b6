"""Movements in sequence and at the same time."""

from __future__ import annotations

import numpy as np
import pytest

from encoders.corpus.actions.programs import compatible, parts_of
from encoders.corpus.engine.joining import join
from encoders.corpus.engine.posing import OFFSETS, pose
from encoders.corpus.scene import ActionStep
from tests.encoders.corpus.performances import joint, perform, plain


def test_steps_in_sequence_join_where_the_one_before_ended() -> None:
    walk, turn = perform(ActionStep("walk", direction="forward"), 0, 60), perform(ActionStep("turn", direction="left"))
    joined = join(walk, turn)
    frames = len(joined) - len(walk) - len(turn)
    assert 4 <= frames <= 26
    assert joined.spans == [(0, len(walk)), (len(walk) + frames, len(joined))]
    np.testing.assert_array_equal(joined.data[: len(walk)], walk.data)
    assert joined.heading[len(walk) + frames] == pytest.approx(walk.heading[-1])
    speed = np.linalg.norm(np.diff(pose(joined, OFFSETS), axis=0), axis=-1) * 20
    assert speed.max() < 8
    clip = plain(ActionStep("walk"), ActionStep("jump", count=2), ActionStep("sit down"))
    assert len(clip.spans) == 3
    assert all(a[1] <= b[0] for a, b in zip(clip.spans, clip.spans[1:], strict=False))


def test_steps_at_once_share_the_body() -> None:
    assert parts_of(ActionStep("wave", side="left")) == {"left_arm"}
    assert compatible(ActionStep("walk"), ActionStep("wave", side="left"))
    assert not compatible(ActionStep("walk"), ActionStep("run"))
    both = plain((ActionStep("walk", direction="forward"), ActionStep("raise arm", side="left", height="high")))
    assert len(both.spans) == 1
    raised = joint(both, "left_wrist")[:, 1] - joint(both, "left_shoulder")[:, 1]
    hanging = joint(both, "right_wrist")[:, 1] - joint(both, "right_shoulder")[:, 1]
    assert raised.max() > 0.2 > 0 > hanging.max()
    assert np.ptp(joint(both, "pelvis")[:, 2]) > 1
