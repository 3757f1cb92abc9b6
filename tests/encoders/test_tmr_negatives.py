"""Pairs of a batch that are no negatives: by what clips are known to show, real ones as well as made ones."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

pytest.importorskip("torch")
pytestmark = pytest.mark.torch

from encoders.tmr.training.false_negatives import FalseNegativeMask  # noqa: E402
from encoders.tmr.training.pairs import Pair, PairStore  # noqa: E402
from encoders.tmr.training.recipe import Recipe  # noqa: E402

NOTHING = np.zeros((1, 1), np.float32)
MADE = {
    "walks slowly": {"walk", "walk.direction=forward", "walk.speed=slow"},
    "walks backwards": {"walk", "walk.direction=backward"},
    "kicks": {"kick", "kick.side=left"},
}


def no_negatives(real_facts: set[str] | None, meaning: set[str], *, typical: bool = True) -> np.ndarray:
    """Which of the made clips' sentences, and then the real clip's, count neither way with which motions."""
    made = PairStore(Pair(NOTHING, (said,), (frozenset(f),), frozenset(f)) for said, f in MADE.items())
    told = None if real_facts is None else frozenset(real_facts)
    real = PairStore([Pair(NOTHING, ("a real one",), None if told is None else (frozenset(meaning),), told)])
    unlike = SimpleNamespace(sentences=np.eye(4, dtype=np.float32))
    judge = FalseNegativeMask(made, real, unlike, Recipe(typical=typical))  # type: ignore[arg-type]
    picks = [*((made, i) for i in range(3)), (real, 0)]
    return judge(picks, [0] * 4, range(4), [*MADE, "a real one"])


def test_a_real_walk_is_no_negative_for_what_may_be_true_of_it() -> None:
    ignored = no_negatives({"walk", "walk.direction=forward"}, {"walk"})
    assert ignored[:3, 3].tolist() == [True, False, False], "slowly may be; backwards and kicking are not"


def test_what_was_said_of_a_real_walk_is_no_negative_for_made_ones() -> None:
    said = {"walk", "walk.direction=forward"}, {"walk"}
    assert no_negatives(*said)[3, :3].tolist() == [True, False, False], "plainly said: not of who walks backwards"
    assert no_negatives(*said, typical=False)[3, :3].tolist() == [True, True, False]


def test_of_real_clips_nobody_understood_only_like_sentences_are_left_out() -> None:
    assert np.array_equal(no_negatives(None, set()), np.eye(4, dtype=bool))
