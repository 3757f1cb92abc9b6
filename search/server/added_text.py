"""The text of clips that were added: whether an answer that is cached would now find one of them by its words."""

from __future__ import annotations

import sqlite3
from collections.abc import Sequence
from unicodedata import combining, normalize

from indexer.store import text_search
from indexer.store.spelling import path_words

#: Letters of the beginnings of words by which most questions are sorted out; stems of a word share them.
_BEGINNING = 2


class AddedText:
    """The paths and captions of the clips above a number."""

    def __init__(self, db: sqlite3.Connection, newest: int) -> None:
        self._db, self._newest = db, newest
        texts = db.execute("SELECT clip_path FROM clips WHERE id > ?", (newest,)).fetchall()
        texts += db.execute(
            "SELECT texts.text FROM captions JOIN texts ON texts.id = text_id WHERE clip_id > ?", (newest,)
        ).fetchall()
        self._beginnings = {beginning for (text,) in texts for beginning in _beginnings(text)}

    def has(self, words: Sequence[str]) -> bool:
        """Whether one of the clips has all words in its path, or in a caption."""
        if not words or not all(_beginnings(word) <= self._beginnings for word in words):
            return False
        found = text_search.in_paths(self._db, words, beyond=self._newest)
        return bool(found or text_search.in_captions(self._db, words, beyond=self._newest))


def _beginnings(text: str) -> set[str]:
    """The beginnings of the words of a text, without accents."""
    plain = "".join(letter for letter in normalize("NFKD", text) if not combining(letter))
    return {word[:_BEGINNING] for word in path_words(plain).split()}
