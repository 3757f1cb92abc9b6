"""Typing noise: mostly lower case without a full stop, and a rare typo."""

from __future__ import annotations

from encoders.corpus.language.weighted_choice import RandomSource, pick

_TYPOS = 0.035  # share of captions with a misspelt word
_MISSPELT = {
    "forward": ("foward", "foreward", "forword"),
    "backwards": ("backwords", "bacwards", "backwads"),
    "their": ("thier", "there", "the"),
    "person": ("perosn", "persom", "peron"),
    "gesture": ("jesture", "guesture"),
    "right": ("rigth", "rihgt"),
    "left": ("lefft", "elft"),
    "quickly": ("quicky", "quickley"),
    "slowly": ("slowley", "slwoly"),
    "something": ("soemthing", "somthing"),
    "walks": ("wlaks", "waks"),
    "clockwise": ("clock wise",),
    "counterclockwise": ("counter clock wise",),
    "sideways": ("side ways",),
    "while": ("whilst", "wile"),
    "raises": ("rises", "raisse"),
    "straight": ("strait", "straigt"),
    "and": ("an", "ands"),
    "then": ("than", "the"),
}


def _add_typo(text: str, rng: RandomSource) -> str:
    words = text.split()
    i = int(rng.random() * len(words))
    word = words[i]
    if word in _MISSPELT:
        words[i] = pick(rng, _MISSPELT[word])
    elif len(word) > 4 and word.isalpha() and word not in ("left", "right"):
        j = 1 + int(rng.random() * (len(word) - 2))
        if rng.random() < 0.5:
            words[i] = word[:j] + word[j + 1 :]
        else:
            words[i] = word[:j] + word[j + 1] + word[j] + word[j + 2 :]
    return " ".join(words)


def add_typing_noise(text: str, rng: RandomSource) -> str:
    """`text` with the casing and punctuation of human captions and, rarely, a typo."""
    text = " ".join(text.split())
    if text and rng.random() < _TYPOS:
        text = _add_typo(text, rng)
    if rng.random() < 0.12:
        text = text[:1].upper() + text[1:]
    return text + "." if rng.random() < 0.15 else text
