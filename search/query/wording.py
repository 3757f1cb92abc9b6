"""Wording: what is said of a sentence whose words are not those in which motion is described."""

from __future__ import annotations

import re
from difflib import get_close_matches

from search.query.known_words import Words, content_words, is_known, lexicon
from search.query.languages import language_of, understood_language_of
from search.query.negation import parts_of, unheard
from search.query.vocabulary import vocabulary
from search.translation.concepts import languages
from search.translation.english_neighbours import INSTALL

#: How like a known word one must be to be taken for a slip of it.
_ALIKE = 0.8
#: Letters of a word that may be a slip.
_SHORTEST = 4
#: Unknown words that are named, at most.
_NAMED = 5


def remark(sentence: str, known: Words) -> str:
    """One line on what is taken away, and what is not understood of a sentence, with the nearest known words.

    Empty where nothing is taken away and all is understood.

    Parameters
    ----------
    known : array of str (W,)
        Sorted words in which motion is described.
    """
    return "; ".join(filter(None, [_taken_away(sentence), _not_understood(sentence, known)]))


def _taken_away(sentence: str) -> str:
    parts = parts_of(sentence)
    if not parts.unwanted:
        return ""
    named = "taken away: " + ", ".join(f'"{text}"' for text in parts.unwanted)
    return f"{named}; no movement is named that shall be there" if parts.only_takes_away else named


def _not_understood(sentence: str, known: Words) -> str:
    if language := understood_language_of(sentence):
        negation = unheard(sentence)
        missed = f', but not "{negation}": say what shall not be there by a minus (-word), or in English'
        return f"understood as {language}{missed if negation else ''}"
    parts = parts_of(sentence)
    words = content_words(" ".join([parts.wanted, *parts.unwanted]) if parts.unwanted else sentence)
    unknown = [word for word in dict.fromkeys(words) if not is_known(word, known)]
    if not words or unknown:
        language = language_of(sentence)
        if language in languages():
            return f"this looks like {language}; to have it understood: {INSTALL}"
        if language:
            return f"this looks like {language}, which is not understood; ask in English"
    if not unknown:
        return ""
    slips = {word: near for word in unknown if (near := _nearest(word, known))}
    rest = [word for word in unknown if word not in slips][:_NAMED]
    remarks = []
    if slips:
        remarks.append(f'did you mean "{_corrected(sentence, slips)}"?')
    if len(rest) == len(set(words)):
        remarks.append('no word of it describes movement here; describe one in plain English, such as "a person waves"')
    elif rest:
        named = ", ".join(f'"{word}"' for word in rest)
        remarks.append(f"{named} {'is a word' if len(rest) == 1 else 'are words'} that the model has not learned")
    return "; ".join(remarks)


def _nearest(word: str, known: Words) -> str:
    """The known word that one is a slip of, rather one of the shipped vocabulary; empty where none is near."""
    for words in (lexicon(vocabulary()), known) if len(word) >= _SHORTEST else ():
        alike = [candidate for candidate in words.tolist() if candidate[0] == word[0] or candidate[1:] == word[1:]]
        if near := get_close_matches(word, alike, n=1, cutoff=_ALIKE):
            return str(near[0])
    return ""


def _corrected(sentence: str, slips: dict[str, str]) -> str:
    return re.sub(r"[^\W\d_]+", lambda found: slips.get(found[0].lower(), found[0]), sentence)
