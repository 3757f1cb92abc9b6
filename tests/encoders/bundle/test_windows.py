"""The window grid: every second of a clip is covered, nothing outside it."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from encoders.bundle.bundle import Bundle
from encoders.bundle.windows import LENGTHS, encode_grids, ends_of, grid, window_starts


@given(st.integers(1, 3000), st.integers(1, 200), st.integers(0, 250))
def test_windows_start_at_the_first_frame_and_end_with_the_last(frames, length, stride):
    starts = window_starts(frames, length, stride)
    assert starts[0] == 0
    assert starts[-1] == max(frames - length, 0)
    assert (np.diff(starts) <= max(stride, 1)).all()
    assert (np.diff(starts) > 0).all()


def test_only_the_last_window_leaves_the_stride():
    assert window_starts(25, 10, 4).tolist() == [0, 4, 8, 12, 15]
    assert window_starts(18, 10, 4).tolist() == [0, 4, 8]
    assert window_starts(3, 10).tolist() == [0]


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


def test_the_windows_of_many_clips_are_those_of_each(tiny_bundle):
    bundle = Bundle.load(tiny_bundle, threads=1)
    rng = np.random.default_rng(0)
    clips = [rng.standard_normal((frames, 96)).astype(np.float32) for frames in (9, 70, 40)]
    durations = [0.95, 7.0, 4.0]
    together = encode_grids(bundle, clips, durations)
    assert [[w.length for w in windows] for windows in together] == [[1.6], [1.6, 3.2, 6.4], [1.6, 3.2]]
    for rows, duration, windows in zip(clips, durations, together, strict=True):
        (alone,) = encode_grids(bundle, [rows], [duration])
        for ours, same in zip(windows, alone, strict=True):
            starts, size = grid(len(rows), bundle.fps)[ours.length]
            assert ours.starts == pytest.approx(starts / bundle.fps)
            assert ours.ends.max() == pytest.approx(duration)
            expected = bundle.encode_windows(rows, starts, size)
            assert np.abs(ours.vectors - expected).max() < 1e-3
            assert np.abs(ours.vectors - same.vectors).max() < 1e-3
    assert encode_grids(bundle, [], []) == []
