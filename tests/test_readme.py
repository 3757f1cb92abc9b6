"""The README's commands and Python run as they stand there."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.conftest import ROOT
from tests.documents import run_page


@pytest.mark.slow
def test_every_code_block_runs(documented: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    run_page(ROOT / "README.md", documented, monkeypatch)
    made = {path.name for path in (documented / "my_mocap").iterdir()}
    assert {"sits.png", "kick.gif"} <= made
