"""Batching: company is taken where there is some, and never waited for."""

from __future__ import annotations

import asyncio
import threading
from collections.abc import Sequence

import pytest

from search.server.cache import Cache
from search.server.microbatching import MicroBatcher, ServerBusy
from search.server.snapshot_library import SearchRequest, SnapshotLibrary


def test_what_comes_while_a_batch_is_answered_is_the_next_batch():
    begun, go_on = threading.Event(), threading.Event()
    batches: list[list[int]] = []

    def answer(items: Sequence[int]) -> list[int]:
        batches.append(list(items))
        if len(batches) == 1:
            begun.set()
            go_on.wait(10)
        return [item * 10 for item in items]

    async def asked() -> list[int]:
        batcher: MicroBatcher[int, int] = MicroBatcher(answer)
        first = asyncio.ensure_future(batcher.ask(1))
        await asyncio.to_thread(begun.wait, 10)
        rest = [asyncio.ensure_future(batcher.ask(item)) for item in (2, 3, 4)]
        await asyncio.sleep(0)
        go_on.set()
        answers = await asyncio.gather(first, *rest)
        batcher.close()
        assert (batcher.batches, batcher.items) == (2, 4)
        return answers

    assert asyncio.run(asked()) == [10, 20, 30, 40]
    assert batches == [[1], [2, 3, 4]]


def test_one_answer_may_be_an_error_and_the_others_not():
    def answer(items: Sequence[int]) -> list[int | Exception]:
        return [ValueError("odd") if item % 2 else item for item in items]

    async def asked() -> list[object]:
        batcher: MicroBatcher[int, int] = MicroBatcher(answer)
        answers = await asyncio.gather(*(batcher.ask(item) for item in range(4)), return_exceptions=True)
        batcher.close()
        return [str(answer) for answer in answers]

    assert asyncio.run(asked()) == ["0", "odd", "2", "odd"]


def test_a_batch_that_fails_fails_all_and_the_next_is_answered():
    def answer(items: Sequence[int]) -> list[int]:
        return [1 // item for item in items]

    async def asked() -> int:
        batcher: MicroBatcher[int, int] = MicroBatcher(answer)
        with pytest.raises(ZeroDivisionError):
            await batcher.ask(0)
        found = await batcher.ask(1)
        batcher.close()
        return found

    assert asyncio.run(asked()) == 1


def test_too_many_that_wait_are_refused():
    hold = threading.Event()

    def answer(items: Sequence[int]) -> list[int]:
        hold.wait(10)
        return list(items)

    async def asked() -> None:
        batcher: MicroBatcher[int, int] = MicroBatcher(answer, most_waiting=2)
        asking = [asyncio.ensure_future(batcher.ask(item)) for item in range(40)]
        await asyncio.sleep(0.2)
        refused = [task for task in asking if task.done() and isinstance(task.exception(), ServerBusy)]
        hold.set()
        await asyncio.gather(*asking, return_exceptions=True)
        batcher.close()
        assert len(refused) >= 36

    asyncio.run(asked())


def test_a_batch_of_searches_gives_what_each_alone_gives(indexed, bundle):
    asked = [
        SearchRequest("a person walks", 3),
        SearchRequest("waves", 2, (("min_duration", 5.0),)),
        SearchRequest(" , ", 3),
    ]
    with SnapshotLibrary.open(indexed, bundle=bundle) as library:
        walks, waves, nothing = library.search_all(asked)
        assert walks == library.search("a person walks", 3)
        assert waves == library.search("waves", 2, min_duration=5.0)
        assert "empty" in str(nothing)


def test_the_cache_forgets_what_was_used_least_lately():
    cache: Cache[int] = Cache(2)
    cache.put("a", 1)
    cache.put("b", 2)
    cache.get("a")
    cache.put("c", 3)
    assert (cache.get("a"), cache.get("b"), cache.get("c"), len(cache)) == (1, None, 3, 2)
    assert cache.get_or("a", lambda: 9) == 1
    assert cache.get_or("d", lambda: 9) == 9
