"""Readers during writes, for 15 seconds; `python -m benchmarks.robustness readers` does it for ten minutes."""

from pathlib import Path

import pytest

pytest.importorskip("fastapi")
pytest.importorskip("httpx")

from tests.robustness.readers import run


@pytest.mark.slow
def test_who_reads_while_others_write_meets_no_error_and_no_mixed_generation(tmp_path: Path) -> None:
    found = run(tmp_path, 15)
    assert {name: error for name, (_, error) in found.items() if error} == {}
    assert all(steps for steps, _ in found.values()), found
