"""Hits of a file that is no longer what was indexed say so."""

from __future__ import annotations

import os
import shutil
from pathlib import Path

import numpy as np
import pytest

from encoders.bundle.bundle import Bundle
from search.library import Library
from tests.search.conftest import Run, made_motion


@pytest.fixture
def folder(indexed: Path, tmp_path: Path) -> Path:
    """A copy of the indexed takes in which one file has changed, one has gone, and one has only been touched."""
    folder = Path(shutil.copytree(indexed, tmp_path / "takes"))
    np.save(folder / "take 0.npy", made_motion(3.0, 50).joints)
    (folder / "take 1.npy").unlink()
    os.utime(folder / "take 2.npy")
    return folder


def test_hits_say_what_became_of_their_files(folder: Path, tiny_bundle: Path) -> None:
    with Library.open(folder, bundle=Bundle.load(tiny_bundle, threads=1)) as library:
        stale = {hit.path: hit.stale for hit in library.search("walks", 10)}
        assert stale == {hit.path: hit.stale for hit in library.moments("walks", k=50)}
    assert stale == {
        "take 0.npy": "has changed since it was indexed",
        "take 1.npy": "is gone since it was indexed",
        "take 2.npy": "has changed since it was indexed",  # its content is not compared
        "take 3.npy": "",
        "deep er/bücken.bvh": "",
    }


def test_the_command_line_says_so_on_stderr(run: Run, folder: Path) -> None:
    found = run("search", "walks", "--library", folder)
    assert "take 1.npy is gone since it was indexed" in found.err
    assert "is gone" not in found.out
    hits = run("search", "walks", "--library", folder, "--json").document["hits"]
    assert {hit["path"]: hit["stale"] for hit in hits}["take 3.npy"] is None
