"""How well the language of the corpus matches what people write: coverage, style, variety."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from encoders.corpus.language.lexicon import entries
from encoders.corpus.language.parsing import read

_WORD = re.compile(r"[a-z']+")


@dataclass(frozen=True)
class Coverage:
    """What of a set of human sentences the corpus can act out.

    Attributes
    ----------
    sentences : int
        How many there were.
    verbs_known : float
        Share whose main verbs the corpus can all act out.
    read : float
        Share understood completely, as a scene that programs can act.
    missing : Counter
        Main verbs that it cannot act out, as written; light verbs (do, make, take) where their object is unknown.
    actions : Counter
        Actions in the scenes read.
    """

    sentences: int
    verbs_known: float
    read: float
    missing: Counter[str]
    actions: Counter[str]


def coverage(sentences: Iterable[str]) -> Coverage:
    """Read every sentence and count."""
    count = known = understood = 0
    missing: Counter[str] = Counter()
    actions: Counter[str] = Counter()
    for sentence in sentences:
        reading = read(sentence)
        count += 1
        known += bool(reading.verbs) and all(can for _, can in reading.verbs)
        missing.update(verb for verb, can in reading.verbs if not can)
        if reading.scene is not None:
            understood += 1
            actions.update(step.action for group in reading.scene.steps for step in group)
    total = max(count, 1)
    return Coverage(count, known / total, understood / total, missing, actions)


def words_of(sentences: Iterable[str]) -> Counter[str]:
    """How often each word occurs."""
    return Counter(word for sentence in sentences for word in _WORD.findall(sentence.lower()))


def words_per_sentence(sentences: Sequence[str]) -> float:
    """Mean number of words."""
    return sum(len(_WORD.findall(sentence.lower())) for sentence in sentences) / max(len(sentences), 1)


def vocabulary_shared(ours: Counter[str], theirs: Counter[str]) -> float:
    """Share of the words that people write, counted as often as they write them, that captions also use."""
    return sum(count for word, count in theirs.items() if word in ours) / max(theirs.total(), 1)


def phrase_counts() -> dict[str, int]:
    """How many phrasings there are of each action: verb phrases and labels, each text counted once."""
    return {
        action: len({phrase.text for kind in ("verbs", "nouns", "parts") for phrase in entry.phrases(kind)})
        for action, entry in entries().items()
    }
