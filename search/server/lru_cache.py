"""A thread-safe cache that evicts the least recently used values."""

from __future__ import annotations

import math
import threading
from collections import OrderedDict
from collections.abc import Callable, Hashable, Iterable
from typing import Generic, TypeVar

Value = TypeVar("Value")


class LruCache(Generic[Value]):
    """Values by key. Unlike `functools.lru_cache`, it can be read without computing and single values can be dropped.

    Parameters
    ----------
    size : int
        The number of values, at most.
    weight, max_weight : callable and float, optional
        The weight of a value, and the total weight, at most; the last value is kept even if it is heavier.
    """

    def __init__(
        self, size: int, *, weight: Callable[[Value], float] | None = None, max_weight: float = math.inf
    ) -> None:
        self._size = size
        self._weight = weight
        self._max_weight = max_weight
        self._values: OrderedDict[Hashable, Value] = OrderedDict()
        self._lock = threading.Lock()

    def __len__(self) -> int:
        return len(self._values)

    def get(self, key: Hashable) -> Value | None:
        """The value, else None."""
        with self._lock:
            if key in self._values:
                self._values.move_to_end(key)
            return self._values.get(key)

    def put(self, key: Hashable, value: Value) -> None:
        """Add or replace a value."""
        with self._lock:
            self._values[key] = value
            self._values.move_to_end(key)
            while len(self._values) > 1 and self._is_full():
                self._values.popitem(last=False)

    def get_or(self, key: Hashable, make: Callable[[], Value]) -> Value:
        """The value, else `make()`, which is cached; two threads may both compute it."""
        value = self.get(key)
        if value is None:
            value = make()
            self.put(key, value)
        return value

    def drop(self, keys: Iterable[Hashable]) -> None:
        """Remove values."""
        with self._lock:
            for key in keys:
                self._values.pop(key, None)

    def clear(self) -> None:
        """Remove all values."""
        with self._lock:
            self._values.clear()

    def items(self) -> list[tuple[Hashable, Value]]:
        """All keys and values, the least recently used first."""
        with self._lock:
            return list(self._values.items())

    def _is_full(self) -> bool:
        if len(self._values) > self._size:
            return True
        return self._weight is not None and sum(map(self._weight, self._values.values())) > self._max_weight
