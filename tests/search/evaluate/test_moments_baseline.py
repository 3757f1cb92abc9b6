"""The paper's way: one window size, every frame, the best place."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from encoders.bundle.bundle import Bundle
from search.evaluate.moments_baseline import best_of, best_place, slide
from tests.search.conftest import made_motion


@pytest.fixture(scope="module")
def bundle(tiny_bundle: Path) -> Bundle:
    return Bundle.load(tiny_bundle)


@pytest.mark.parametrize("size", [20, 40, 60])
def test_a_window_begins_at_every_frame(bundle: Bundle, size: int) -> None:
    windows = slide(bundle, made_motion(6, 0), bundle.encode_texts(["a person walks"]), size)
    assert np.allclose(np.diff(windows.starts), 1 / 20)
    assert np.allclose(windows.lengths, size / 20)
    assert windows.starts[0] == 0
    assert windows.ends[-1] == pytest.approx(6, abs=0.1)


def test_the_answer_is_the_most_similar_window_of_all_sizes(bundle: Bundle) -> None:
    motion, queries = made_motion(6, 1), bundle.encode_texts(["a person waves", "jumps"])
    for i, found in enumerate(best_of(bundle, motion, queries)):
        for size in (20, 40, 60):
            windows = slide(bundle, motion, queries, size)
            assert found[size] == best_place(windows, i)
            assert found[size].score == pytest.approx(float(windows.scores[i].max()))
        assert found[0].score == max(found[size].score for size in (20, 40, 60))


def test_a_motion_shorter_than_the_window_is_taken_whole(bundle: Bundle) -> None:
    windows = slide(bundle, made_motion(1.5, 2), bundle.encode_texts(["walks"]), 60)
    assert len(windows.starts) >= 1
    assert windows.ends.max() <= 1.6
