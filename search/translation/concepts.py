"""Concepts: what a sentence names, whatever its language: sides, directions, counts, parts of the body, actions.

`lexicon` has a file for each language, `<concept> <stem> <stem> ...` a line. A stem begins a word; `_` ends it, `+`
joins stems that follow one another with other words between them. In languages that put no space between words a stem
may lie anywhere.
"""

from __future__ import annotations

import re
import unicodedata
from collections import defaultdict
from functools import cache
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

ENGLISH = "English"
_FOLDER = Path(__file__).with_name("lexicon")
_UNSPACED = frozenset({"Chinese", "Japanese", "Thai"})
_WORD = re.compile(r"[^\W_]+(?:-[^\W_]+)*")
#: Letters of a stem that tells a language.
_TELLING = 4


class _Stem(NamedTuple):
    """Beginnings of words that follow one another, `_` at the end of those that are whole words, and their concept."""

    parts: tuple[str, ...]
    concept: int


@cache
def languages() -> tuple[str, ...]:
    """The languages that have a lexicon, by their English names, English among them."""
    return tuple(sorted(path.stem for path in _FOLDER.glob("*.txt")))


@cache
def concept_names() -> tuple[str, ...]:
    """The concepts, in the order of their numbers."""
    return tuple(_entries(ENGLISH))


def concepts_of(sentence: str, language: str) -> NDArray[np.int64]:
    """The numbers of the concepts that a sentence names, sorted; each word counts for the longest stem it fits."""
    text = unicodedata.normalize("NFC", sentence).lower()
    found = _anywhere(text, language) if language in _UNSPACED else _by_word(_WORD.findall(text), language)
    return np.array(sorted(found), np.int64)


def stems_of(language: str, concept: str) -> tuple[str, ...]:
    """What names one concept in a language, as its file has it."""
    return _entries(language).get(concept, ())


@cache
def telling_stems(language: str) -> tuple[frozenset[str], frozenset[str]]:
    """Words of a language by which it is told: beginnings of words, and whole words."""
    single = [stem for stems in _entries(language).values() for stem in stems if "+" not in stem]
    beginnings = (stem for stem in single if not stem.endswith("_") and len(stem) >= _TELLING)
    return frozenset(beginnings), frozenset(stem[:-1] for stem in single if stem.endswith("_"))


def _by_word(words: list[str], language: str) -> set[int]:
    stems, found = _stems(language), set()
    for i, word in enumerate(words):
        keys = [word + "_", *(word[:end] for end in range(len(word), 0, -1))]
        fitting = [stem for key in keys for stem in stems.get(key, ()) if _follow(stem.parts[1:], words[i + 1 :])]
        if fitting:
            found.add(max(fitting, key=lambda stem: sum(map(len, stem.parts))).concept)
    return found


def _follow(parts: tuple[str, ...], words: list[str]) -> bool:
    """Whether words that parts of a stem fit are among others, in order."""
    left = iter(words)
    return all(any((word + "_").startswith(part) for word in left) for part in parts)


def _anywhere(text: str, language: str) -> set[int]:
    found: set[int] = set()
    for key, stems in sorted(_stems(language).items(), key=lambda entry: -len(entry[0])):
        if key in text:
            found.update(stem.concept for stem in stems)
            text = text.replace(key, " ")
    return found


@cache
def _entries(language: str) -> dict[str, tuple[str, ...]]:
    """The stems of each concept."""
    lines = (_FOLDER / f"{language}.txt").read_text(encoding="utf-8").splitlines()
    return {concept: tuple(stems) for concept, *stems in map(str.split, lines)}


@cache
def _stems(language: str) -> dict[str, list[_Stem]]:
    """The stems of a language by their first part."""
    number = {name: i for i, name in enumerate(concept_names())}
    by_first: dict[str, list[_Stem]] = defaultdict(list)
    for concept, stems in _entries(language).items():
        for stem in stems:
            parts = tuple(stem.split("+"))
            by_first[parts[0]].append(_Stem(parts, number[concept]))
    return dict(by_first)
