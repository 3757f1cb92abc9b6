"""Micro-batching: requests that arrive while others are processed are processed together.

There is no waiting time: a worker takes whatever has queued up while it was busy, so batches grow with the load and a
lone request is processed at once.
"""

from __future__ import annotations

import asyncio
import queue
import threading
from collections.abc import Callable, Sequence
from typing import Generic, TypeVar

Item = TypeVar("Item")
Result = TypeVar("Result")


class ServerBusy(Exception):
    """More requests are queued than can be processed in good time."""


class MicroBatcher(Generic[Item, Result]):
    """Processes items in batches, in threads of its own.

    Parameters
    ----------
    process : callable
        A batch -> a result, or an exception, for each item.
    workers : int
        Threads.
    max_batch : int
        Items of a batch; with larger ones the first item waits longer for the last.
    max_queue : int
        Items that may be queued before more are rejected.
    """

    def __init__(
        self,
        process: Callable[[Sequence[Item]], Sequence[Result | Exception]],
        *,
        workers: int = 1,
        max_batch: int = 8,
        max_queue: int = 512,
    ) -> None:
        self._process = process
        self._max_batch = max_batch
        self._max_queue = max_queue
        self._queue: queue.SimpleQueue[tuple[Item, asyncio.Future[Result]] | None] = queue.SimpleQueue()
        self._workers = [
            threading.Thread(target=self._work, daemon=True, name="micro-batching") for _ in range(workers)
        ]
        self.batches = 0
        self.items = 0
        for worker in self._workers:
            worker.start()

    async def submit(self, item: Item) -> Result:
        """The result of one item.

        Raises
        ------
        ServerBusy
            If the queue is full.
        """
        if self._queue.qsize() >= self._max_queue:
            raise ServerBusy
        future: asyncio.Future[Result] = asyncio.get_running_loop().create_future()
        self._queue.put((item, future))
        return await future

    def close(self) -> None:
        """Process what is queued, then end the threads."""
        for _ in self._workers:
            self._queue.put(None)
        for worker in self._workers:
            worker.join()

    def _work(self) -> None:
        while True:
            batch, more = self._next_batch()
            if batch:
                self._run(batch)
            if not more:
                return

    def _next_batch(self) -> tuple[list[tuple[Item, asyncio.Future[Result]]], bool]:
        """What is queued, at least one item; and whether to go on."""
        taken = [self._queue.get()]
        while taken[-1] is not None and len(taken) < self._max_batch:
            try:
                taken.append(self._queue.get_nowait())
            except queue.Empty:
                break
        return [entry for entry in taken if entry is not None], taken[-1] is not None

    def _run(self, batch: Sequence[tuple[Item, asyncio.Future[Result]]]) -> None:
        self.batches += 1
        self.items += len(batch)
        results: Sequence[Result | Exception]
        try:
            results = self._process([item for item, _ in batch])
        except Exception as error:
            results = [error] * len(batch)
        loop = batch[0][1].get_loop()
        pairs = [(future, result) for (_, future), result in zip(batch, results, strict=True)]
        if not loop.is_closed():
            loop.call_soon_threadsafe(_resolve, pairs)


def _resolve(pairs: Sequence[tuple[asyncio.Future[Result], Result | Exception]]) -> None:
    for future, result in pairs:
        if future.done():  # the client has disconnected
            continue
        if isinstance(result, Exception):
            future.set_exception(result)
        else:
            future.set_result(result)
