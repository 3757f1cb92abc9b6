"""Parsing: human sentences into scenes that the corpus can synthesise, or nothing in case of doubt.

A sentence is split into clauses. The verb of each clause is looked up, its attributes are extracted, and the remaining
words must match a rule of the verb. If words are left over, or a program does not support an attribute, there is no
scene: precision counts, because the sentence becomes a caption of the synthesised motion.
"""

from __future__ import annotations

import re
from dataclasses import dataclass, field, replace

from encoders.corpus.actions.programs import compatible, programs
from encoders.corpus.language.attributes import extract_attributes
from encoders.corpus.language.normalisation import drop_auxiliaries, drop_subject, normalise
from encoders.corpus.language.verbs import ClauseContext, is_verb, lemmas, matches_some_rule, step_of
from encoders.corpus.scene import ActionStep, Scene

_JOINS = re.compile(
    r"(?:^|,? )(?:and )?(then|before|after that|after|while|as (?=he|she|they|it|the)|followed by|finally|next)(?: |$)"
    r"|, and |, | and "
)
_ADVERB = re.compile(r"^((?:very |really |quite |rather )?\w+ly|slightly|briskly|casually|then|also|once again|again) ")
_DENIED = re.compile(r"\b(?:not|without|n't|doesn't|does not|almost|nearly|instead|but|if|or|opposite|another|other)\b")
_COMES_UP = frozenset(
    {"squat", "crouch", "kneel", "bend forward", "pick up", "put down", "bow", "lunge", "duck", "toe touch"}
)
_RETURNS = re.compile(
    r"(?:holds?|holding|held) (?:it|them|that|the pose|the position|this pose)(?: there| up| still)?"
    r"(?: for (?:a |the |some )?\w+(?: \w+)?)?"
    r"|un(?:folds?|folding|folded|cross(?:es|ed|ing)?) (?:it|them|(?:his|her|their|the|both) arms)"
    r"|(?:pulls?|pulling|pulled|lowers?|lowered|lowering|puts?|putting|sets?|brings?|bringing|brought|drops?|dropping|returns?|returning"
    r"|lets?) "
    r"(?:it|them|his|her|their|the|both|back|arms?|hands?|left|right|leg|foot|knee| )*"
    r"(?:back )?(?:down|to (?:his|her|their|the) sides?)(?: again)?"
    r"|(?:stands?|standing|straightens?|straightening|gets?|comes?|rises?|stood)(?: back)? up(?: straight)?(?: again)?"
    r"|(?:returns?|returning|returned|goes|comes|back) (?:back )?to (?:an? |the |his |her |their )?"
    r"(?:original|starting|start|standing|neutral|resting|initial|normal|upright|rest)(?: standing)?"
    r"(?: position| pose| stance| posture)?"
)
_UP = re.compile(r"\b(?:up|standing|upright)\b")
_RISES = {"sit": "stand up", "floor": "get up"}
_LIMB_ALONE = ("hand", "arm", "leg", "foot", "knee")  # "kicks the left leg, then the right leg"
_BENT = ("bend forward", "squat", "crouch", "lean")
_RAISED = ("wave", "salute", "point", "swat")
_NO_VERB = frozenset(
    """
    a an the his her their its both one two three four five left right arms arm hands hand legs leg feet foot head knees
    with in on at from to of by for into onto over under up down out off around back forward backward toward side sides
    clockwise counterclockwise diagonally straight ahead again once twice this that these those while when as if after
    before then than until and or but not no i he she they it who which where there first second finally slightly very
    something someone person man figure body several some each another other also away across above below between along
    slow fast quick hunched tired ready still stationary upright facing all both, inplace upanddown backandforth
    """.split()
)
_REPEATABLE = ("then", "and", ",", "next", "finally")


@dataclass
class ParseReport:
    """The result of parsing a sentence.

    Attributes
    ----------
    scene : Scene or None
        If all of it was parsed.
    verbs : list of (str, bool)
        Main verbs (as written if unknown) and whether the corpus can synthesise them.
    failed : list of str
        Clauses that could not be parsed.
    """

    scene: Scene | None = None
    verbs: list[tuple[str, bool]] = field(default_factory=list)
    failed: list[str] = field(default_factory=list)


@dataclass(frozen=True)
class _Clause:
    words: str
    join: str  # what stands before it: "", "then", "and", ",", "while", "before", "after"


def _head(words: str) -> str:
    """The first word of a clause that may be its verb, "" if none."""
    text = drop_auxiliaries(drop_subject(words))
    while True:
        shorter = _ADVERB.sub("", text, count=1)
        if shorter == text:
            break
        text = drop_auxiliaries(shorter)
    return text.split()[0] if text else ""


def _split(text: str) -> list[_Clause]:
    """Clauses in textual order; "and" and commas split only before a verb."""
    clauses: list[_Clause] = []
    join, start = "", 0
    for match in _JOINS.finditer(text):
        word = match[1] or ("and" if "and" in match[0] else ",")
        weak = word in ("and", ",")
        if match.start() < start:
            continue
        if weak and not is_verb(_head(text[match.end() :])):
            continue
        before = text[start : match.start()].strip(" ,")
        if before:
            clauses.append(_Clause(before, join))
            join = word
        else:
            join = word if join in ("", "and", ",", "then") else join
        start = match.end()
    last = text[start:].strip(" ,")
    return [*clauses, _Clause(last, join)] if last else clauses


def _verb_and_rest(words: str) -> tuple[str, str, str]:
    """Base form of the verb ("" if unknown), the word as written, and the other words with adverbs last."""
    text, adverbs = drop_auxiliaries(drop_subject(words)), []
    while (match := _ADVERB.match(text)) is not None:
        adverbs.append(match[1])
        text = drop_auxiliaries(text[match.end() :])
    verb, _, rest = text.partition(" ")
    return lemmas().get(verb, ""), verb, " ".join([rest, *adverbs]).strip()


def _in_order(clauses: list[_Clause]) -> list[_Clause] | None:
    """Clauses in chronological order: what follows "after" comes first; None if ambiguous."""
    afters = [i for i, clause in enumerate(clauses) if clause.join == "after"]
    if not afters:
        return clauses
    if len(clauses) == 2 and afters == [1]:
        return [_Clause(clauses[1].words, ""), _Clause(clauses[0].words, "then")]
    if len(clauses) == 2 and afters == [0]:
        return [_Clause(clauses[0].words, ""), _Clause(clauses[1].words, "then")]
    return None


class _SceneBuilder:
    """The step groups of a scene, added clause by clause."""

    def __init__(self) -> None:
        self.groups: list[tuple[ActionStep, ...]] = []
        self.lemma = ""

    @property
    def context(self) -> ClauseContext:
        if not self.groups:
            return ClauseContext()
        last = self.groups[-1][0]
        turned = any(step.action == "turn" and step.direction in ("around", "clockwise", "counterclockwise", "")
                     for group in self.groups[-2:] for step in group)  # fmt: skip
        return ClauseContext(programs()[last.action].ends, last.action, turned)

    def beside(self, step: ActionStep) -> bool:
        """Whether a step can be simultaneous with the last group: no body part is needed twice."""
        return bool(self.groups) and compatible(*self.groups[-1], step)

    @property
    def goes(self) -> bool:
        """Whether any step is locomotion."""
        return any(programs()[step.action].group == "locomotion" for group in self.groups for step in group)

    def add(self, step: ActionStep, join: str) -> bool:
        """Add a step after or beside the last group; False if it fits neither."""
        if step.action in ("stand up", "get up"):
            if self.context.action in _COMES_UP:
                return True
            usual = "stand up" if self.groups else step.action
            step = replace(step, action=_RISES.get(self.context.posture, usual))
        if self.groups and self._absorbs(step, join):
            return True
        if self.groups and join in ("while", "as ", "and", ","):
            beside, fits = (*self.groups[-1], step), self.beside(step)
            still = self.groups[-1][-1].action in ("stand", "sit")
            if join in ("while", "as ") or (join == "and" and still and fits):
                if fits:
                    self.groups[-1] = beside
                return fits
        action, posture = programs()[step.action], self.context.posture
        needs_legs = "legs" in action.parts
        if posture and action.starts != posture and not (posture == "stand" and not needs_legs):
            return False
        if not posture and action.starts == "floor" and step.action not in ("crawl", "army crawl", "get up", "lie"):
            return False
        self.groups.append((step,))
        return True

    def _absorbs(self, step: ActionStep, join: str) -> bool:
        """Whether the last step absorbs the new one: two clauses for one movement."""
        last = self.groups[-1][-1]
        if step.action == "stand" and join in ("while", "as ") and programs()[last.action].starts == "stand":
            return True  # "waves while standing"
        if join in ("while", "as ") and step == ActionStep("walk") and programs()[last.action].group == "locomotion":
            return True  # "staggers while walking"
        one = step
        if last.action == "walk" and step.action == "balance beam" and join in ("while", "as ", "and"):
            one = replace(last, action="balance beam") if last.direction in ("", "forward", "backward") else step
        elif last.action in _BENT and step.action in ("pick up", "put down") and step.height in ("", "low"):
            one = replace(step, height="low")  # "bends down and picks something up"
        elif last == ActionStep("stumble") and step == ActionStep("fall") and join == "and":
            one = replace(step, action="trip and fall")  # "trips and falls"
        elif last.action in ("raise arm", "raise hand") and step.action in _RAISED and join == "and":
            sides = ("", *programs()[step.action].sides)
            if step.side in ("", last.side) and last.side in sides:  # "raises the right arm and waves"
                self.groups[-1] = (*self.groups[-1][:-1], replace(step, side=last.side))
                return True
        if one == step:
            return False
        self.groups[-1] = (*self.groups[-1][:-1], one)
        return True


def parse_report(sentence: str) -> ParseReport:
    """Parse a sentence, and report its verbs and the clauses that fail."""
    report, builder = ParseReport(), _SceneBuilder()
    text = normalise(sentence)
    clauses = _in_order(_split(drop_subject(text)))
    if not clauses:
        report.failed.append(text)
        return report
    sure, before = True, ""
    for clause in clauses:
        lemma, verb, rest = _verb_and_rest(clause.words)
        if not verb:
            continue
        if builder.groups and _RETURNS.fullmatch(drop_auxiliaries(drop_subject(clause.words))):
            report.verbs.append((lemma or verb, True))
            last = builder.groups[-1][-1].action
            rests = programs()[last].group in ("gesture", "exercise") and not builder.goes
            if last in _COMES_UP if _UP.search(clause.words) else rests:
                continue
        if (not lemma or lemma == "back") and builder.lemma and clause.join in _REPEATABLE:
            again = re.sub(r"^(?:then |and )?back (?=to the)", "", clause.words)
            found = extract_attributes(again)  # "walks forward, then backward"
            stays = builder.lemma == "move" and not builder.goes  # "moves the arm up, then to the right"
            if ((not found.rest and found.fields) or found.rest in _LIMB_ALONE) and not stays:
                lemma, rest = builder.lemma, again
        found = extract_attributes(rest)
        if lemma or verb not in _NO_VERB:
            report.verbs.append((lemma or verb, bool(lemma) and matches_some_rule(lemma, found)))
        denied = bool(_DENIED.search(clause.words)) and not re.search(
            r"(?:opposite|other) (?:way|direction)|opposite (?:knee|elbow|shoulder)", clause.words
        )
        step = None if found.unsure or denied or not lemma else step_of(lemma, clause.words, found, builder.context)
        join = clause.join
        if step is not None and verb.endswith("ing") and builder.groups:
            aside = join == "," and not before.endswith("ing")  # "walks, looking at the feet"
            if aside and not builder.beside(step) and programs()[step.action].group != "locomotion":
                step = None  # simultaneous, but the body parts conflict
            elif aside or (join == "and" and before.endswith("ing")):  # "walking and waving"
                join = "while" if step is not None and builder.beside(step) else join
        before = verb
        if step is None or not builder.add(step, join):
            sure = False
            report.failed.append(clause.words)
        builder.lemma = lemma
    if sure and builder.groups:
        report.scene = Scene(tuple(builder.groups))
    return report


def parse(sentence: str) -> Scene | None:
    """The scene that a sentence describes; None in case of doubt: every clause must be parsed."""
    return parse_report(sentence).scene
