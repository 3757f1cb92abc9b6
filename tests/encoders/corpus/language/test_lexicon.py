"""The phrase tables cover every program and fill every slot."""

from __future__ import annotations

import random

from encoders.corpus.actions.programs import programs
from encoders.corpus.language.clause import choose_phrase, fill
from encoders.corpus.language.coverage import phrase_counts
from encoders.corpus.language.lexicon import entries, entry_of
from encoders.corpus.language.subjects import Subject
from encoders.corpus.scene import ActionStep

COMMON = "walk run wave bow sit_down punch kick throw clap point guide turn jump".split()


def test_every_program_has_phrases() -> None:
    assert [name for name in programs() if entry_of(name) is None] == []


def test_common_actions_have_sixty_phrases_and_all_have_ten() -> None:
    counts = phrase_counts()
    assert {name: counts[name] for name in COMMON if counts[name] < 60} == {}
    assert {name: count for name, count in counts.items() if count < 10} == {}


def test_every_legal_step_has_a_verb_phrase_with_all_slots_filled() -> None:
    rng = random.Random(1)
    person = Subject("a person", "they")
    for name, program in programs().items():
        for side in ("", *program.sides):
            for direction in ("", *program.directions):
                step = ActionStep(name, side=side, direction=direction)
                phrase = choose_phrase(step, "verbs", rng)
                assert phrase is not None, step
                assert "{" not in fill(phrase.text, step, person, rng)


def test_phrases_use_no_unknown_slot() -> None:
    rng = random.Random(2)
    person = Subject("a person", "they")
    for entry in entries().values():
        for kind in ("verbs", "nouns", "parts", "as_if"):
            for phrase in entry.phrases(kind):
                step = ActionStep(entry.action, side="left", direction="left", count=2)
                assert "{" not in fill(phrase.text, step, person, rng)
