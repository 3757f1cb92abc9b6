"""Packed training pairs: nothing is lost, and what looks alike but conflicts is known."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from encoders.errors import MotionSeekError
from encoders.tmr.training.pairs import Pair, PairStore, sides_conflict

SYNTHETIC = Pair(
    np.arange(12.0).reshape(4, 3),
    ("walks", "a person walks left"),
    (frozenset({"walk"}), frozenset({"walk", "walk.direction=left"})),
    frozenset({"walk", "walk.direction=left"}),
    ("", "a person walks right"),
)
REAL = Pair(np.ones((2, 3)), ("a man strolls", "walks"))


def same(a: Pair, b: Pair) -> bool:
    return np.array_equal(a.features, b.features) and vars(a) | {"features": 0} == vars(b) | {"features": 0}


def test_pairs_come_out_as_they_went_in() -> None:
    store = PairStore([SYNTHETIC, REAL])
    assert len(store) == 2
    assert store.lengths.tolist() == [4, 2]
    assert all(map(same, store.pairs(), [SYNTHETIC, REAL]))
    assert np.array_equal(store.motion(1), REAL.features)


def test_a_sentence_is_kept_once() -> None:
    sentences = {*SYNTHETIC.captions, SYNTHETIC.hard_negatives[1], *REAL.captions}
    assert sorted(PairStore([SYNTHETIC, REAL]).texts) == sorted(sentences)


def test_a_store_survives_its_file(tmp_path: Path) -> None:
    PairStore([SYNTHETIC, REAL]).save(tmp_path / "pairs.npz")
    assert [path.name for path in tmp_path.iterdir()] == ["pairs.npz"]
    assert all(map(same, PairStore.load(tmp_path / "pairs.npz").pairs(), [SYNTHETIC, REAL]))


def test_a_file_of_older_pairs_is_refused_if_it_would_be_read_wrongly(tmp_path: Path) -> None:
    store = PairStore([SYNTHETIC, REAL])
    store.hard_negatives = [[], []]
    store.save(tmp_path / "none.npz")
    assert all(min(row) < 0 for row in PairStore.load(tmp_path / "none.npz").hard_negatives), "none are still none"
    store.hard_negatives = [[0] * (len(SYNTHETIC.captions) + 1), []]
    store.save(tmp_path / "old.npz")
    with pytest.raises(MotionSeekError, match="delete it"):
        PairStore.load(tmp_path / "old.npz")


def test_stores_are_joined_in_order() -> None:
    joined = PairStore.joined([PairStore([REAL]), PairStore([]), PairStore([SYNTHETIC, REAL])])
    assert all(map(same, joined.pairs(), [REAL, SYNTHETIC, REAL]))
    assert len(joined) == 3


def test_an_empty_store_can_be_saved(tmp_path: Path) -> None:
    PairStore([]).save(tmp_path / "none.npz")
    assert len(PairStore.load(tmp_path / "none.npz")) == 0


@pytest.mark.parametrize(
    ("a", "b", "conflict"),
    [
        ("kicks with the left leg", "kicks with the right leg", True),
        ("kicks with the left leg", "kicks", False),
        ("steps left, then right", "steps right", False),
        ("steps left, then right", "steps left, then right", False),
        ("kicks", "punches", False),
    ],
)
def test_only_left_conflicts_with_only_right(a: str, b: str, conflict: bool) -> None:
    assert sides_conflict([a, b]).tolist() == [[False, conflict], [conflict, False]]
