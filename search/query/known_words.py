"""Known words: those of descriptions of motion, and the share of a sentence that is out of vocabulary."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator

import numpy as np
from numpy.typing import NDArray

Words = NDArray[np.str_]

_WORD = re.compile(r"[^\W\d_]{2,}")
#: Within a name such as HitReactLeft, and a number that such a name ends with: 0 and more digits, or two at most.
_HUMP = re.compile(r"(?<=[a-z])(?=[A-Z])|(?<=[A-Z])(?=[A-Z][a-z])")
_NUMBER = re.compile(r"[-_. ]?(?<!\d)(?:0\d*|\d{1,2})$")
#: Stop words: articles, pronouns, prepositions, conjunctions, auxiliary verbs and question words, which say nothing of
#: what a sentence is about.
STOP_WORDS = frozenset(
    "an the this that these those and or nor but if so than as because at by for from in into of on onto per to "
    "with he him his she her hers it its they them their me my mine we us our ours you your yours am are be been "
    "being is was were do does did have has had can could may might must shall should will would how what when "
    "where which who whom whose why there".split()
)
#: What may be added to a word, or put for its last e.
_ENDINGS = ("s", "es", "d", "ed", "r", "er", "ing", "ly")
_SHORTEST_STEM = 3


def spelled_out(sentence: str) -> str:
    """A sentence with the names in it, as games and archives give them to clips, as words.

    >>> spelled_out("HitReactLeft_02"), spelled_out("a walk_cycle"), spelled_out("T-pose")
    ('Hit React Left', 'a walk cycle', 'T-pose')
    """
    numbered = sentence if " " in sentence.strip() else _NUMBER.sub("", sentence.strip())
    words = _HUMP.sub(" ", numbered).replace("_", " ").strip()
    return words or sentence


def lexicon(sentences: Iterable[str]) -> Words:
    """The distinct words (W,) of sentences, sorted."""
    return np.array(sorted({word for sentence in sentences for word in _words(sentence)}), dtype=np.str_)


def out_of_vocabulary_share(sentence: str, known: Words) -> float:
    """The share of a sentence's words, 0 to 1, that are in no form among the sorted known ones (W,); 1 if none."""
    words = content_words(sentence)
    return float(np.mean([not is_known(word, known) for word in words])) if words else 1.0


def content_words(sentence: str) -> list[str]:
    """The words of a sentence in lower case, without stop words."""
    return [word for word in _words(sentence) if word not in STOP_WORDS]


def _words(sentence: str) -> list[str]:
    return _WORD.findall(spelled_out(sentence).lower())


def is_known(word: str, known: Words) -> bool:
    """Whether a word is, in any form, among the sorted known ones (W,)."""
    forms = np.array(list(_forms(word)))
    places = np.minimum(np.searchsorted(known, forms), len(known) - 1)
    return len(known) > 0 and bool((known[places] == forms).any())


def _forms(word: str) -> Iterator[str]:
    yield word
    for ending in _ENDINGS:
        stem = word.removesuffix(ending)
        if stem != word and len(stem) >= _SHORTEST_STEM:
            yield stem
            yield stem + "e"
