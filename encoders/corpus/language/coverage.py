"""How well the corpus' language matches human captions: coverage, length, vocabulary."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from encoders.corpus.language.lexicon import entries
from encoders.corpus.language.parsing import parse_report

_WORD = re.compile(r"[a-z']+")


@dataclass(frozen=True)
class Coverage:
    """The share of human sentences that the corpus can synthesise.

    Attributes
    ----------
    sentences : int
        Their number.
    verbs_known : float
        Share whose main verbs can all be synthesised.
    parsed : float
        Share parsed completely, as a scene of known programs.
    missing : Counter
        Main verbs that cannot be synthesised, as written; light verbs (do, make, take) if their object is unknown.
    actions : Counter
        Actions in the parsed scenes.
    """

    sentences: int
    verbs_known: float
    parsed: float
    missing: Counter[str]
    actions: Counter[str]


def coverage(sentences: Iterable[str]) -> Coverage:
    """Parse every sentence and count."""
    count = known = parsed = 0
    missing: Counter[str] = Counter()
    actions: Counter[str] = Counter()
    for sentence in sentences:
        report = parse_report(sentence)
        count += 1
        known += bool(report.verbs) and all(can for _, can in report.verbs)
        missing.update(verb for verb, can in report.verbs if not can)
        if report.scene is not None:
            parsed += 1
            actions.update(step.action for group in report.scene.steps for step in group)
    total = max(count, 1)
    return Coverage(count, known / total, parsed / total, missing, actions)


def words_of(sentences: Iterable[str]) -> Counter[str]:
    """Word counts."""
    return Counter(word for sentence in sentences for word in _WORD.findall(sentence.lower()))


def words_per_sentence(sentences: Sequence[str]) -> float:
    """Mean number of words per sentence."""
    return sum(len(_WORD.findall(sentence.lower())) for sentence in sentences) / max(len(sentences), 1)


def vocabulary_shared(ours: Counter[str], theirs: Counter[str]) -> float:
    """Share of the running words of `theirs` that occur in `ours`."""
    return sum(count for word, count in theirs.items() if word in ours) / max(theirs.total(), 1)


def phrase_counts() -> dict[str, int]:
    """Action -> number of distinct phrases: verb phrases, labels and clauses about body parts."""
    return {
        action: len({phrase.text for kind in ("verbs", "nouns", "parts") for phrase in entry.phrases(kind)})
        for action, entry in entries().items()
    }
