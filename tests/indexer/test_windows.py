"""The window grid: every second of a clip is covered, nothing outside it."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from encoders.bundle.windows import LENGTHS, ends_of, first_rows, grid


@given(st.integers(1, 3000), st.integers(1, 200))
def test_windows_cover_a_clip_and_end_flush_with_it(rows, size):
    starts = first_rows(rows, size)
    assert starts[0] == 0
    assert max(starts[-1] + size, rows) == max(rows, size)
    assert (np.diff(starts) <= max(size // 4, 1)).all()
    assert (np.diff(starts) > 0).all()


def test_a_clip_of_seven_seconds_has_windows_of_every_length():
    windows = grid(70, 10.0)
    assert list(windows) == list(LENGTHS)
    assert windows[1.6][1] == 16
    assert windows[1.6][0].tolist() == [*range(0, 53, 4), 54]
    assert windows[6.4][0].tolist() == [0, 6]


def test_a_clip_shorter_than_all_lengths_is_one_window():
    assert {length: (starts.tolist(), size) for length, (starts, size) in grid(9, 10.0).items()} == {1.6: ([0], 9)}


def test_a_window_never_ends_after_its_clip():
    assert ends_of(np.array([0, 0.4], np.float32), 1.6, 0.9).tolist() == [np.float32(0.9)] * 2
