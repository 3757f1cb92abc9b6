"""A disk that fails at some steps; `python -m benchmarks.robustness faults` lets each step fail once."""

import shutil
import sys
from pathlib import Path

import pytest

from tests.robustness.faults import TASKS, run

pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(sys.platform != "linux" or shutil.which("cc") is None, reason="a C compiler on Linux"),
]


def test_a_disk_that_fails_leaves_old_files_and_a_sound_library_and_the_next_run_ends(tmp_path: Path) -> None:
    trials = list(run(tmp_path, 140))
    assert {trial["task"] for trial in trials} == set(TASKS)
    assert [trial for trial in trials if trial["wrong"]] == []
