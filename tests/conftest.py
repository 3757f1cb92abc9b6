"""Where tests find data that does not travel with the project; without it they skip."""

from __future__ import annotations

from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parent.parent


def _folder_or_skip(folder: Path) -> Path:
    if not folder.is_dir():
        pytest.skip(f"{folder.name} is not here")
    return folder


@pytest.fixture(scope="session")
def shared() -> Path:
    """The read-only folder beside the checkout: golden numbers and data."""
    return _folder_or_skip(ROOT.parent / "shared")


@pytest.fixture(scope="session")
def golden(shared: Path) -> Path:
    """Golden numbers made by running published code."""
    return _folder_or_skip(shared / "fixtures")


@pytest.fixture(scope="session")
def mocap() -> Path:
    """Real motion capture in many rigs, unpacked."""
    return _folder_or_skip(ROOT / "data" / "mocap")


@pytest.fixture(scope="session")
def tiny_bundle() -> Path:
    """The folder of a whole bundle with random weights: it runs everything and means nothing."""
    return ROOT / "tests" / "data" / "tiny_bundle"
