"""Stored poses: within a millimetre, readable in part, and never trusted."""

import struct
import zlib

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
    # Far from the origin float32 itself is coarser than a step.
    error = 0.51 * STEP + 2 * np.spacing(np.float32(abs(far) + 40))
    assert np.abs(unpack(pack(joints)) - joints).max() <= error


def test_a_figure_that_flies_a_hundred_metres_is_as_exact_and_not_twice_as_large():
    standing = moving(4, CHUNK / 20)
    joints = (standing + np.linspace(0, 100, CHUNK)[:, None, None]).astype(np.float32)
    assert np.abs(unpack(pack(joints)) - joints).max() < 0.6 * STEP
    assert len(pack(joints)) < 2 * len(pack(standing.astype(np.float32)))


@pytest.mark.parametrize("far", [1e2, 1e5, 1e6, 1e8, 1e15, 1e38])
@pytest.mark.parametrize("where", [np.s_[60], np.s_[60, 3], np.s_[60, 3, 1], np.s_[0], np.s_[-1]])
def test_an_absurd_frame_makes_no_other_less_exact(far, where):
    joints = moving(5, CHUNK / 20).astype(np.float32)
    whole = np.ones(len(joints), bool)
    whole[where[0] if isinstance(where, tuple) else where] = False
    joints[where] = far
    back = unpack(pack(joints))
    assert np.abs(back - joints)[whole].max() < 0.6 * STEP
    assert np.allclose(back, joints, rtol=1e-6, atol=STEP)


def test_poses_of_earlier_versions_are_read():
    joints = moving(6, CHUNK / 20).astype(np.float32)
    assert struct.unpack_from("<Id", pack(joints)) == (CHUNK, STEP)
    steps, step, origin = np.rint(joints / 0.01).astype("<i2").reshape(CHUNK, -1), 0.01, (1.0, 2.0, 3.0)
    planes = np.diff(steps, axis=0, prepend=0 * steps[:1]).view(np.uint8).reshape(-1, 2).T
    coarse = struct.pack("<I4d", CHUNK, step, *origin) + zlib.compress(planes.tobytes())
    assert np.abs(unpack(coarse) - joints - origin).max() < 0.51 * step


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
