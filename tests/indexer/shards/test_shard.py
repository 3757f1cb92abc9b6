"""Shards: every file has one, whoever asks, and few change hands when their number does."""

from __future__ import annotations

from collections import Counter
from unicodedata import normalize

import pytest

from encoders.errors import ArgumentError
from indexer.shards.shard import SLOTS, Shard, clip_number, slot_of

PATHS = [f"day {i % 40}/take {i}.bvh" for i in range(4000)]


def owners(count: int) -> dict[str, int]:
    """Path -> the one shard of so many that has it."""
    shards = [Shard(number, count) for number in range(1, count + 1)]
    found = {path: [shard.number for shard in shards if shard.has(path)] for path in PATHS}
    assert all(len(numbers) == 1 for numbers in found.values())
    return {path: numbers[0] for path, numbers in found.items()}


@pytest.mark.parametrize("count", [1, 2, 3, 8, 61])
def test_every_file_has_one_shard_and_all_have_about_as_many(count: int) -> None:
    counts = Counter(owners(count).values())
    assert len(counts) == count
    assert max(counts.values()) < 1.7 * len(PATHS) / count


def test_with_one_more_shard_only_the_new_one_takes_files_over() -> None:
    before, after = owners(4), owners(5)
    moved = [path for path in PATHS if before[path] != after[path]]
    assert {after[path] for path in moved} == {5}
    assert len(moved) < 0.3 * len(PATHS)


def test_the_slots_of_all_shards_are_all_slots() -> None:
    slots = [slot for number in range(1, 8) for slot in Shard(number, 7).slots]
    assert sorted(slots) == list(range(SLOTS))


def test_slot_and_number_of_a_name_never_change() -> None:
    """They are in collections that others have filled."""
    assert slot_of("fights/take_001.bvh") == 2511
    assert clip_number("mocap", "fights/take_001.bvh") == 5754039204037156
    name = "Größe.bvh"
    assert slot_of(normalize("NFD", name)) == slot_of(normalize("NFC", name))
    assert clip_number("r", normalize("NFD", name)) == clip_number("r", normalize("NFC", name))
    assert clip_number("a", "b/c.bvh") != clip_number("a/b", "c.bvh")
    assert 0 <= clip_number("mocap", "x") < 2**53


def test_a_shard_is_read_from_text() -> None:
    assert Shard.of("2/8") == Shard(2, 8)
    assert Shard.of(None).is_whole
    assert Shard.of("1/1").has("anything")
    assert str(Shard(2, 8)) == "2/8"


@pytest.mark.parametrize("given", ["0/4", "5/4", "1/0", "2", "2/8/1", "-1/4", "1/5000", "", 2, "a/b", "1 / 2"])
def test_anything_else_is_refused(given: object) -> None:
    with pytest.raises(ArgumentError, match="shard="):
        Shard.of(given)
