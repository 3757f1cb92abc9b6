"""Where tests find data that does not travel with the project; without it they skip."""

from __future__ import annotations

import shutil
from collections.abc import Iterator
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


@pytest.fixture(scope="session")
def indexed_demo(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with `my_mocap/`: the demo's clips and a long take, indexed with the default model."""
    import motionseek
    from search.export import bvh_writer

    folder = tmp_path_factory.mktemp("documented")
    shutil.copytree(ROOT / "search" / "demo_data", folder / "my_mocap")
    with (folder / "my_mocap" / "long_take.bvh").open("wb") as file:
        bvh_writer.write(file, motionseek.load(folder / "my_mocap" / "session_01.amc", fps=30))
    motionseek.index(folder / "my_mocap", jobs=1)
    return folder


@pytest.fixture
def documented(indexed_demo: Path) -> Iterator[Path]:
    """The folder in which a document's commands begin; what they write is removed."""
    before = set(indexed_demo.rglob("*"))
    yield indexed_demo
    for path in set(indexed_demo.rglob("*")) - before:
        if path.is_file() and ".motionseek" not in path.parts:
            path.unlink()


@pytest.fixture(autouse=True)
def models(monkeypatch: pytest.MonkeyPatch, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder of the user's models: one that does not exist until a test writes there."""
    folder: Path = tmp_path_factory.getbasetemp() / "models" / "none"
    monkeypatch.setenv("MOTIONSEEK_MODELS", str(folder))
    return folder
