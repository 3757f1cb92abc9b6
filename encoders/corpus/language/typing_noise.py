"""Typing noise: mostly lower case without a full stop, and a rare typo; labels as names of files."""

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
_LONGEST_NAME = 5  # words of a label that may be the name of a file
_ABBREVIATED = {
    "left": "l", "right": "r", "forward": "fwd", "forwards": "fwd", "backward": "bwd", "backwards": "bwd",
    "reaction": "react",
}  # fmt: skip


def as_file_name(label: str, rng: RandomSource) -> str:
    """A short label as archives and games name clips, "hit_react_l" or "idle-02"; others unchanged."""
    words = [word for word in label.replace("-", " ").split() if word not in ("a", "an", "the", "to", "of")]
    if not 0 < len(words) <= _LONGEST_NAME:
        return label
    if rng.random() < 0.3:
        words = [_ABBREVIATED.get(word, word) for word in words]
    if rng.random() < 0.25:
        words.append(f"{1 + int(9 * rng.random()):02d}")
    return pick(rng, ("_", "_", "_", "-")).join(words)


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
