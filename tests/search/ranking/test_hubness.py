"""Sentences that lie near every motion give way to those that fit this one."""

from __future__ import annotations

import numpy as np
import pytest

from search.ranking.hubness import hubness_penalty
from tests.search.fakes import MeanEncoder


def unit(*rows: list[float]) -> np.ndarray:
    """Rows scaled to length one."""
    array = np.array(rows, np.float32)
    return array / np.linalg.norm(array, axis=1, keepdims=True)


RNG = np.random.default_rng(0)
MOTIONS = unit(*(np.array([1.0, 0.0, 0.0, 0.0]) + 0.3 * RNG.normal(size=(200, 4))))
COMMON, OTHER = unit([1.0, 0.0, 0.0, 0.0], [0.6, 0.0, 0.8, 0.0])


def bundle(motions: np.ndarray | None) -> MeanEncoder:
    return MeanEncoder(None if motions is None else {"motions": motions})


def test_what_is_near_everything_no_longer_comes_first() -> None:
    motion = unit([0.95, 0.0, 0.4, 0.0])[0]
    cosines = np.stack([COMMON, OTHER]) @ motion
    assert cosines[0] > cosines[1]
    adjusted = cosines - hubness_penalty(bundle(MOTIONS), np.stack([COMMON, OTHER]))
    assert adjusted[1] > adjusted[0]


def test_a_share_of_the_mean_of_the_thirty_nearest_is_taken() -> None:
    nearest = np.sort(MOTIONS @ OTHER)[-30:]
    assert hubness_penalty(bundle(MOTIONS), OTHER[None]) == pytest.approx([0.35 * nearest.mean()], abs=1e-6)


def test_few_motions_are_all_near() -> None:
    assert hubness_penalty(bundle(MOTIONS[:3]), OTHER[None]) == pytest.approx([0.35 * (MOTIONS[:3] @ OTHER).mean()])


def test_a_bundle_without_calibration_takes_nothing() -> None:
    assert hubness_penalty(bundle(None), MOTIONS).tolist() == [0.0] * 200
