"""One question, one snapshot: what a writer commits while a question is answered changes nothing in its answer."""

from __future__ import annotations

import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from encoders.bundle.bundle import Bundle
from indexer.ingest import indexing
from indexer.store.stored_library import StoredLibrary
from search.hits import Hits
from search.library import Library
from tests.search.conftest import made_motion

#: Statements between which another process may commit.
STEPS = ("clip", "clips_by_id", "captions", "windows", "ids", "caption_vectors", "nearest_clips", "nearest_windows")
QUESTIONS: dict[str, Callable[[Library], Any]] = {
    "search": lambda library: library.search("walks", 5),
    "search, filtered": lambda library: library.search("walks", 5, format="npy"),
    "moments": lambda library: library.moments("walks", k=5),
    "moments of a clip": lambda library: library.moments("walks", "take 2.npy"),
    "steps": lambda library: library.moments("walks, then sits down", k=5),
    "similar": lambda library: library.similar("take 2.npy", 5),
    "similar moments": lambda library: library.similar("take 2.npy", 5, 1, 3, moments=True),
    "describe": lambda library: library.describe("take 2.npy"),
    "segment": lambda library: [(s.start, s.end, s.label) for s in library.segment("take 2.npy", captions=True)],
    "motion": lambda library: library.motion(library.find("take 2.npy").id).joints.tobytes(),
}


@pytest.fixture
def folder(indexed: Path, tmp_path: Path) -> Path:
    """A copy of the indexed takes."""
    return Path(shutil.copytree(indexed, tmp_path / "takes"))


def shown(answer: Any) -> Any:
    """An answer without what became of its files, which is looked up on disk."""
    return [hit.document() | {"stale": None} for hit in answer] if isinstance(answer, Hits) else answer


@pytest.mark.parametrize("question", QUESTIONS.values(), ids=QUESTIONS.keys())
@pytest.mark.parametrize("step", STEPS)
def test_a_commit_between_two_statements_changes_no_answer(
    folder: Path, tiny_bundle: Path, monkeypatch: pytest.MonkeyPatch, question: Callable[[Library], Any], step: str
) -> None:
    bundle = Bundle.load(tiny_bundle, threads=1)
    with Library.open(folder, bundle=bundle) as library:
        expected = shown(question(library))
        real, committed = getattr(StoredLibrary, step), []

        def meanwhile(self: StoredLibrary, *args: Any, **options: Any) -> Any:
            found = real(self, *args, **options)
            if not committed:
                committed.append(True)
                (folder / "take 1.npy").unlink()
                np.save(folder / "take 2.npy", made_motion(3.0, 50).joints)
                indexing.index(folder, bundle=bundle, jobs=1)
            return found

        monkeypatch.setattr(StoredLibrary, step, meanwhile)
        assert shown(question(library)) == expected
        monkeypatch.undo()
        if committed:
            assert "take 1.npy" not in [clip.path for clip in library.clips()]
