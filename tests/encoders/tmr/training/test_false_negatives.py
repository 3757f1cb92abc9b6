"""The false-negative mask: by what clips are known to show, synthetic and real ones."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

pytest.importorskip("torch")
pytestmark = pytest.mark.torch

from encoders.tmr.training.false_negatives import REAL, SYNTHETIC, FalseNegativeMask, similar_sentences  # noqa: E402
from encoders.tmr.training.pairs import Pair, PairStore  # noqa: E402
from encoders.tmr.training.recipe import Recipe  # noqa: E402

NOTHING = np.zeros((1, 1), np.float32)
CLIPS = {
    "walks slowly": {"walk", "walk.direction=forward", "walk.speed=slow"},
    "walks backwards": {"walk", "walk.direction=backward"},
    "kicks": {"kick", "kick.side=left"},
}


def masked(real_facts: set[str] | None, meaning: set[str], *, typical: bool = True) -> np.ndarray:
    """Which captions, of the synthetic clips and then of the real one, are masked for which motions."""
    synthetic = PairStore(Pair(NOTHING, (caption,), (frozenset(f),), frozenset(f)) for caption, f in CLIPS.items())
    stated = None if real_facts is None else frozenset(real_facts)
    real = PairStore([Pair(NOTHING, ("a real one",), None if stated is None else (frozenset(meaning),), stated)])
    unlike = SimpleNamespace(sentences=np.eye(4, dtype=np.float32))
    mask = FalseNegativeMask([synthetic, real], unlike, Recipe(typical=typical))
    picks = [*((SYNTHETIC, i) for i in range(3)), (REAL, 0)]
    return mask(picks, [0] * 4, range(4), [*CLIPS, "a real one"])


def test_a_real_walk_is_no_negative_for_what_may_be_true_of_it() -> None:
    ignored = masked({"walk", "walk.direction=forward"}, {"walk"})
    assert ignored[:3, 3].tolist() == [True, False, False], "slowly may be; backwards and kicking are not"


def test_what_was_said_of_a_real_walk_is_no_negative_for_synthetic_ones() -> None:
    said = {"walk", "walk.direction=forward"}, {"walk"}
    assert masked(*said)[3, :3].tolist() == [True, False, False], "plainly said: not of who walks backwards"
    assert masked(*said, typical=False)[3, :3].tolist() == [True, True, False]


def test_of_real_clips_without_facts_only_similar_captions_are_masked() -> None:
    assert np.array_equal(masked(None, set()), np.eye(4, dtype=bool))


def test_similarity_is_on_the_scale_of_the_paper() -> None:
    sentences = np.array([[1.0, 0.0], [0.61, np.sqrt(1 - 0.61**2)], [0.0, -1.0]], np.float32)
    assert similar_sentences(sentences, 0.8).tolist() == [[False, True, False], [True, False, False], [False] * 3]
    assert not similar_sentences(sentences, 0.81).any()
