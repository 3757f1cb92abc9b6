"""A human sentence brought into one form: lower case, no subject, common slips mended, fixed phrases in one word."""

from __future__ import annotations

import re

# what people type -> what they mean; applied in order to a lower-case sentence
_MENDS: tuple[tuple[str, str], ...] = (
    (r"[‘’`]", "'"),
    (r"\b(foward|forwad|foreward|forword|forwards|fowards|frontwards|frontward)\b", "forward"),
    (r"\b(backwards|backword|backwords|backards|bacwards)\b", "backward"),
    (r"\b(rigth|righ|rihgt)\b", "right"),
    (r"\bthier\b", "their"),
    (r"\b(persom|perosn|peson|persons)\b", "person"),
    (r"\b(jesture|gestrue|guesture)", "gesture"),
    (r"\bsoemthing\b|\bsomthing\b|\bsome thing\b", "something"),
    (r"\binfront\b", "in front"),
    (r"\bwhilst\b", "while"),
    (r"\bafterwards\b", "then"),
    (r"\btowards\b", "toward"),
    (r"\bupwards\b|\bupward\b", "up"),
    (r"\bdownwards\b|\bdownward\b", "down"),
    (r"\boutwards\b", "outward"),
    (r"\binwards\b", "inward"),
    (r"\b(counter|anti)[ -]?(clock)[ -]?wise\b|\bc\.c\.w\b", "counterclockwise"),
    (r"\bclock[ -]wise\b", "clockwise"),
    (r"\bside[ -]?step", "sidestep"),
    (r"\bside[ -]?ways?\b", "sideways"),
    (r"\btip[ -]?toe", "tiptoe"),
    (r"\btip toeing\b", "tiptoeing"),
    (r"\bu[ -]?turn\b", "uturn"),
    (r"\bt[ -]pose\b|\bt position\b|\bt shape\b", "tpose"),
    (r"\bjumping[ -]?jack(s?)\b", r"jumpingjack\1"),
    (r"\bstar jump(s?)\b", r"jumpingjack\1"),
    (r"\bjump[ -]?rope\b", "jumprope"),
    (r"\bcart[ -]wheel", "cartwheel"),
    (r"\bhand[ -]stand", "handstand"),
    (r"\bmoon[ -]walk", "moonwalk"),
    (r"\bzig[ -]?zag(s|ging|ged)?( pattern| motion| line| fashion| path)?\b", "zigzag"),
    (r"\bback[ -]and[ -]forth\b|\bto and fro\b|\bforth and back\b|\bback-and-forth\b", "backandforth"),
    (r"\b(from )?(side|left|right)[ -]to[ -](side|right|left)\b", "sidetoside"),
    (r"\bup and down\b", "upanddown"),
    (r"\ball fours\b", "allfours"),
    (r"\bhands and knees\b", "allfours"),
    (r"\bon the spot\b|\bin (the same |one |a )?(spot|place)\b|\bin it'?s place\b|\bon place\b|\bat (one|the same) (place|spot)\b",
     "inplace"),
    (r"\bone hundred (and )?eighty\b", "180"),
    (r"\bthree hundred (and )?sixty\b", "360"),
    (r"\bninety\b", "90"),
    (r"\bu ?-?turn\b", "uturn"),
    (r"\bleft side of (his|her|their|the) body\b", "left"),
    (r"\bright side of (his|her|their|the) body\b", "right"),
    (r"\b(his|her|their|its|the)?\s*left[ -]?hand side\b", " the left"),
    (r"\b(his|her|their|its|the)?\s*right[ -]?hand side\b", " the right"),
    (r"\blefthand\b", "left hand"),
    (r"\brighthand\b", "right hand"),
    (r"\bleft[ -]handed\b", "left-handed"),
    (r"\bright[ -]handed\b", "right-handed"),
    (r"\bcounter clock\b", "counterclock"),
    (r"\bo'?clock\b", "oclock"),
    (r"\bupper[ -]cut\b", "uppercut"),
    (r"\bhigh[ -]five\b", "highfive"),
    (r"\bup ?stairs\b", "up stairs"),
    (r"\bdown ?stairs\b", "down stairs"),
)  # fmt: skip
_MENDED = tuple((re.compile(pattern), to) for pattern, to in _MENDS)

_SUBJECT = re.compile(
    r"^(?:(?:in|on) (?:the|this) (?:video|clip|picture),? )?(?:(?:first|initially|at first),? )?"
    r"(?:(?:the|a|an|this|one|i|some|same|another) )?"
    r"(?:(?:stick|human|male|female|sim|toon|young|computer|animated|3d|skeleton) )*"
    r"(?:person|man|woman|figure|figurine|someone|somebody|human|individual|subject|character|guy|sim|toon|dude|actor|"
    r"body|boy|girl|lady|performer|people|user|model|skeleton|avatar|player|he|she|they|it|him|robot)\b"
    r"(?:'s)?(?: (?:that|who|which))?\b"
)
_AUXILIARY = re.compile(
    r"^(?:who |that |which |then |he |she |they |it |the person |the man |person |a person |also |now |just |again |and |"
    r"is |are |was |were |be |being |been |has |had |will |"
    r"(?:appears?|appeared|appearing|seems?|seemed|seeming|looks?) (?:as if |as though |like )?(?:(?:he|she|they|it)(?: is| are|'s|'re) )?(?:to )?(?:be )?(?=\w+ing\b|to\b)|"
    r"(?:appears?|appeared|seems?|seemed) to (?:be )?(?:have )?|"
    r"(?:starts?|started|starting|begins?|began|beginning|continues?|continued|continuing|proceeds?|proceeded|proceeding|"
    r"pretends?|pretended|pretending|tries|tried|trying|attempts?|attempting|decides?|goes on|prepares|gets ready|goes) (?:to (?=\w)|(?=\w+ing\b))|"
    r"(?:keeps?|kept) (?:on )?(?=\w+ing\b)|"
    r"(?:finally|next|lastly|eventually|afterward|immediately|simultaneously|once more) )+"
)


def normalise(sentence: str) -> str:
    """Lower case, single spaces, no full stop, slips mended, fixed phrases in one word."""
    text = " ".join(sentence.lower().replace("_", " ").split()).strip(" .!\"'")
    for pattern, to in _MENDED:
        text = pattern.sub(to, text)
    text = re.sub(r"\s*([,;.])\s*", r"\1 ", text).replace(";", ",").replace(". ", ", then ")
    return " ".join(re.sub(r"[^a-z0-9,'\- ]", " ", text).split()).strip(" ,")


def drop_subject(clause: str) -> str:
    """The clause without who moves."""
    return _SUBJECT.sub("", clause, count=1).strip(" ,")


def drop_auxiliaries(clause: str) -> str:
    """The clause from its full verb: without is, starts to, appears to be, then."""
    while True:
        shorter = _AUXILIARY.sub("", clause, count=1).strip(" ,")
        if shorter == clause:
            return clause
        clause = shorter
