"""The clause of one step: a verb phrase with its modifiers, in any verb form."""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import dataclass, replace
from functools import lru_cache

from encoders.corpus.language.lexicon import FIELDS, LIMBS, Phrase, entry_of, modifier, phrases_for
from encoders.corpus.language.subjects import Subject
from encoders.corpus.language.weighted_choice import RandomSource, pick, pick_early
from encoders.corpus.scene import ActionStep
from encoders.english import indefinite, inflect, number_word, times

MENTIONED = 0.85  # share of the specified fields that a caption mentions
_DEGREES, _ONCE = 0.25, 0.35  # the same of angles, and of counts of one, which people seldom give
_VAGUE = 0.2  # share of counts above two that are not told
_SEVERAL_TIMES = (
    "several times", "repeatedly", "multiple times", "a few times", "over and over", "again and again",
)  # fmt: skip
_SLOT = re.compile(r"\{(\w+)(?::([^}]+))?\}")
_PLURALS = {"foot": "feet", "palm": "palms", "fingers": "fingers"}
_SIDE_PHRASES = (
    "with {p} {side} {limb}",
    "with the {side} {limb}",
    "using {p} {side} {limb}",
    "using the {side} {limb}",
)
_BOTH_PHRASES = ("with both {limbs}", "using both {limbs}", "with both of {p} {limbs}")
_HEADINGS = ("to the {side}", "{side}", "to {p} {side}", "towards the {side}", "to the {side} side")
_PREVERBAL = ("speed", "style")  # fields whose adverb may stand before the verb


@dataclass(frozen=True)
class Clause:
    """A verb phrase with its slots filled, ready for any verb form.

    Attributes
    ----------
    text : str
        Base form, verbs marked with "~".
    adverb : str
        Precedes the first verb; may be empty.
    tail : str
        Modifiers after the verb phrase; may be empty.
    mentioned : ActionStep
        The step without the fields that the clause omits.
    """

    text: str
    mentioned: ActionStep
    adverb: str = ""
    tail: str = ""

    def inflected(self, form: str) -> str:
        """The clause in a verb form: "base", "third", "ing", "past", or "is", "are", "was", "were" with a gerund."""
        helper, form = (form, "ing") if form in ("is", "are", "was", "were") else ("", form)
        words = [inflect(word[1:], form) if word.startswith("~") else word for word in self.text.split()]
        if self.adverb:
            first = next(i for i, word in enumerate(self.text.split()) if word.startswith("~"))
            words.insert(first, self.adverb)
        return " ".join(filter(None, (helper, *words, self.tail)))


@lru_cache(maxsize=20000)
def mark_verbs(text: str) -> str:
    """Mark the first word as a verb unless it is an adverb before a marked one: "quickly ~run"."""
    first = text.split()[0]
    adverb = "~" in text and (first.endswith("ly") or first == "almost")
    return text if adverb or text.startswith("~") else "~" + text


def _limb(name: str, side: str, rng: RandomSource) -> str:
    plural = _PLURALS.get(name, name + "s")
    if side == "both":
        return pick(rng, (f"both {plural}", f"{{p}} {plural}", f"both {{p}} {plural}", f"both {plural}"))
    if side:
        return pick(rng, (f"{{p}} {side} {name}", f"{{p}} {side} {name}", f"the {side} {name}"))
    return pick(rng, (f"{indefinite(name)}", f"one {name}", f"{{p}} {name}", f"{{p}} {name}"))


def _counted(noun: str, count: int, rng: RandomSource) -> str:
    if count == 1:
        return pick(rng, (indefinite(noun), f"one {noun}", f"a single {noun}"))
    plural = noun + ("es" if noun.endswith(("ch", "sh", "s", "x")) else "s")
    if count:
        return f"{number_word(count) if rng.random() < 0.75 else count} {plural}"
    return pick(rng, (f"a few {plural}", f"some {plural}", f"several {plural}"))


def fill(text: str, step: ActionStep, subject: Subject, rng: RandomSource) -> str:
    """`text` with every slot filled from the step and the subject."""

    def value(match: re.Match[str]) -> str:
        name, noun = match[1], match[2]
        if name in LIMBS:
            return _limb(name, step.side, rng)
        if name == "n":
            return _counted(noun, step.count, rng) if noun else number_word(step.count)
        if name == "dir":
            ways = modifier(step.action, "direction", step.direction).get("after", [""])
            return pick_early(rng, ways)
        return {
            "side": step.side,
            "other": "left" if step.side == "right" else "right",
        }.get(name, match[0])

    def agree(match: re.Match[str]) -> str:
        return {
            "p": subject.possessive,
            "self": subject.reflexive,
            "they": subject.pronoun,
            "they_are": f"{subject.pronoun} {subject.be()}",
            "they_were": f"{subject.pronoun} {subject.be(past=True)}",
            "they_have": f"{subject.pronoun} {subject.have}",
        }[match[1]]

    while "{" in text:
        filled = _SLOT.sub(value, text)
        text = _SLOT.sub(agree, filled) if filled == text else filled
    return " ".join(text.split())


def _side_words(step: ActionStep, limb: str, rng: RandomSource) -> str:
    if limb == "heading":
        return pick_early(rng, _HEADINGS).replace("{side}", step.side)
    plural = _PLURALS.get(limb, limb + "s")
    if step.side == "both":
        return pick_early(rng, _BOTH_PHRASES).replace("{limbs}", plural)
    return pick_early(rng, _SIDE_PHRASES).replace("{side}", step.side).replace("{limb}", limb)


def _modifiers(step: ActionStep, fields: set[str], limb: str, rng: RandomSource) -> tuple[str, list[str]]:
    """Modifiers for the given fields: an adverb before the verb, and the phrases after it."""
    adverb, after = "", []
    if "direction" in fields:
        after.append(pick_early(rng, modifier(step.action, "direction", step.direction).get("after", [""])))
    if "side" in fields and (limb != "heading" or step.side != "both"):
        after.append(_side_words(step, limb, rng))
    for field in ("height", "amplitude", "speed", "style"):
        if field not in fields:
            continue
        phrases = modifier(step.action, field, getattr(step, field))
        adverbs, tails = phrases.get("adverb", []), phrases.get("after", [])
        if not adverb and adverbs and field != "height" and rng.random() < 0.4:
            adverb = pick_early(rng, adverbs)
        elif options := [*adverbs, *tails]:
            after.append(pick_early(rng, options))
    if "degrees" in fields:
        after.insert(0, pick_early(rng, modifier(step.action, "degrees", str(step.degrees)).get("after", [""])))
    if "count" in fields:
        after.insert(min(len(after), 1 if rng.random() < 0.5 else 9), pick_early(rng, times(step.count)))
    return adverb, after


def choose_phrase(step: ActionStep, kind: str, rng: RandomSource) -> Phrase | None:
    """A phrase of a kind that fits the step; special cases and common words more often."""
    groups = phrases_for(step, kind)
    if not groups:
        return None
    sizes = [len(group) for group in groups]
    # special cases together are as likely as the general list, even if they are few
    special = len(groups) > 1 and rng.random() < 0.5
    chosen = pick(rng, groups[:-1]) if special else groups[int(rng.random() * len(groups)) if min(sizes) > 8 else -1]
    return pick_early(rng, chosen)


def _told(field: str, step: ActionStep) -> float:
    """Share of captions that mention a specified field."""
    if field == "degrees":
        return _DEGREES
    return _ONCE if field == "count" and step.count == 1 else MENTIONED


def make_clause(
    step: ActionStep, subject: Subject, rng: RandomSource, *, without: frozenset[str] = frozenset()
) -> Clause:
    """The clause of a step; fields in `without` are mentioned elsewhere in the caption."""
    phrase = choose_phrase(step, "verbs", rng)
    if phrase is None:
        raise KeyError(f"no verbs for {step}")
    entry = entry_of(step.action)
    assert entry is not None
    set_fields = {field for field in FIELDS if getattr(step, field)}
    open_fields = [field for field in FIELDS if field in set_fields - phrase.mentioned_fields(step) - without]
    to_mention = {
        field for field in open_fields if field not in entry.never_mentioned and rng.random() < _told(field, step)
    }
    vague = "count" in to_mention and rng.random() < _VAGUE and step.count > 2
    to_mention -= {"count"} if vague else set()
    adverb, after = _modifiers(step, to_mention, entry.limb, rng)
    after += [pick_early(rng, _SEVERAL_TIMES)] if vague else []
    return Clause(
        text=fill(mark_verbs(phrase.text), step, subject, rng),
        mentioned=without_fields(step, set(open_fields) - to_mention),
        adverb=fill(adverb, step, subject, rng),
        tail=fill(" ".join(after), step, subject, rng),
    )


def without_fields(step: ActionStep, fields: Iterable[str]) -> ActionStep:
    """The step with `fields` unspecified."""
    return replace(step, **{field: type(getattr(step, field))() for field in fields})


def only_fields(step: ActionStep, fields: Iterable[str]) -> ActionStep:
    """The step with all fields but `fields` unspecified."""
    return without_fields(step, set(FIELDS) - set(fields))
