"""Synthetic clips of a run are kept and used again."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from encoders.corpus.language.held_out_sentences import HeldOutSentences
from encoders.tmr.training.dataset import synthetic_stores
from encoders.tmr.training.pairs import Pair, PairStore

PAIR = Pair(np.ones((5, 3), np.float32), ("a person walks",))


@pytest.mark.parametrize("name", ["synthetic-0000007.npz", "made-0000007.npz"])
def test_clips_of_a_run_are_used_again_also_under_their_former_name(tmp_path: Path, name: str) -> None:
    PairStore([PAIR]).save(tmp_path / name)
    store = synthetic_stores(tmp_path, 1, "body", (), HeldOutSentences(()), seed=7, jobs=1)
    assert len(store) == 1
    assert store.texts == ["a person walks"]
