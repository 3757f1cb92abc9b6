"""English word forms for captions and their parser: verbs, articles, numbers.

Only regular rules and the irregular verbs of movement; no dictionary.
"""

from __future__ import annotations

# base: (third person, -ing, past), where the rules below would go wrong
_IRREGULAR: dict[str, tuple[str, str, str]] = {
    "be": ("is", "being", "was"),
    "have": ("has", "having", "had"),
    "do": ("does", "doing", "did"),
    "go": ("goes", "going", "went"),
    "lie": ("lies", "lying", "lay"),
    "die": ("dies", "dying", "died"),
    "tie": ("ties", "tying", "tied"),
    "hoe": ("hoes", "hoeing", "hoed"),
    "tiptoe": ("tiptoes", "tiptoeing", "tiptoed"),
    "quit": ("quits", "quitting", "quit"),
    "ski": ("skis", "skiing", "skied"),
    "see": ("sees", "seeing", "saw"),
    "flee": ("flees", "fleeing", "fled"),
    "free": ("frees", "freeing", "freed"),
    "dye": ("dyes", "dyeing", "dyed"),
    "bus": ("buses", "busing", "bused"),
    "mimic": ("mimics", "mimicking", "mimicked"),
    "panic": ("panics", "panicking", "panicked"),
    "shimmy": ("shimmies", "shimmying", "shimmied"),
    "karate-chop": ("karate-chops", "karate-chopping", "karate-chopped"),
}
_IRREGULAR_PAST: dict[str, str] = {
    "arise": "arose", "awake": "awoke", "bear": "bore", "beat": "beat", "become": "became", "begin": "began",
    "bend": "bent", "beseech": "besought", "bid": "bid", "bind": "bound", "bite": "bit", "bleed": "bled",
    "blow": "blew", "bow": "bowed", "break": "broke", "breed": "bred", "bring": "brought", "build": "built",
    "burst": "burst", "buy": "bought", "cast": "cast", "catch": "caught", "choose": "chose", "cling": "clung",
    "come": "came", "creep": "crept", "cut": "cut", "dig": "dug", "dive": "dived", "draw": "drew", "drink": "drank",
    "drive": "drove", "eat": "ate", "fall": "fell", "feed": "fed", "feel": "felt", "fight": "fought", "find": "found",
    "fling": "flung", "fly": "flew", "forget": "forgot", "forgive": "forgave", "freeze": "froze", "get": "got",
    "give": "gave", "grind": "ground", "grow": "grew", "hang": "hung", "hear": "heard", "hide": "hid", "hit": "hit",
    "hold": "held", "hurt": "hurt", "keep": "kept", "kneel": "knelt", "know": "knew", "lay": "laid", "lead": "led",
    "lean": "leaned", "leap": "leapt", "leave": "left", "let": "let", "light": "lit", "lose": "lost", "make": "made",
    "meet": "met", "overcome": "overcame", "overtake": "overtook", "pay": "paid", "put": "put", "read": "read",
    "rid": "rid", "ride": "rode", "ring": "rang", "rise": "rose", "run": "ran", "say": "said", "seek": "sought",
    "sell": "sold", "send": "sent", "set": "set", "shake": "shook", "shed": "shed", "shine": "shone", "shoot": "shot",
    "show": "showed", "shrink": "shrank", "shut": "shut", "sing": "sang", "sink": "sank", "sit": "sat",
    "sleep": "slept", "slide": "slid", "sling": "slung", "slit": "slit", "speak": "spoke", "speed": "sped",
    "spend": "spent", "spin": "spun", "spit": "spat", "split": "split", "spread": "spread", "spring": "sprang",
    "stand": "stood", "steal": "stole", "stick": "stuck", "stink": "stank", "stride": "strode", "strike": "struck",
    "string": "strung", "swear": "swore", "sweep": "swept", "swim": "swam", "swing": "swung", "take": "took",
    "teach": "taught", "tear": "tore", "tell": "told", "think": "thought", "throw": "threw", "thrust": "thrust",
    "understand": "understood", "undo": "undid", "unwind": "unwound", "wake": "woke", "wear": "wore", "weave": "wove",
    "weep": "wept", "wet": "wet", "win": "won", "wind": "wound", "withdraw": "withdrew", "wring": "wrung",
    "write": "wrote",
}  # fmt: skip
# last consonant doubled before -ing and -ed although the word has several syllables
_DOUBLED = {"cartwheel": False, "somersault": False, "zigzag": True, "karate-chop": True, "sidestep": True}
_VOWELS = "aeiou"
_NUMBERS = (
    "zero", "one", "two", "three", "four", "five", "six", "seven", "eight", "nine", "ten", "eleven", "twelve",
    "thirteen", "fourteen", "fifteen", "sixteen", "seventeen", "eighteen", "nineteen", "twenty",
)  # fmt: skip
NUMBER_VALUES = {word: value for value, word in enumerate(_NUMBERS)}


def _doubles(verb: str) -> bool:
    """Whether the final consonant doubles: one short vowel before it, one syllable."""
    if verb in _DOUBLED:
        return _DOUBLED[verb]
    if len(verb) < 3 or verb[-1] in _VOWELS + "wxy" or verb[-2] not in _VOWELS:
        return False
    stem = verb[:-2]
    if stem[-1] in _VOWELS and not stem.endswith("qu"):
        return False
    return not any(letter in _VOWELS for letter in stem.removesuffix("qu"))


def third_person(verb: str) -> str:
    """walk -> walks, crouch -> crouches, carry -> carries."""
    if verb in _IRREGULAR:
        return _IRREGULAR[verb][0]
    if verb.endswith(("s", "x", "z", "ch", "sh", "o")):
        return verb + "es"
    if verb.endswith("y") and verb[-2] not in _VOWELS:
        return verb[:-1] + "ies"
    return verb + "s"


def gerund(verb: str) -> str:
    """walk -> walking, run -> running, wave -> waving."""
    if verb in _IRREGULAR:
        return _IRREGULAR[verb][1]
    if verb.endswith("e") and not verb.endswith("ee"):
        return verb[:-1] + "ing"
    return verb + verb[-1] + "ing" if _doubles(verb) else verb + "ing"


def past(verb: str) -> str:
    """walk -> walked, run -> ran, hop -> hopped."""
    if verb in _IRREGULAR:
        return _IRREGULAR[verb][2]
    if verb in _IRREGULAR_PAST:
        return _IRREGULAR_PAST[verb]
    if verb.endswith("e"):
        return verb + "d"
    if verb.endswith("y") and verb[-2] not in _VOWELS:
        return verb[:-1] + "ied"
    return verb + verb[-1] + "ed" if _doubles(verb) else verb + "ed"


def inflect(verb: str, form: str) -> str:
    """`verb` (base form) as `form`: "base", "third", "ing" or "past"."""
    if form == "base":
        return verb
    return {"third": third_person, "ing": gerund, "past": past}[form](verb)


def plural_form(verb: str) -> str:
    """The plural of a verb in the third person singular: goes -> go, is -> are."""
    if verb == "is":
        return "are"
    if verb.endswith(("oes", "ches", "shes", "xes", "sses")):
        return verb[:-2]
    return verb[:-1] if verb.endswith("s") else verb


def number_word(value: int) -> str:
    """3 -> "three"; digits above twenty."""
    return _NUMBERS[value] if 0 <= value < len(_NUMBERS) else str(value)


def times(value: int) -> list[str]:
    """Phrases for `value` repetitions: "twice", "two times"."""
    word = number_word(value)
    if value == 1:
        return ["once", "one time", "a single time"]
    if value == 2:
        return ["twice", "two times", "2 times"]
    return [f"{word} times", f"{value} times", f"{word} times in a row"]


def indefinite(noun: str) -> str:
    """`noun` with a or an before it."""
    return ("an " if noun[:1] in _VOWELS and not noun.startswith(("uni", "one ")) else "a ") + noun
