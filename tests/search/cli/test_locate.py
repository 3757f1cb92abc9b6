"""The library that a command means when none is named."""

from __future__ import annotations

from pathlib import Path

import pytest

from encoders.errors import LibraryNotFound
from search.cli.locate import VARIABLE, locate


def test_the_nearest_library_at_or_above_a_folder_is_meant(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv(VARIABLE, raising=False)
    inner = tmp_path / "takes" / "day 1"
    inner.mkdir(parents=True)
    with pytest.raises(LibraryNotFound):
        locate(start=inner)
    (tmp_path / ".motionseek").mkdir()
    assert locate(start=inner) == tmp_path
    (tmp_path / "takes" / "library.sqlite").touch()  # a folder that is a library itself
    assert locate(start=inner) == tmp_path / "takes"
    monkeypatch.setenv(VARIABLE, "elsewhere")
    assert locate(start=inner) == Path("elsewhere")
    assert locate(tmp_path, start=inner) == tmp_path
