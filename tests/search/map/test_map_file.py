"""The cached map of a library."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from search.map import map_file
from search.map.layout import LibraryMap, make_map


def library_map(generation: int) -> LibraryMap:
    vectors = np.eye(5, 8, dtype=np.float32)
    return make_map(generation, np.arange(5), vectors, ["a", "b"], vectors[:2])


def test_a_map_is_cached_for_its_generation_alone(tmp_path: Path) -> None:
    folder = tmp_path / "previews"
    map_file.save(folder, library_map(3))
    loaded = map_file.load(folder, 3)
    assert loaded is not None
    assert loaded.document() == library_map(3).document()
    assert map_file.load(folder, 4) is None


def test_a_newer_map_replaces_the_older(tmp_path: Path) -> None:
    folder = tmp_path / "previews"
    map_file.save(folder, library_map(3))
    map_file.save(folder, library_map(4))
    assert [path.name for path in folder.iterdir()] == ["map.4.npz"]


def test_a_damaged_file_is_no_map(tmp_path: Path) -> None:
    map_file.save(tmp_path / "previews", library_map(4))
    (tmp_path / "previews" / "map.4.npz").write_bytes(b"damaged")
    assert map_file.load(tmp_path / "previews", 4) is None
