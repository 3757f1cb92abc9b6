"""Held-out sentences: queries and captions of the evaluation, which training must not contain."""

from __future__ import annotations

import re
from collections.abc import Iterable
from pathlib import Path

_LETTERS = re.compile(r"[^a-z0-9]+")


def normal_form(sentence: str) -> str:
    """Lower-case letters and digits with single spaces, by which sentences are compared."""
    return _LETTERS.sub(" ", sentence.lower()).strip()


class HeldOutSentences:
    """A predicate: whether a sentence equals a held-out one up to case and punctuation.

    >>> held_out = HeldOutSentences(["A person walks."])
    >>> held_out("a person  walks")
    True
    """

    def __init__(self, sentences: Iterable[str]) -> None:
        self._forms = frozenset(filter(None, map(normal_form, sentences)))

    @classmethod
    def read(cls, *paths: Path) -> HeldOutSentences:
        """From text files: one sentence per line, or the last column of tab-separated lines."""
        lines = (line for path in paths for line in path.read_text(encoding="utf-8").splitlines())
        return cls(line.split("\t")[-1] for line in lines)

    def __len__(self) -> int:
        return len(self._forms)

    def __call__(self, sentence: str) -> bool:
        return normal_form(sentence) in self._forms
