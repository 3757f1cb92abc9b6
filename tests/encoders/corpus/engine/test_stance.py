"""Stances: feet apart and one ahead, shifting hips; no effect on locomotion."""

from __future__ import annotations

import numpy as np

from encoders.corpus.engine.curves import LEFT, RIGHT, STAND, standing
from encoders.corpus.engine.stance import Stance, sample_stance, stand, step_about


def test_a_stance_moves_the_feet_apart_and_one_ahead() -> None:
    before = standing(40)
    after = stand(standing(40), Stance(apart=0.1, ahead=0.06), np.random.default_rng(0))
    moved = after.feet - before.feet
    assert np.allclose(moved[:, LEFT], [0.1, 0, 0.03])
    assert np.allclose(moved[:, RIGHT], [-0.1, 0, -0.03])


def test_the_stance_turns_with_the_body() -> None:
    curves = standing(40)
    curves.heading[:] = np.pi / 2  # faces +X
    after = stand(curves, Stance(ahead=0.1), np.random.default_rng(0))
    assert np.allclose((after.feet[:, LEFT] - standing(40).feet[:, LEFT])[:, [0, 2]], [0.05, 0], atol=1e-9)


def test_weight_on_one_leg_shifts_the_hips_over_its_foot_and_keeps_the_trunk_upright() -> None:
    after = stand(standing(40), Stance(onto=0.08), np.random.default_rng(0))
    assert np.allclose(after.root[:, 0], 0.08)
    assert np.array_equal(after.feet, standing(40).feet)
    assert (after.pelvis[:, 1] < -0.05).all()  # the left hip is the higher one
    assert np.allclose(after.pelvis[:, 1] + after.spine[:, 1], 0)


def test_the_trunk_leans_sideways() -> None:
    after = stand(standing(40), Stance(aside=0.1), np.random.default_rng(0))
    assert np.allclose(after.spine[:, 1], 0.1)


def test_hips_move_only_in_a_restless_stance() -> None:
    still = stand(standing(100), Stance(), np.random.default_rng(0))
    restless = stand(standing(100), Stance(restless=1.0), np.random.default_rng(0))
    assert np.ptp(still.root, axis=0).max() == 0
    assert 0.01 < np.ptp(restless.root[:, 0]) < 0.12
    assert restless.root[:, 1].max() <= STAND


def test_a_stance_leaves_stepping_and_lying_unchanged() -> None:
    steps, lies = standing(40), standing(40)
    steps.feet[20:, LEFT, 2] += 0.3
    lies.root[:, 1] = 0.2
    for curves in (steps, lies):
        before = curves.data.copy()
        assert np.array_equal(stand(curves, Stance(apart=0.1, restless=1.0), np.random.default_rng(0)).data, before)


def test_without_variation_the_stance_is_neutral() -> None:
    assert sample_stance(np.random.default_rng(0), 0.0) == Stance()


def test_steps_move_the_hips_while_each_foot_is_planted_or_lifted() -> None:
    curves = standing(400)
    step_about(curves, np.random.default_rng(0), 1.0)
    assert np.hypot(*np.diff(curves.root[:, [0, 2]], axis=0).T).sum() > 2.0
    assert np.ptp(curves.heading) > 0.3
    speed = np.hypot(*np.moveaxis(np.diff(curves.feet[..., [0, 2]], axis=0), -1, 0))
    low = np.abs(curves.feet[..., 1] - standing(1).feet[0, 0, 1]) < 1e-6
    planted = low[1:] & low[:-1]
    assert planted.any(axis=0).all()
    assert speed[planted].max() < 0.01
    apart = np.hypot(*(curves.feet[:, LEFT] - curves.feet[:, RIGHT])[:, [0, 2]].T)
    assert apart.max() < 0.9


def test_nobody_steps_while_a_foot_is_raised() -> None:
    curves = standing(100)
    curves.feet[:, LEFT, 1] += 0.3
    before = curves.feet.copy()
    step_about(curves, np.random.default_rng(0), 1.0)
    assert np.array_equal(curves.feet, before)
    assert np.ptp(curves.heading) == 0
