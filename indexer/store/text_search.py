"""Clips by words: those of their paths, captions, tags and collections, in any order, in any form, by beginnings."""

from __future__ import annotations

import re
import sqlite3
from collections.abc import Sequence

from indexer.store.clips import LIVE
from indexer.store.marks import marks_table
from indexer.store.spelling import folded

#: Clips that have words in one place, at most: words that more have tell little.
MOST = 300
_JOINED = "JOIN clips ON clips.id = {} JOIN files ON files.id = clips.file_id AND files.state = 'indexed'"


def called(db: sqlite3.Connection, text: str) -> list[int]:
    """The ids of clips whose name, path or "#number" is this text."""
    number = int(text[1:]) if re.fullmatch(r"#[0-9]{1,18}", text) else -1
    query = " UNION ".join(f"SELECT clips.id {LIVE} AND {column} = ?" for column in ("name", "clip_path", "clips.id"))
    return [clip_id for (clip_id,) in db.execute(f"{query} LIMIT {MOST}", (text, text, number))]


def in_paths(db: sqlite3.Connection, words: Sequence[str], *, beyond: int = 0) -> list[int]:
    """The ids of clips that have all words in their paths; only those above `beyond`."""
    query = (
        f"SELECT clips.id FROM clips_fts {_JOINED.format('clips_fts.rowid')} "
        f"WHERE clips_fts MATCH ? AND clips_fts.rowid > ? LIMIT {MOST}"
    )
    return [clip_id for (clip_id,) in db.execute(query, (_expression(words), beyond))] if words else []


def in_captions(db: sqlite3.Connection, words: Sequence[str], *, beyond: int = 0) -> list[int]:
    """The ids of clips of which one caption has all words; only those above `beyond`."""
    query = (
        "SELECT DISTINCT clips.id FROM texts_fts JOIN captions ON captions.text_id = texts_fts.rowid "
        f"{_JOINED.format('captions.clip_id')} WHERE texts_fts MATCH ? AND captions.clip_id > ? LIMIT {MOST}"
    )
    return [clip_id for (clip_id,) in db.execute(query, (_expression(words), beyond))] if words else []


def in_marks(db: sqlite3.Connection, words: Sequence[str], kind: str) -> list[int]:
    """The ids of clips with a tag or in a collection (`kind`) whose name has all words, each as a beginning."""
    wanted = [folded(word) for word in words]
    names = [name for name in marks_table.named(db, kind) if wanted and all(_begins(folded(name), w) for w in wanted)]
    marks = ",".join("?" * len(names))
    query = (
        f"SELECT DISTINCT clips.id FROM marks {_JOINED.format('marks.clip_id')} "
        f"WHERE kind = ? AND marks.name IN ({marks}) LIMIT {MOST}"
    )
    return [clip_id for (clip_id,) in db.execute(query, (kind, *names))] if names else []


def _begins(name: str, word: str) -> bool:
    """Whether a word of a name begins so."""
    return name.startswith(word) or any(part.startswith(word) for part in name.split())


def _expression(words: Sequence[str]) -> str:
    """The words as an expression of FTS5: all of them, each a beginning; "take_01" is two words in a row."""
    plain = [word.replace('"', '""').replace("\0", " ") for word in words]  # NUL would end the expression
    return " ".join(f'"{word}"*' for word in plain)
