"""Caption generation: random human-like descriptions of a scene.

Every caption is true of its scene, but need not be complete. Kinds: full sentences, gerund fragments, short labels,
clauses about one part of the body, one step out of several.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from encoders.corpus.language.clause import Clause, choose_phrase, fill, make_clause, only_fields
from encoders.corpus.language.lexicon import modifier
from encoders.corpus.language.subjects import Subject, draw_subject, no_subject, with_adjective
from encoders.corpus.language.typing_noise import add_typing_noise, as_file_name
from encoders.corpus.language.weighted_choice import RandomSource, pick, pick_early, pick_weighted
from encoders.corpus.scene import Scene, StepGroup
from encoders.english import plural_form

_KINDS = ("sentence", "fragment", "label", "part")
_KIND_WEIGHTS_ONE = (0.59, 0.16, 0.19, 0.06)
_FILE_NAMES = 0.2  # share of labels written as names of files
_KIND_WEIGHTS_MANY = (0.78, 0.15, 0.07, 0.0)
_SEEMS = ("looks like {they_are} [ing]", "appears to be [ing]", "seems to be [ing]", "starts [ing]", "begins to [base]",
          "starts to [base]", "is seen [ing]", "appears to [base]", "seems to [base]", "is busy [ing]",
          "is shown [ing]", "can be seen [ing]", "is in the middle of [ing]", "proceeds to [base]")  # fmt: skip
_SEEMS_PLURAL = ("look like they are [ing]", "appear to be [ing]", "seem to be [ing]", "start [ing]", "begin to [base]")
_AT_ONCE = ("while {ing}", "{ing}", "as {they}", "and {same}", "and {same} at the same time", "whilst {ing}")
_AT_ONCE_WEIGHTS = (0.47, 0.2, 0.1, 0.1, 0.08, 0.05)
_JOINS = (" then {same}", " and then {same}", ", then {same}", " and {same}", ", and then {same}", ", {same}",
          " and after that {same}", ", next {same}", " before {ing}", " followed by {ing}", ", finally {ing}",
          " and finally {same}")  # fmt: skip
_JOIN_WEIGHTS = (0.3, 0.16, 0.13, 0.14, 0.05, 0.03, 0.02, 0.02, 0.09, 0.02, 0.02, 0.02)
_PLAIN = 8  # number of joins, from the first, that keep the verb form and fit anywhere
_LAST_OF_LIST = (", and ", ", then ", " and then ", ", and then ", " and ")
_LIKE_DOING = ("as if {x}", "as if {they_are} {x}", "like {they_are} {x}", "as though {x}", "as if {they_were} {x}")
_LIKE_CLAUSE = ("as if {x}", "like {x}", "as though {x}")
_POSTURES = frozenset({"stand", "idle", "stand still"})  # omitted beside a gesture
_OPENERS = ("", "", "", "", "", "", "", "", "first ", "at first ")


def _verb_form(subject: Subject, tense: str) -> str:
    """The verb form for a subject and a tense: "present", "continuous", "past", "was" or "bare"."""
    if tense == "present":
        return "base" if subject.plural else "third"
    if tense == "continuous":
        return "are" if subject.plural else "is"
    if tense == "was":
        return "were" if subject.plural else "was"
    return {"past": "past", "bare": "ing"}[tense]


def _draw_tense(rng: RandomSource) -> str:
    return pick_weighted(rng, ("present", "continuous", "past", "was", "bare"), (0.56, 0.26, 0.09, 0.02, 0.07))


def _as_if(group: StepGroup, subject: Subject, rng: RandomSource) -> str:
    """A comparison, "as if climbing a rope", or ""."""
    step = pick(rng, group)
    phrase = choose_phrase(step, "as_if", rng)
    if phrase is None:
        return ""
    doing = phrase.text.split()[0].endswith("ing") and not phrase.text.startswith("something")
    return fill(pick_early(rng, _LIKE_DOING if doing else _LIKE_CLAUSE).replace("{x}", phrase.text), step, subject, rng)


@dataclass(frozen=True)
class ClauseGroup:
    """The clauses of one step group, with the join of each further clause to the first."""

    subject: Subject
    clauses: tuple[Clause, ...]
    joins: tuple[str, ...]

    @property
    def mentioned(self) -> StepGroup:
        return tuple(clause.mentioned for clause in self.clauses)

    def inflected(self, form: str) -> str:
        """The clauses with the first one in a verb form; see `Clause.inflected`."""
        same = "ing" if form in ("is", "are", "was", "were") else form
        agreeing = "base" if self.subject.pronoun == "they" else "third"
        words = self.clauses[0].inflected(form)
        for join, clause in zip(self.joins, self.clauses[1:], strict=True):
            words += " " + (
                join.replace("{ing}", clause.inflected("ing"))
                .replace("{same}", clause.inflected(same))
                .replace("{they}", f"{self.subject.pronoun} {clause.inflected(agreeing)}")
            )
        return words


def _clause_group(
    group: StepGroup, subject: Subject, rng: RandomSource, without: frozenset[str] = frozenset()
) -> ClauseGroup:
    """The clauses of a step group; standing is often omitted."""
    shown = [step for step in group if step.action not in _POSTURES] if rng.random() < 0.6 else list(group)
    shown = shown or list(group)
    if len(shown) > 1 and rng.random() < 0.5:
        shown = shown[::-1]
    return ClauseGroup(
        subject,
        tuple(make_clause(step, subject, rng, without=without) for step in shown),
        tuple(pick_weighted(rng, _AT_ONCE, _AT_ONCE_WEIGHTS) for _ in shown[1:]),
    )


@dataclass(frozen=True)
class GeneratedCaption:
    """A caption and the scene that it states: the described one without what the words omit."""

    text: str
    scene: Scene


def _generated(text: str, parts: Sequence[ClauseGroup]) -> GeneratedCaption:
    return GeneratedCaption(text, Scene(tuple(part.mentioned for part in parts)))


def _joined(parts: Sequence[ClauseGroup], forms: Sequence[str], rng: RandomSource, *, plain: bool = False) -> str:
    """Clauses in order, joined at random; `plain` joins only with "then", "and" and commas."""
    texts = [part.inflected(form) for part, form in zip(parts, forms, strict=True)]
    if len(texts) > 2 and rng.random() < 0.35:
        return ", ".join(texts[:-1]) + pick(rng, _LAST_OF_LIST) + texts[-1]
    text = texts[0]
    for i in range(1, len(texts)):
        usable = _PLAIN if plain or i < len(texts) - 1 else len(_JOINS)
        join = pick_weighted(rng, _JOINS[:usable], _JOIN_WEIGHTS[:usable])
        text += join.replace("{ing}", parts[i].inflected("ing")).replace("{same}", texts[i])
    return text


def _sentence(groups: Sequence[StepGroup], rng: RandomSource) -> GeneratedCaption:
    subject = draw_subject(rng)
    without: frozenset[str] = frozenset()
    styles = {step.style for group in groups for step in group}
    if len(styles) == 1 and "" not in styles:
        adjectives = modifier("", "style", next(iter(styles))).get("adjective", [])
        styled = with_adjective(subject, pick_early(rng, adjectives)) if adjectives and rng.random() < 0.25 else None
        if styled is not None:
            subject, without = styled, frozenset({"style"})
    parts = [_clause_group(group, subject, rng, without) for group in groups]
    if len(parts) == 1:
        return _generated(_single_sentence(groups[0], parts[0], rng), parts)
    form = _verb_form(subject, _draw_tense(rng))
    if len(parts) == 2 and rng.random() < 0.09:
        if rng.random() < 0.67:
            return _generated(f"after {parts[0].inflected('ing')}, {subject.text} {parts[1].inflected(form)}", parts)
        return _generated(f"{subject.text} {parts[1].inflected(form)} after {parts[0].inflected('ing')}", parts)
    later = "ing" if form in ("is", "are", "was", "were") and rng.random() < 0.7 else form
    text = _joined(parts, [form] + [later] * (len(parts) - 1), rng)
    opener = pick(rng, _OPENERS) if " " in subject.text else ""
    return _generated(f"{opener}{subject.text} {text}", parts)


def _single_sentence(group: StepGroup, words: ClauseGroup, rng: RandomSource) -> str:
    """A sentence of one group: plain, hedged ("appears to be ..."), or with a comparison."""
    subject = words.subject
    ending = _as_if(group, subject, rng) if rng.random() < 0.12 else ""
    if rng.random() < 0.06:
        seems = pick(rng, _SEEMS_PLURAL if subject.plural else _SEEMS)
        predicate = fill(seems, group[0], subject, rng)
        predicate = predicate.replace("[ing]", words.inflected("ing")).replace("[base]", words.inflected("base"))
    else:
        predicate = words.inflected(_verb_form(subject, _draw_tense(rng)))
    return " ".join(filter(None, (subject.text, predicate, ending)))


def _fragment(groups: Sequence[StepGroup], rng: RandomSource) -> GeneratedCaption:
    subject = no_subject(rng)
    parts = [_clause_group(group, subject, rng) for group in groups]
    text = _joined(parts, ["ing"] * len(parts), rng)
    if len(groups) == 1 and rng.random() < 0.1:
        text = " ".join(filter(None, (text, _as_if(groups[0], subject, rng))))
    return _generated(text, parts)


def _label(groups: Sequence[StepGroup], rng: RandomSource) -> GeneratedCaption:
    subject = no_subject(rng)
    if len(groups) == 1 and len(groups[0]) == 1 and rng.random() < 0.55:
        step = groups[0][0]
        noun = choose_phrase(step, "nouns", rng)
        if noun is not None:
            label = fill(noun.text, step, subject, rng)
            label = as_file_name(label, rng) if rng.random() < _FILE_NAMES else label
            return GeneratedCaption(label, Scene(((only_fields(step, noun.mentioned_fields(step)),),)))
    parts = [_clause_group(group, subject, rng) for group in groups]
    text = _joined(parts, ["base"] * len(parts), rng, plain=True)
    for possessive in (" their ", " his ", " her ", " the "):
        text = text.replace(possessive, " ") if rng.random() < 0.5 else text
    return _generated(text, parts)


def _part(groups: Sequence[StepGroup], rng: RandomSource) -> GeneratedCaption:
    """A clause about one part of the body, or a fragment if the action has none."""
    step = pick(rng, groups[0])
    phrase = choose_phrase(step, "parts", rng)
    if phrase is None:
        return _fragment(((step,),), rng)
    words = phrase.text.split()
    if step.side == "both" and words[0].startswith("{") and words[0] != "{p}":
        verbs = [1, *(i + 1 for i, word in enumerate(words[:-1]) if word == "and")]
        words = [plural_form(word) if i in verbs else word for i, word in enumerate(words)]
    text = fill(" ".join(words), step, no_subject(rng), rng)
    return GeneratedCaption(text, Scene(((only_fields(step, phrase.mentioned_fields(step)),),)))


def _described_groups(scene: Scene, rng: RandomSource) -> Sequence[StepGroup]:
    """The groups that a caption describes, in order: nearly always all, of a long scene sometimes a subset."""
    groups = scene.steps
    if len(groups) >= 3 and rng.random() < 0.12:
        skipped = int(rng.random() * len(groups))
        groups = tuple(group for i, group in enumerate(groups) if i != skipped)
    elif len(groups) > 1 and rng.random() < 0.03:
        groups = (pick(rng, groups),)
    if len(groups) > 1 and rng.random() < 0.7:
        kept = tuple(group for group in groups if any(step.action not in _POSTURES for step in group))
        groups = kept or groups
    if any(len(group) > 1 for group in groups) and rng.random() < 0.08:
        groups = tuple((pick(rng, group),) for group in groups)
    return groups


def describe(scene: Scene, rng: RandomSource) -> GeneratedCaption:
    """One caption of `scene`, with the part of the scene that it states."""
    groups = _described_groups(scene, rng)
    weights = _KIND_WEIGHTS_ONE if len(groups) == 1 else _KIND_WEIGHTS_MANY
    kind = pick_weighted(rng, _KINDS, weights)
    write = {"sentence": _sentence, "fragment": _fragment, "label": _label, "part": _part}[kind]
    caption = write(groups, rng)
    return GeneratedCaption(add_typing_noise(caption.text, rng), caption.scene)


def captions(scene: Scene, rng: RandomSource, n: int, held_out: Callable[[str], bool] | None = None) -> list[str]:
    """`n` captions of `scene`, distinct if the scene allows it.

    Parameters
    ----------
    scene : Scene
        Every action must have an entry in the lexicon.
    rng : numpy.random.Generator or random.Random
        Random state.
    n : int
        Number of captions.
    held_out : callable, optional
        True for sentences that must not be returned.

    Raises
    ------
    KeyError
        If an action has no phrases.
    """
    found: list[str] = []
    for attempt in range(20 * n):
        text = describe(scene, rng).text
        if held_out is not None and held_out(text):
            continue
        if text not in found or attempt > 8 * n:
            found.append(text)
        if len(found) == n:
            break
    return found
