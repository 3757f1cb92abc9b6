"""Roots have names of their own, so that a server need not show absolute paths."""

from __future__ import annotations

from pathlib import Path

from indexer.store.clips import root_names


def test_roots_of_one_folder_name_get_different_names() -> None:
    roots = {1: Path("/a/takes"), 2: Path("/b/takes"), 3: Path("/c/takes (2)"), 4: Path("/c/takes"), 5: Path("/")}
    assert root_names(roots) == {1: "takes", 2: "takes (2)", 3: "takes (2) (2)", 4: "takes (3)", 5: "root"}
