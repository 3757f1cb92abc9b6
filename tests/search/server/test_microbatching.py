"""Micro-batching: queued requests are processed together, and no request waits for others."""

from __future__ import annotations

import asyncio
import threading
from collections.abc import Sequence

import pytest

from search.server.microbatching import MicroBatcher, ServerBusy


def test_items_queued_while_a_batch_is_processed_are_the_next_batch():
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
        first = asyncio.ensure_future(batcher.submit(1))
        await asyncio.to_thread(begun.wait, 10)
        rest = [asyncio.ensure_future(batcher.submit(item)) for item in (2, 3, 4)]
        await asyncio.sleep(0)
        go_on.set()
        answers = await asyncio.gather(first, *rest)
        batcher.close()
        assert (batcher.batches, batcher.items) == (2, 4)
        return answers

    assert asyncio.run(asked()) == [10, 20, 30, 40]
    assert batches == [[1], [2, 3, 4]]


def test_one_result_may_be_an_exception_and_the_others_not():
    def answer(items: Sequence[int]) -> list[int | Exception]:
        return [ValueError("odd") if item % 2 else item for item in items]

    async def asked() -> list[object]:
        batcher: MicroBatcher[int, int] = MicroBatcher(answer)
        answers = await asyncio.gather(*(batcher.submit(item) for item in range(4)), return_exceptions=True)
        batcher.close()
        return [str(answer) for answer in answers]

    assert asyncio.run(asked()) == ["0", "odd", "2", "odd"]


def test_a_batch_that_raises_fails_all_its_items_and_the_next_is_processed():
    def answer(items: Sequence[int]) -> list[int]:
        return [1 // item for item in items]

    async def asked() -> int:
        batcher: MicroBatcher[int, int] = MicroBatcher(answer)
        with pytest.raises(ZeroDivisionError):
            await batcher.submit(0)
        found = await batcher.submit(1)
        batcher.close()
        return found

    assert asyncio.run(asked()) == 1


def test_a_full_queue_rejects():
    hold = threading.Event()

    def answer(items: Sequence[int]) -> list[int]:
        hold.wait(10)
        return list(items)

    async def asked() -> None:
        batcher: MicroBatcher[int, int] = MicroBatcher(answer, max_queue=2)
        asking = [asyncio.ensure_future(batcher.submit(item)) for item in range(40)]
        await asyncio.sleep(0.2)
        refused = [task for task in asking if task.done() and isinstance(task.exception(), ServerBusy)]
        hold.set()
        await asyncio.gather(*asking, return_exceptions=True)
        batcher.close()
        assert len(refused) >= 36

    asyncio.run(asked())
