"""The LRU cache of the server."""

from __future__ import annotations

from search.server.lru_cache import LruCache


def test_the_least_recently_used_is_evicted() -> None:
    cache: LruCache[int] = LruCache(2)
    cache.put("a", 1)
    cache.put("b", 2)
    cache.get("a")
    cache.put("c", 3)
    assert (cache.get("a"), cache.get("b"), cache.get("c"), len(cache)) == (1, None, 3, 2)


def test_values_are_computed_once() -> None:
    cache: LruCache[int] = LruCache(2)
    assert cache.get_or("a", lambda: 1) == 1
    assert cache.get_or("a", lambda: 9) == 1


def test_values_are_dropped() -> None:
    cache: LruCache[int] = LruCache(9)
    for key in "abc":
        cache.put(key, 1)
    cache.drop(["a", "x"])
    assert [key for key, _ in cache.items()] == ["b", "c"]
    cache.clear()
    assert len(cache) == 0


def test_heavy_values_evict_others_but_not_themselves() -> None:
    cache: LruCache[int] = LruCache(10, weight=float)
    for value in (4, 5, 3, 99):
        cache.put(value, value)
        kept = [key for key, _ in cache.items()]
        assert kept == {4: [4], 5: [4, 5], 3: [5, 3], 99: [99]}[value]
