"""Negation: what a sentence asks for and takes away: "walks without turning", "kicks, not left", "sits -chair"."""

from __future__ import annotations

import re
from dataclasses import dataclass
from functools import cache, lru_cache

from encoders.english import third_person
from search.query.languages import understood_language_of
from search.query.paraphrases import VERBS

#: What is looked for where a sentence says only what shall not be, and where that is any movement.
ANYTHING, STILL = "a person", "a person stands still"

#: What is taken away by one sentence, at most.
_MOST = 8
#: "-word" and '-"two words"', as search engines have it; "T-pose", "a c -shape", "- slowly" and "-90" are none.
_MINUS = re.compile(r"(?<!\S)(?<!\s[^\W\d_]\s)[-−](?:\"(?P<quoted>[^\"]*\w[^\"]*)\"|(?P<word>[^\W\d_][\w'’-]*))")
_AUXILIARY = "is|are|was|were|do|does|did|has|have|had|can|could|will|would|should|must"
_NOT = rf"(?:(?:{_AUXILIARY})\s+)?(?:not|never)|cannot|(?:{_AUXILIARY}|ca|wo)n['’]?t"
#: A part of the body that a negation is about is taken away with it: "the arms do not swing".
_PART = r"(?:arms?|hands?|legs?|feet|foot|knees?|heels?|toes|head|elbows?|shoulders?|hips?|body|torso)\b"
_ABOUT = rf"(?P<about>(?:with\s+)?(?:(?:the|his|her|their|both|one|left|right)\s+)*{_PART})\s+"
_WITHOUT = (
    r"without|w/o|instead\s+of|rather\s+than|except(?:\s+for)?|any(?:thing|body|one)\s+but|with\s+no|"
    r"(?:nobody|no\s+one)(?:\s+is)?|(?:^\s*|(?<=,\s)|(?<=\band\s)|(?<=\bbut\s))no"
)
#: These are no negations: more than one thing, what is tried or said, and manners that have words of their own.
_UNLESS = (
    r"(?![-\w])(?!\s+(?:only|just|merely|simply|know)\b)(?!\s+to\s+(?!the\b|his\b|her\b|their\b|one\b))"
    r"(?!\s+(?:(?:any|a|making\s+a)\s+)?(?:care|confidence|energy|purpose|skill|haste|hurry|hurrying|sound|noise)\b)"
)
_NEGATION = rf"(?:(?:who|that|which)\s+)?(?:(?:{_ABOUT})?(?:{_NOT})|{_WITHOUT}){_UNLESS}"
_CUE = rf"(?<![-\w])(?:(?:and|but|yet|or|nor)\s+(?:(?:he|she|they|it)\s+)?)?{_NEGATION}"
_SAID = re.compile(r"\b(?:i|you|we|as if|as though|whether(?: or)?)\s*$", re.IGNORECASE)
_NEGATED = re.compile(_CUE, re.IGNORECASE)
_BETWEEN = re.compile(r"\s*,\s*(?:n?or\s+)?|\s+n?or\s+", re.IGNORECASE)
_LITTLE = re.compile(r"^(?:(?:any|ever|even|very|too|so|much|really|quite|being)\s+)+|\s+at\s+all$", re.IGNORECASE)
_LOOSE = re.compile(
    r"^(?:\W|(?:and|but|or|yet)\b)+|(?:[^\w)\"°]|(?<!\w)(?:and|but|or|yet|who|that|which|is|are|while))+$",
    re.IGNORECASE,
)
_COMMAS = re.compile(r"(?:\s*,)+")
_BUT = re.compile(r"^\s*,?\s*but\b", re.IGNORECASE)
_SUBJECT = re.compile(
    r"(?:\W|\b(?:an?|the|some|this|person|man|woman|figure|human|character|actor|someone|somebody|he|she|they|is|are|"
    r"anything|everything|anybody|everybody)\b)*",
    re.IGNORECASE,
)
_MOVEMENT = re.compile(r"(?:a\s+)?(?:moves?|moved|moving|movement|motion)", re.IGNORECASE)
#: Who does not stop goes on.
_STOP = re.compile(r"stop(?:s|ped|ping)?\s+(?=\w+ing\b)", re.IGNORECASE)
_NOTHING = frozenset("it this that them him her so sure much many enough yet".split())
#: What stands before that which is taken away, in other languages.
_FOREIGN = {
    "Arabic": "بدون|دون",
    "Dutch": "zonder|(?:maar|en)\\s+niet",
    "French": "sans|(?:mais|et)\\s+pas",
    "German": "ohne|(?:aber|und)\\s+nicht|statt",
    "Italian": "senza|(?:ma|e)\\s+non",
    "Polish": "bez|(?:ale|i)\\s+nie",
    "Portuguese": "sem|(?:mas|e)\\s+não",
    "Russian": "без|(?:но|а|и)\\s+не",
    "Spanish": "sin|(?:pero|y)\\s+no",
}
#: Negations of other languages that are not understood. French "pas" alone is a step.
_UNHEARD = {
    "Arabic": r"\b(?:لا|لم|لن|ليس)\b",
    "Chinese": r"[不没沒](?![断斷停])",
    "Dutch": r"\b(?:niet|geen|nooit)\b",
    "French": r"\b(?:ne\s+|n['’])\w+(?:\s+\w+)?\s+(?:pas|jamais|plus)\b|^pas\s+de\b",
    "German": r"\b(?:nicht|kein(?:e[nmrs]?)?|nie(?:mals)?)\b",
    "Italian": r"\b(?:non|nessun[ao]?|mai)\b",
    "Japanese": r"ない|ません|なく|ずに",
    "Korean": r"않|없이|\b안\s",
    "Polish": r"\b(?:nie|nigdy|żaden)\b",
    "Portuguese": r"\b(?:não|nunca|nenhuma?)\b",
    "Russian": r"\b(?:не|никогда|нет)\b",
    "Spanish": r"\b(?:no|nunca|ningun[ao]?|jamás)\b",
    "Thai": r"ไม่",
    "Turkish": r"\w+m[ıiuü]yor\b|\w+m[ae]d[ae]n\b",
}


@dataclass(frozen=True)
class Parts:
    """What a sentence asks for, and what it takes away.

    Attributes
    ----------
    wanted : str
        The sentence itself where nothing is negated, `ANYTHING` or `STILL` where nothing is asked for.
    unwanted : tuple of str
    only_takes_away : bool
        Whether nothing is asked for.
    """

    wanted: str
    unwanted: tuple[str, ...] = ()
    only_takes_away: bool = False


@lru_cache(4096)
def parts_of(sentence: str) -> Parts:
    """The parts of a sentence: "walks without turning or stopping -left" takes away "left", "turning" and "stopping".

    In languages that put a word before what they take away ("ohne", "sans", "sin") that is understood, and "-word" in
    all that put spaces between words.
    """
    language = understood_language_of(sentence)
    unwanted = [found["quoted"] or found["word"].rstrip("-") for found in _MINUS.finditer(sentence)]
    text = _MINUS.sub("", sentence)
    cue, at = _foreign_cue(language) if language else _NEGATED, 0
    while cue and len(unwanted) < _MOST and (found := cue.search(text, at)):
        at, end = found.start(), _reach(text, found.end())
        items = _items(text[found.end() : end])
        if not items or _SAID.search(text[:at]):
            at = found.end()
            continue
        taken, kept = _divided(found.groupdict().get("about") or "", items)
        unwanted += taken
        text = " ".join([text[:at], *kept, _BUT.sub("", text[end:])])
    if text == sentence:
        return Parts(sentence)
    wanted = _COMMAS.sub(",", " ".join(_LOOSE.sub("", text).split()))
    if wanted and (language or not unwanted or not _SUBJECT.fullmatch(wanted)):
        return Parts(wanted, tuple(unwanted))
    return Parts(STILL if all(map(_MOVEMENT.fullmatch, unwanted)) else ANYTHING, tuple(unwanted), True)


def _divided(about: str, items: list[str]) -> tuple[list[str], list[str]]:
    """What is taken away of what is negated about a part of the body, or nothing, and what is still asked for."""
    going_on = [_STOP.sub("", item) for item in items if _STOP.match(item)]
    ended = [item for item in items if not _STOP.match(item)]
    if any(re.search(rf"\b{_PART}", item, re.IGNORECASE) for item in items):  # then it is no subject
        return ended, [about, *going_on]
    return [f"{about.removeprefix('with ')} {item}".strip() for item in ended], going_on


def unheard(sentence: str) -> str:
    """The negation of a sentence in another language that is not understood, so that nothing is taken away by it."""
    cue = _UNHEARD.get(understood_language_of(sentence))
    found = re.search(cue, parts_of(sentence).wanted, re.IGNORECASE) if cue else None
    return found[0].strip() if found else ""


def _foreign_cue(language: str) -> re.Pattern[str] | None:
    words = _FOREIGN.get(language)
    return re.compile(rf"\b(?:{words})\b", re.IGNORECASE) if words else None


def _reach(text: str, start: int) -> int:
    """Where that ends which is taken away from `start` on: at a comma, a verb that goes on, or the next negation."""
    ends, listed = _limits()
    ended = ends.search(text, start)
    end = ended.start() if ended else len(text)
    more = listed.match(text, end)
    return more.end() if more else end


@cache
def _limits() -> tuple[re.Pattern[str], re.Pattern[str]]:
    """What ends a negation, and more of the same after a comma, such as ", jumping or falling"; slow to compile."""
    goes_on = rf"(?:{'|'.join(map(third_person, VERBS))})\b"
    ends = (
        r"[,;.!?:()]|\s(?:but|then|while|whilst|so|because|as\s+if)\b|\sand\s+(?:then|he|she|they|also)\b"
        rf"|\sand\s+{goes_on}|\s{_CUE}|$"
    )
    listed = rf"(?:,(?!\s*{goes_on})[^,;.!?:()]+?)*,?\s+n?or\s+[^,;.!?:()]+?(?={ends})"
    return re.compile(ends, re.IGNORECASE), re.compile(listed, re.IGNORECASE)


def _items(scope: str) -> list[str]:
    items = (_LITTLE.sub("", item.strip()) for item in _BETWEEN.split(scope))
    return [item for item in items if any(map(str.isalpha, item)) and item.lower() not in _NOTHING]
