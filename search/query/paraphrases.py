"""Paraphrases of a query: the verb that it begins with in other forms, after other subjects.

The mean vector of several paraphrases finds more than the vector of one sentence. A query that begins with no known
verb has none.
"""

from __future__ import annotations

import re
from functools import cache

from encoders.english import gerund, past, third_person

_MOST = 3  # with six as many are found on the validation takes, and a new sentence takes twice as long
_LONGEST = 40  # words; longer text is not paraphrased
_SUBJECT = re.compile(
    r"(?:(?:the|a|an|this|some|one) )?(?:(?:stick|human|male|female|young|old) )?"
    r"(?:person|man|woman|figure|human|individual|someone|somebody|he|she|they|guy|character|boy|girl|actor|performer)"
    r"\b(?:'s| is| are| was| were)? +"
)
_ADVERB = re.compile(r"\w+ly ")
VERBS = """
act applaud approach ascend back balance beckon bend block bounce bow box brush bump call carry cartwheel catch charge
check cheer circle clap clean climb close collapse comb come conduct cough cover crawl creep cringe cross crouch cry
cut dance dash descend die dig dip dodge drag draw dribble drink drive drop duck eat embrace extend faint fall fight
fish flap flex flinch flip fly fold gallop gesture get give glance go grab greet guard guide hammer head hit hobble
hold hop hug hurdle hurry iron jab jog juggle juke jump kick kneel knock land laugh lay lead lean leap lie lift limp
look lower lunge make march mime mix moonwalk mop move nod offer open pace paint pass pat perform pet pick pivot place
plank play plead point pose pour prance pray press pull punch push put race raise rake reach read rest retreat return
ride rise rock roll rotate row rub run rush salute saw scratch serve shake shiver shoot shovel show shrug shuffle
sidestep sit skate skip slap slash sleep slide slip sneak sneeze somersault spin spread sprint squat stab stagger
stand step stir stomp stoop stop stretch stride stroll strut stumble sway sweep swim swing take talk tap throw tie
tilt tiptoe topple toss touch trip trot trudge tug tumble turn twirl twist type use wait walk waltz wander wash wave
welcome whirl wipe wobble write yawn
""".split()


@cache
def _bases() -> dict[str, str]:
    """Every form of the known verbs -> its base."""
    return {form: verb for verb in VERBS for form in (past(verb), third_person(verb), gerund(verb), verb)}


def is_action(text: str) -> bool:
    """Whether a text begins with a verb, as "turning left" does and "left" does not."""
    first = text.lower().split()[0]
    return first.endswith("ing") or first in _bases()


def _other_forms(bare: str) -> list[str]:
    """The clause, without its subject, in other verb forms; empty if it begins with no known verb."""
    adverb = _ADVERB.match(bare)
    before = adverb[0] if adverb else ""
    verb, space, rest = bare[len(before) :].partition(" ")
    base = _bases().get(verb)
    if base is None:
        return []
    tail = space + rest
    return [
        f"a person {before}{third_person(base)}{tail}",
        f"a person is {before}{gerund(base)}{tail}",
        f"{before}{gerund(base)}{tail}",
    ]


def paraphrases(sentence: str) -> list[str]:
    """A query and up to two paraphrases of it, the query itself first.

    Only the first verb changes, so in "walks, then waves" the rest may disagree with it in form; the model is robust to
    that. Other languages and very long text have no paraphrases.
    """
    plain = " ".join(sentence.lower().split()).strip(" .!?")
    if not plain.isascii() or len(plain.split()) > _LONGEST:
        return [sentence]
    bare = _SUBJECT.sub("", plain, count=1) if _SUBJECT.match(plain) else plain
    return [sentence, *(form for form in _other_forms(bare) if form != plain)][:_MOST]
