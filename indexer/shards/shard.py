"""Shard: which of the files of an archive one of several indexers reads."""

from __future__ import annotations

import re
from dataclasses import dataclass
from functools import cached_property
from hashlib import blake2b
from typing import Any

from encoders.arguments import shown
from encoders.errors import ArgumentError
from indexer.store.spelling import composed

#: Every file lies in one of so many slots, by its path alone; a shard has some of them.
SLOTS = 4096
_FORM = re.compile(r"([0-9]{1,6})/([0-9]{1,6})")


def slot_of(path: str) -> int:
    """The slot of a file, by its path in its root, in whichever of Unicode's forms."""
    return _hashed(composed(path)) % SLOTS


def clip_number(root: str, path: str) -> int:
    """The number of a clip in a collection, by the name of its root and its path there; 53 bits, as JavaScript has.

    Of ten million clips two share a number once in two hundred such archives; the second one is refused by name.
    """
    return _hashed(f"{root}\0{composed(path)}") >> 11


def _hashed(text: str) -> int:
    return int.from_bytes(blake2b(text.encode("utf-8", "surrogatepass"), digest_size=8).digest(), "little")


@dataclass(frozen=True)
class Shard:
    """One of `count` indexers, the first of which is 1.

    When the count changes, only the files that an added shard takes over change hands (jump consistent hashing; Lamping
    and Veach, 2014).
    """

    number: int = 1
    count: int = 1

    @classmethod
    def of(cls, given: Any) -> Shard:
        """From "2/8"; the whole archive if it is None.

        Raises
        ------
        ArgumentError
            If it is nothing of the kind.
        """
        if given is None or isinstance(given, Shard):
            return given or WHOLE
        found = _FORM.fullmatch(given) if isinstance(given, str) else None
        if found is None or not 1 <= int(found[1]) <= int(found[2]) <= SLOTS:
            raise ArgumentError(f"shard={shown(given)} must be I/N, such as 2/8: 1 to N, and N at most {SLOTS}")
        return cls(int(found[1]), int(found[2]))

    @property
    def is_whole(self) -> bool:
        """Whether it is the only one."""
        return self.count == 1

    @cached_property
    def slots(self) -> frozenset[int]:
        """Its slots."""
        return frozenset(slot for slot in range(SLOTS) if _jump(slot, self.count) == self.number - 1)

    def has(self, path: str) -> bool:
        """Whether a file is its own."""
        return self.is_whole or slot_of(path) in self.slots

    def __str__(self) -> str:
        return f"{self.number}/{self.count}"


WHOLE = Shard()


def _jump(key: int, count: int) -> int:
    """The bucket, of `count`, of a key."""
    state = _hashed(str(key))
    bucket, following = -1, 0
    while following < count:
        bucket = following
        state = (state * 2862933555777941757 + 1) % (1 << 64)
        following = int((bucket + 1) * (1 << 31) / ((state >> 33) + 1))
    return bucket
