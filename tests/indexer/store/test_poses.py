"""Stored poses: within a millimetre, readable in part, and never trusted."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from encoders.errors import LibraryDamaged
from indexer.store.poses import CHUNK, STEP, pack, pack_all, unpack
from tests.indexer.folders import moving


@settings(deadline=None, max_examples=40)
@given(st.integers(0, 999), st.integers(1, CHUNK), st.floats(-5e4, 5e4), st.floats(0, 3))
def test_poses_come_back_to_within_a_millimetre(seed, frames, far, speed):
    joints = moving(seed, CHUNK / 20)[:frames]
    joints[..., 0] += speed * np.arange(frames)[:, None] / 20
    joints = (joints + np.array([far, 0, -far])).astype(np.float32)
    step = max(STEP, np.ptp(joints, axis=(0, 1)).max() / 65_000)
    # Far from the origin float32 itself is coarser than a step.
    error = 0.51 * step + 2 * np.spacing(np.float32(abs(far) + 40))
    assert np.abs(unpack(pack(joints)) - joints).max() <= error
    assert step < 1e-3


def test_a_figure_that_flies_a_hundred_metres_stays_within_a_millimetre():
    joints = (moving(4, CHUNK / 20) + np.linspace(0, 100, CHUNK)[:, None, None]).astype(np.float32)
    assert np.abs(unpack(pack(joints)) - joints).max() < 1e-3


def test_a_long_motion_is_cut_into_chunks_of_ten_seconds():
    joints = moving(1, 25).astype(np.float32)
    chunks = pack_all(joints)
    assert [len(unpack(chunk)) for chunk in chunks] == [200, 200, 100]
    assert np.abs(np.concatenate([unpack(chunk) for chunk in chunks]) - joints).max() < 1e-3


def test_poses_are_stored_small():
    joints = moving(2, 10).astype(np.float32)
    assert len(pack(joints)) < joints.nbytes / 4


@pytest.mark.parametrize("damage", [lambda b: b[:20], lambda b: b[:-9], lambda b: b"", lambda b: b[:40] + b[9:]])
def test_damaged_poses_are_an_error(damage):
    with pytest.raises(LibraryDamaged, match="poses are damaged"):
        unpack(damage(pack(moving(3).astype(np.float32))))


def test_a_header_cannot_ask_for_more_than_a_chunk():
    blob = bytearray(pack(moving(3).astype(np.float32)))
    blob[:4] = (2**31).to_bytes(4, "little")
    with pytest.raises(LibraryDamaged):
        unpack(bytes(blob))
