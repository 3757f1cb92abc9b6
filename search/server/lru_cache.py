"""A thread-safe cache that evicts the least recently used values."""

from __future__ import annotations

import threading
from collections.abc import Callable, Hashable, Iterable
from typing import Generic, TypeVar

from cachetools import Cache, LRUCache

Value = TypeVar("Value")


class LruCache(Generic[Value]):
    """A `cachetools.LRUCache` behind a lock. Unlike `functools.lru_cache`, it can be read without computing.

    Parameters
    ----------
    size : float
        The total weight of the values, at most.
    weight : callable, optional
        The weight of a value; 1 if not given. A value heavier than `size` counts as `size` and is kept alone.
    """

    def __init__(self, size: float, *, weight: Callable[[Value], float] | None = None) -> None:
        self._values: LRUCache[Hashable, Value] = LRUCache(
            size, getsizeof=None if weight is None else lambda value: min(weight(value), size)
        )
        self._lock = threading.Lock()

    def __len__(self) -> int:
        return len(self._values)

    def get(self, key: Hashable) -> Value | None:
        """The value, else None."""
        with self._lock:
            return self._values.get(key)

    def put(self, key: Hashable, value: Value) -> None:
        """Add or replace a value."""
        with self._lock:
            self._values[key] = value

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
        """All keys and values; this does not count as use."""
        with self._lock:
            return [(key, Cache.__getitem__(self._values, key)) for key in self._values]
