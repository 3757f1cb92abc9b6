"""The particulars of a clause: direction, side, speed, count, style, height, amplitude, each taken out of the words."""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from functools import cache

from encoders.corpus.language.lexicon import modifiers
from encoders.corpus.language.words import NUMBER_VALUES

_HIS = r"(?:the|his|her|their|its|there|own|a|one'?s?)"
_WAY = rf"(?:to|toward|on|over to|off to|in) (?:{_HIS} )?"
_LIMB = r"(hand|arm|leg|foot|feet|knee|elbow|shoulder|fist|palm|wrist|finger|hip|thigh|ankle|ear|forearm|index finger|heel|toe)"
_SINGULAR = {"feet": "foot", "index finger": "finger"}
_NUMBER = r"(\d+|" + "|".join(NUMBER_VALUES) + ")"

# (pattern, field, value); "{1}" is the pattern's first group. Taken out in this order.
_TABLE: tuple[tuple[str, str, str], ...] = (
    (r"\b(?:in )?(?:a )?(?:\w+ )?(?:half|semi|quarter|three quarter|u|s)[ -]?(?:circle|shape|turn|moon|oval)\b.*", "unsure", ""),
    (rf"\b(?:forward )?(?:and )?(?:diagonally|diagonal|at an? (?:slight )?(?:angle|diagonal)),? (?:forward )?(?:and )?(?:{_WAY}|{_HIS} )?(left|right)(?: side)?\b",
     "direction", "forward-{1}"),
    (rf"\bforward,? (?:and )?(?:slightly )?(?:{_WAY})?(left|right)(?: side| diagonally| diagonal| direction)?\b", "direction", "forward-{1}"),
    (rf"\b{_WAY}(?:front |forward )(left|right)\b", "direction", "forward-{1}"),
    (rf"\bbackward,? (?:and )?(?:{_WAY})(left|right)(?: side)?\b", "direction", "backward-{1}"),
    (r"\b(?:around )?in (?:a )?(?:\w+ )?(clockwise|counterclockwise) (?:circle|direction|motion|fashion|manner|circular motion|way|pattern|rotation|circles|arc|loop|circular path)\b",
     "direction", "{1}"),
    (r"\b(?:around )?(?:in )?(?:a )?(?:(?:small|large|big|wide|full|complete|whole|tight) )?(?:circle|circles|circular (?:motion|path|pattern|direction|fashion|manner)),? (?:in (?:a )?)?(clockwise|counterclockwise)(?: direction)?\b",
     "direction", "{1}"),
    (r"\b(clockwise|counterclockwise)(?: direction)?(?: (?:around )?in (?:a )?(?:\w+ )?circles?)?\b", "direction", "{1}"),
    (r"\b(?:around )?in (?:a )?(?:(?:small|large|big|wide|full|complete|whole|tight) )?(?:circle|circles|circular (?:motion|path|pattern|direction|fashion|manner))(?: around(?: the room)?)?\b",
     "direction", "around"),
    (r"\b(?:in )?(?:a )?zigzag\b", "direction", "zigzag"),
    (r"\bbackandforth\b", "direction", "back and forth"),
    (r"\bsidetoside\b", "direction", "side to side"),
    (r"\binplace\b", "direction", "in place"),
    (rf"\b{_WAY}(left|right)(?: side| direction)?(?! {_LIMB})\b", "direction", "{1}"),
    (rf"\b(left|right)(?:ward)?(?: direction)?(?! ?-?(?:handed)?\s?{_LIMB})(?:wards?)?\b(?! hand| arm| leg| foot| and left| and right)", "direction", "{1}"),
    (r"\b(?:directly |straight )?(?:forward|ahead|onward)(?: in (?:a |an )?(?:\w+ )?(?:straight )?(?:line|path|direction|manner))?(?: straight)?\b", "direction", "forward"),
    (r"\b(?:in )?(?:a )?(?:\w+ )?(?:straight|forward) (?:line|path|direction)(?: forward)?\b", "direction", "forward"),
    (r"\b(?:straight )?(?:backward|in reverse)(?: in (?:a )?(?:straight )?(?:line|path|direction))?\b", "direction", "backward"),
    (r"\b(?:(?:in |at )?(?:a )?(?:very |really |quite )?(?:slow|leisurely|relaxed)(?: and steady)?(?: walking)? (?:pace|speed|motion|manner|walk|jog|rate|tempo))\b", "speed", "slow"),
    (r"\b(?:(?:very|really|quite|somewhat|more) )?(?:slowly|slow|leisurely|unhurriedly|gradually)\b", "speed", "slow"),
    (r"\b(?:(?:in |at )?(?:a )?(?:very |really )?(?:fast|quick|brisk|rapid|high|hurried|quickened)(?: walking| running)? (?:pace|speed|motion|manner|rate|tempo|fashion))\b", "speed", "fast"),
    (r"\b(?:(?:very|really|quite|more) )?(?:quickly|rapidly|fast|fastly|briskly|swiftly|hurriedly|speedily|in a hurry|hastily|faster)\b", "speed", "fast"),
    (r"\b(?:in |at |with )?(?:a |an )?(?:normal|moderate|steady|medium|regular|average|constant|even|comfortable|standard|good)(?: walking| jogging| running)? (?:pace|speed|rate|tempo|gait|manner|stride|walk|fashion|way)\b", "nothing", ""),
    (r"\b(?:normally|regularly|steadily|simply|simultaneously|at the same time|once more|for (?:a |the )?(?:moment|second|while|bit|few seconds|some time|short time|few moments|short while)|briefly|momentarily|all the way)\b", "nothing", ""),
    (rf"\b{_NUMBER} (?:full )?(?:times?|reps|repetitions)\b", "count", "{1}"),
    (r"\bonce\b", "count", "1"),
    (r"\btwice\b", "count", "2"),
    (r"\b(?:a few|several|multiple|many|a couple(?: of)?|some|various|numerous) (?:more )?times\b|\brepeatedly\b|\bcontinuously\b|\bover and over(?: again)?\b", "several", ""),
    (r"\b(?:a )?(?:few|several|some|couple(?: of)?|multiple|many|number of|series of) (?:\w+ )?(?:steps|paces|strides|feet)\b", "nothing", ""),
    (r"\b(?:up )?(?:high )?(?:above|over) (?:\w+ )?(?:head|heads)\b|\boverhead\b|\bup high\b|\bhigh(?: up)?(?: in(?:to)? the air)?\b", "height", "high"),
    (r"\b(?:up )?(?:to|at|about|until|till|near|around|from) (?:\w+ )?(?:shoulder|chest|waist|stomach|belly|hip|torso)(?: |-)?(?:height|level|length)\b|\b(?:shoulder|chest|waist)(?: |-)?(?:height|level|high)\b", "height", "middle"),
    (r"\b(?:from|off|on|to|onto|at|near|toward)(?: of)? (?:the )?(?:floor|ground)\b", "height", "low"),
    (r"\b(?:from|off|on|onto|at)(?: of)? (?:a |the |his |her |their )?(?:table|counter|desk|bench)\b", "height", "middle"),
    (r"\b(?:from|off|on|onto|at)(?: of)? (?:a |the |his |her |their )?(?:high |top |upper )?(?:shelf|rack|cabinet|cupboard)\b", "height", "high"),
    (r"\b(?:very )?(?:slightly|a bit|a little bit|a little|lightly|just a bit|somewhat)\b", "amplitude", "small"),
    (r"\bwidely\b|\bwith (?:big|large|long|wide) (?:steps|strides|movements|motions)\b", "amplitude", "large"),
    (r"\bwith (?:small|short|little|tiny) (?:steps|strides|movements|motions)\b", "amplitude", "small"),
    (r"\b(?:while |and )?(?:with |swinging )?(?:his|her|their|the|both)?\s?(?:arms|hands) (?:by|at|to|on|down at|down by|hanging by|loosely at) (?:his|her|their|the|its) sides?\b", "nothing", ""),
    (r"\b(?:in front of|before) (?:him|her|them|it|the)?\s?(?:self|selves|body|person|chest)\b|\b(?:out )?in front\b", "front", ""),
    (r"\bin(?:to)? the air\b", "nothing", ""),
    (r"\bacross (?:the |a )?(?:room|floor|area)\b", "nothing", ""),
)  # fmt: skip
_PATTERNS = tuple((re.compile(pattern), name, value) for pattern, name, value in _TABLE)
_LIMBS = re.compile(
    rf"\b(with |using |by |on )?((?:{_HIS} |both |each |of |left |right |left-handed |right-handed |extended |outstretched )*){_LIMB}(s?)\b(?! (?:level|height))"
)
_STYLE_WORDS = {
    "casually": "relaxed", "confidently": "confident", "happily": "happy", "angrily": "angry", "sadly": "sad",
    "proudly": "proud", "drunkenly": "drunk", "stealthily": "sneaking", "sneakily": "sneaking", "energetically": "energetic",
    "gracefully": "elegant", "elegantly": "elegant", "cheerfully": "happy", "joyfully": "happy", "nervously": "scared",
    "excitedly": "energetic", "tiredly": "tired", "aggressively": "angry", "robotically": "robotic", "stiffly": "robotic",
    "shyly": "shy", "playfully": "childlike", "vigorously": "energetic", "calmly": "relaxed", "with a limp": "limping",
    "with confidence": "confident", "as if drunk": "drunk", "like a drunk": "drunk", "like a robot": "robotic",
    "like a zombie": "zombie", "like an old man": "old", "like an old person": "old", "like a model": "feminine",
    "like a drunk person": "drunk", "in a casual manner": "relaxed", "in a relaxed manner": "relaxed",
    "as if injured": "injured", "as if in pain": "injured", "as if tired": "tired", "as if angry": "angry",
    "as if scared": "scared", "with swagger": "cool", "with a swagger": "cool", "like he is drunk": "drunk",
    "like they are drunk": "drunk", "as if they are drunk": "drunk", "as if he is drunk": "drunk", "as if sad": "sad",
    "in a drunken manner": "drunk", "in a zombie like manner": "zombie", "in a confident manner": "confident",
    "as if limping": "limping", "while limping": "limping", "in a robotic manner": "robotic", "in a robotic fashion": "robotic",
}  # fmt: skip


@cache
def _styles() -> tuple[tuple[re.Pattern[str], str], ...]:
    ways = dict(_STYLE_WORDS)
    for style, places in modifiers()["style"].items():
        for way in [*places.get("adverb", []), *places.get("after", [])]:
            if "{" not in way:
                ways.setdefault(way, style)
    longest_first = sorted(ways, key=len, reverse=True)
    return tuple((re.compile(rf"\b{re.escape(way)}\b"), ways[way]) for way in longest_first)


@dataclass
class Particulars:
    """What was taken out of a clause, and the words that are left.

    Attributes
    ----------
    fields : dict
        Field of a step -> value, as text.
    limbs : list of (str, str)
        Parts of the body in order with their side; singular.
    rest : str
        The other words, without articles and possessives.
    front, several, unsure : bool
        Whether "in front" and "several times" were said; whether something cannot be acted out.
    """

    fields: dict[str, str] = field(default_factory=dict)
    limbs: list[tuple[str, str]] = field(default_factory=list)
    rest: str = ""
    front: bool = False
    several: bool = False
    unsure: bool = False


def _take_limbs(text: str, found: Particulars) -> str:
    def taken(match: re.Match[str]) -> str:
        by, owner, name, plural = match[1] or "", match[2], match[3], match[4]
        sides = {side for side in ("left", "right") if side in owner}
        many = bool(plural) or name == "feet" or "both" in owner
        side = "both" if many or len(sides) == 2 else next(iter(sides), "")
        noun = _SINGULAR.get(name, name)
        found.limbs.append((noun, side))
        instrument = by.strip() in ("with", "using", "by") and noun in (
            "hand",
            "arm",
            "foot",
            "leg",
            "fist",
            "elbow",
            "knee",
            "finger",
        )
        return " " if instrument else f" {by.strip()} {noun} "

    return " ".join(_LIMBS.sub(taken, text).split())


_SMALL_WORDS = re.compile(
    r"\b(?:the|a|an|his|her|their|its|this|that|own|some|of|very|really|there|just|also|then|again|theirs|quite|even)\b|,"
)
_OBJECT = re.compile(
    r"\b(?:small |large |big |invisible |imaginary )?(?:something|objects?|items?|things?|anything|stuff|it|them)\b"
)


def take_particulars(clause: str) -> Particulars:
    """The particulars of a normalised clause without its subject and verb."""
    found = Particulars()
    text = f" {clause} "
    for pattern, style in _styles():
        if pattern.search(text):
            text = pattern.sub(" ", text, count=1)
            found.fields["style"] = style
    text = _take_limbs(text, found)
    for pattern, name, value in _PATTERNS:
        match = pattern.search(text)
        if match is None:
            continue
        text = pattern.sub(" ", text, count=1)
        if name in ("unsure", "front", "several"):
            setattr(found, name, True)
        elif name != "nothing":
            if name in found.fields and found.fields[name] != value:
                if name == "direction" and {found.fields[name], value} <= {
                    "forward",
                    "in place",
                    "around",
                    "up",
                    "down",
                }:
                    continue
                found.unsure = True
            found.fields[name] = value.replace("{1}", match[1] if match.groups() and match[1] else "")
    if "count" in found.fields:
        number = found.fields["count"]
        found.fields["count"] = str(NUMBER_VALUES.get(number, number))
    found.rest = " ".join(_OBJECT.sub("obj", _SMALL_WORDS.sub(" ", text)).split())
    return found
