"""The vector indexes of a library are caught up with it at the cost of what changed."""

import pytest

from indexer.store.stored_library import StoredLibrary
from indexer.vectors.sync import CLIPS, WINDOWS


@pytest.mark.parametrize("kind", [CLIPS, WINDOWS], ids=lambda kind: kind.name)
def test_what_changed_is_found_by_its_generation_and_nothing_else_is_read(tmp_path, kind):
    with StoredLibrary.open(tmp_path, create=True) as library:
        plan = [row[3] for row in library.connection.execute(f"EXPLAIN QUERY PLAN {kind.query}", (1, 7))]
    assert not [step for step in plan if "SCAN" in step or "TEMP B-TREE" in step], plan
    assert any("idx_clips_generation (generation>?)" in step for step in plan), plan
