"""Batching: questions that arrive together are answered together.

No question waits for company: a worker takes whatever has come while it was busy, so batches grow with the load and
a lone question is answered at once.
"""

from __future__ import annotations

import asyncio
import queue
import threading
from collections.abc import Callable, Sequence
from typing import Generic, TypeVar

Item = TypeVar("Item")
Answer = TypeVar("Answer")


class ServerBusy(Exception):
    """More questions wait than can be answered in good time."""


class MicroBatcher(Generic[Item, Answer]):
    """Answers questions in batches, in threads of its own.

    Parameters
    ----------
    answer : function
        A batch -> an answer, or an exception, for each item.
    workers : int
        Threads.
    largest : int
        Questions of a batch; the more, the longer the first waits for the last.
    most_waiting : int
        Questions that may wait before more are refused.
    """

    def __init__(
        self,
        answer: Callable[[Sequence[Item]], Sequence[Answer | Exception]],
        *,
        workers: int = 1,
        largest: int = 8,
        most_waiting: int = 512,
    ) -> None:
        self._answer = answer
        self._largest = largest
        self._most_waiting = most_waiting
        self._waiting: queue.SimpleQueue[tuple[Item, asyncio.Future[Answer]] | None] = queue.SimpleQueue()
        self._workers = [threading.Thread(target=self._work, daemon=True, name="answering") for _ in range(workers)]
        self.batches = 0
        self.items = 0
        for worker in self._workers:
            worker.start()

    async def ask(self, item: Item) -> Answer:
        """The answer to one question.

        Raises
        ------
        ServerBusy
            If too many wait already.
        """
        if self._waiting.qsize() >= self._most_waiting:
            raise ServerBusy
        future: asyncio.Future[Answer] = asyncio.get_running_loop().create_future()
        self._waiting.put((item, future))
        return await future

    def close(self) -> None:
        """End the threads once what waits is answered."""
        for _ in self._workers:
            self._waiting.put(None)
        for worker in self._workers:
            worker.join()

    def _work(self) -> None:
        while True:
            batch, more = self._next()
            if batch:
                self._run(batch)
            if not more:
                return

    def _next(self) -> tuple[list[tuple[Item, asyncio.Future[Answer]]], bool]:
        """All that waits, once something does; and whether to go on."""
        taken = [self._waiting.get()]
        while taken[-1] is not None and len(taken) < self._largest:
            try:
                taken.append(self._waiting.get_nowait())
            except queue.Empty:
                break
        return [entry for entry in taken if entry is not None], taken[-1] is not None

    def _run(self, batch: Sequence[tuple[Item, asyncio.Future[Answer]]]) -> None:
        self.batches += 1
        self.items += len(batch)
        try:
            answers = self._answer([item for item, _ in batch])
        except Exception as error:
            answers = [error] * len(batch)
        loop = batch[0][1].get_loop()
        pairs = [(future, answer) for (_, future), answer in zip(batch, answers, strict=True)]
        if not loop.is_closed():
            loop.call_soon_threadsafe(_deliver, pairs)


def _deliver(pairs: Sequence[tuple[asyncio.Future[Answer], Answer | Exception]]) -> None:
    for future, answer in pairs:
        if future.done():  # whoever asked has gone
            continue
        if isinstance(answer, Exception):
            future.set_exception(answer)
        else:
            future.set_result(answer)
