"""Joints on the wire."""

from __future__ import annotations

import struct

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from encoders.motion import Motion
from search.export import joints_binary


@settings(max_examples=30, deadline=None)
@given(st.integers(1, 40), st.floats(0, 5000), st.floats(0.001, 30), st.integers(0, 2**32 - 1))
def test_what_is_packed_comes_back_to_a_tenth_of_a_millimetre(frames, far, size, seed):
    rng = np.random.default_rng(seed)
    near = rng.uniform(-size, size, (frames, 22, 3))
    motion = Motion((near + np.array([far, 1, -far])).astype(np.float32), 20.0)
    again, start = joints_binary.unpack(joints_binary.pack(motion, 2.5))
    assert (start, again.fps, again.joints.shape) == (2.5, 20.0, motion.joints.shape)
    step = max(0.0002, 2 * size / 65_000)
    np.testing.assert_allclose(again.joints, motion.joints, atol=step + far * 1e-6)


def test_the_header_is_as_documented():
    data = joints_binary.pack(Motion(np.tile(np.array([1, 2, 3], np.float32), (3, 22, 1)), 30.0), 1.5)
    magic, frames, count, fps, start, step, x, y, z, nothing = struct.unpack_from("<4sIIfff3fI", data)
    assert (magic, frames, count, fps, start, nothing) == (b"MSJ1", 3, 22, 30.0, 1.5, 0)
    assert step == pytest.approx(0.0002)
    assert (x, y, z) == (1.0, 2.0, 3.0)
    assert len(data) == 40 + 3 * 22 * 3 * 2


def test_other_bytes_are_refused():
    with pytest.raises(ValueError, match="MSJ1"):
        joints_binary.unpack(b"X" * 80)
