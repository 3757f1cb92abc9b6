"""Matches by text: clips whose names, folders, captions, tags or collections have the words of a question.

They go into the ranking by meaning. A clip that is called exactly as the question comes first. Where the question is no
description of a movement ("take_016", "hero"), or is the name of a folder, a tag or a collection, all clips that have
it come before all others. Else ("walk") they stay where their meaning puts them: `benchmarks/names.py` shows that words
as evidence cost as many hits as they win. All words must be there, in any form.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import PurePosixPath

import numpy as np
from numpy.typing import NDArray

from encoders.protocol import Encoder
from indexer.store import text_search
from indexer.store.marks import marks_table
from indexer.store.marks.marks_table import COLLECTION, TAG
from indexer.store.spelling import folded, path_words
from indexer.store.stored_library import StoredLibrary
from search.query.known_words import STOP_WORDS
from search.ranking.clip_scores import ClipScore
from search.ranking.strength import is_out_of_vocabulary

NAME, FOLDER, CAPTION = "name", "folder", "caption"

#: What a match adds to a cosine: that of a clip that is called so, and of one that was asked for by a part of a name.
#: More than 2 outweighs any difference of cosines.
_CALLED, _FOUND = 5.0, 2.5
#: Words that a question is compared by, at most: longer ones are in no name.
_MOST_WORDS = 12
#: Who moves, which is in no name.
_SUBJECTS = frozenset("a i person someone somebody man woman human figure character actor people one two".split())
_TERM = re.compile(r"[^\s,;.!?]+")


@dataclass(frozen=True)
class TextMatch:
    """Where a clip has the words of a question, and what that adds to its score."""

    places: tuple[str, ...]
    bonus: float


def called_so() -> TextMatch:
    """The match of a clip that is called as the question."""
    return TextMatch((NAME,), _CALLED)


def words_of(sentence: str) -> list[str]:
    """The words of a question that names may have: no articles, no subject."""
    terms = [term.strip("\"'()[]*") for term in _TERM.findall(sentence)]
    plain = [term for term in terms if any(letter.isalnum() for letter in term)]
    return [term for term in plain if term.lower() not in STOP_WORDS | _SUBJECTS][:_MOST_WORDS]


def text_matches(
    library: StoredLibrary,
    encoder: Encoder,
    sentence: str,
    *,
    allowed: NDArray[np.int64] | None = None,
    evidence: float = 0.0,
) -> dict[int, TextMatch]:
    """The clips that have the words of a sentence, by id.

    Parameters
    ----------
    evidence : float
        What a match adds to a cosine where the sentence describes a movement.
    """
    db, words, text = library.connection, words_of(sentence), folded(sentence.strip())
    is_name = _is_name(encoder, sentence)

    def telling(ids: list[int]) -> list[int]:
        return ids if is_name or len(ids) < text_search.MOST else []

    places: dict[int, list[str]] = {}
    bonus: dict[int, float] = {}

    def found(clip_id: int, place: str, *, is_asked: bool = False) -> None:
        places.setdefault(clip_id, []).append(place)
        worth = _FOUND if is_name or is_asked else evidence
        bonus[clip_id] = max(bonus.get(clip_id, 0.0), worth)

    called = set(text_search.called(db, sentence.strip()))
    for clip_id, clip in library.clips_by_id([*called, *telling(text_search.in_paths(db, words))]).items():
        path = PurePosixPath(folded(clip.path))
        if clip_id in called or text in (folded(clip.name), path.name):
            found(clip_id, NAME)
            bonus[clip_id] = _CALLED
        else:
            found(clip_id, NAME if _in_name(words, clip.name) else FOLDER, is_asked=text in path.parts)
    for clip_id in telling(text_search.in_captions(db, words)):
        found(clip_id, CAPTION)
    for kind in (TAG, COLLECTION):
        names = {folded(name) for name in marks_table.named(db, kind)}
        for clip_id in telling(text_search.in_marks(db, words, kind)):
            found(clip_id, kind, is_asked=text in names)
    passing = set(places) if allowed is None else set(places).intersection(allowed.tolist())
    return {clip_id: TextMatch(tuple(places[clip_id]), bonus[clip_id]) for clip_id in places if clip_id in passing}


def fused(
    by_meaning: Iterable[ClipScore], by_text: Iterable[ClipScore], matches: Mapping[int, TextMatch]
) -> Iterator[ClipScore]:
    """The clips of both rankings, each best first, in one order: by score and what text adds to it.

    Parameters
    ----------
    by_meaning : iterable of ClipScore
        All clips, consumed as far as needed.
    by_text : iterable of ClipScore
        Those of `matches`.
    """
    lifted = sorted(by_text, key=lambda score: -score.score - matches[score.clip_id].bonus)
    waiting = iter(lifted)
    first = next(waiting, None)
    for score in by_meaning:
        if score.clip_id in matches:
            continue
        while first is not None and first.score + matches[first.clip_id].bonus >= score.score:
            yield first
            first = next(waiting, None)
        yield score
    if first is not None:
        yield first
        yield from waiting


def _in_name(words: list[str], name: str) -> bool:
    """Whether a name alone has the words, each as the beginning of one of its own, but for their endings."""
    own = path_words(name).split()
    pieces = [piece for word in words for piece in path_words(word).split()]
    return all(any(part.startswith(piece[: max(3, len(piece) - 3)]) for part in own) for piece in pieces)


def _is_name(encoder: Encoder, sentence: str) -> bool:
    """Whether a question describes no movement, as far as the model knows words: then it is a part of a name."""
    words = (encoder.calibration or {}).get("words")
    return words is not None and is_out_of_vocabulary(sentence, words)
