"""Files of every kind that were changed at random; `python -m benchmarks.robustness mutations` tries 5,000."""

import sys
from pathlib import Path

import pytest

from tests.robustness.example_files import examples, write

pytest.importorskip("pxr", reason="usd-core is not installed")
pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="limits and /proc")


@pytest.mark.parametrize("kind", examples())
def test_every_example_can_be_read(tmp_path: Path, kind: str) -> None:
    from tests.robustness.mutations import _read

    _read(write(examples()[kind], tmp_path))


@pytest.mark.slow
def test_a_file_that_was_changed_at_random_gives_motions_or_a_reason_in_bounded_time_and_memory() -> None:
    from tests.robustness.mutations import run

    assert [(seed, *found) for seed, found in enumerate(run(range(400))) if found[1]] == []
