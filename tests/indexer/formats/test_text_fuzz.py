"""Whatever stands in a BVH, AMC or ASF file: a take or a reason, in bounded time and memory."""

from __future__ import annotations

import tempfile
import time
from pathlib import Path

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from encoders.errors import UnreadableMotion
from indexer.formats.reading import read_takes
from tests.indexer.formats.test_amc import AMC, ASF
from tests.indexer.formats.test_bvh import ARM, long

#: What takes the place of some bytes of a file that is right.
PIECES = st.one_of(
    st.binary(max_size=8),
    st.sampled_from([b"{", b"}" * 50, b"OFFSET", b"CHANNELS 99999999999 ", b"\nMOTION\n", b"JOINT ", b"End Site {"]),
    st.sampled_from([b"1e999", b"nan", b"-inf", b",", b"1" * 5000, b" " * 5000, b"\0", b"Frames: 1e9", b"99999999999"]),
    st.sampled_from([b":bonedata", b"begin\n", b"end\n", b"dof rx ry", b"root", b"\n7\n", b":SAMPLES-PER-SECOND -1\n"]),
)
CHANGES = st.lists(st.tuples(st.floats(0, 1), st.integers(0, 40), PIECES), max_size=4)


def changed(data: bytes, changes: list[tuple[float, int, bytes]]) -> bytes:
    for place, length, piece in changes:
        at = int(place * len(data))
        data = data[:at] + piece + data[at + length :]
    return data


def check(folder: Path, name: str) -> None:
    began = time.monotonic()
    try:
        for take in read_takes(folder / name):
            assert np.isfinite(take.positions).all()
            assert take.positions.shape[1:] == take.rest.shape
            assert take.fps
    except UnreadableMotion:
        pass
    assert time.monotonic() - began < 5


@given(CHANGES, st.booleans())
@settings(max_examples=300, deadline=None, derandomize=True)
def test_any_bvh(changes: list[tuple[float, int, bytes]], is_long: bool) -> None:
    with tempfile.TemporaryDirectory() as folder:
        (Path(folder) / "a.bvh").write_bytes(changed((long() if is_long else ARM).encode(), changes))
        check(Path(folder), "a.bvh")


@given(CHANGES, CHANGES)
@settings(max_examples=300, deadline=None, derandomize=True)
def test_any_amc_and_asf(amc: list[tuple[float, int, bytes]], asf: list[tuple[float, int, bytes]]) -> None:
    with tempfile.TemporaryDirectory() as folder:
        (Path(folder) / "a.amc").write_bytes(changed(AMC.encode(), amc))
        (Path(folder) / "a.asf").write_bytes(changed(ASF.encode(), asf))
        check(Path(folder), "a.amc")
