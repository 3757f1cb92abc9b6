"""Facts, and which scenes a caption describes."""

from __future__ import annotations

import numpy as np
import pytest

from encoders.corpus.actions.programs import programs
from encoders.corpus.composition.facts import HYPERNYMS, Underspecified, entailment_of_indices, facts
from encoders.corpus.scene import ActionStep, Scene


def one(action: str, **attributes: object) -> Scene:
    return Scene(((ActionStep(action, **attributes),),))  # type: ignore[arg-type]


def sequence(*actions: str) -> Scene:
    return Scene(tuple((ActionStep(action),) for action in actions))


@pytest.mark.parametrize(
    ("said", "shown"),
    [
        (one("walk"), one("walk", direction="left", speed="slow")),
        (one("walk", direction="left"), one("walk", direction="left", style="drunk")),
        (one("run"), one("jog")),
        (one("run", direction="left"), one("sprint", direction="left", speed="fast")),
        (one("run", speed="fast"), one("sprint")),
        (one("sprint"), one("run", speed="fast")),
        (one("walk", direction="left"), one("walk", direction="forward-left")),
        (one("walk", direction="backward"), one("walk", direction="backward-left")),
        (one("turn", degrees=180), one("turn", direction="around")),
        (one("turn", direction="around"), one("turn", direction="left", degrees=180)),
        (one("turn", degrees=360), one("spin", count=1)),
        (one("fall"), one("trip and fall")),
        (one("jump"), sequence("walk", "jump")),
        (sequence("walk", "sit"), sequence("walk", "jump", "sit")),
        (sequence("walk", "run"), sequence("limp", "sprint")),
        (Scene(((ActionStep("walk"), ActionStep("wave")),)), Scene(((ActionStep("wave"), ActionStep("limp")),))),
    ],
)
def test_a_caption_entails_all_its_facts(said: Scene, shown: Scene) -> None:
    assert facts(said) <= facts(shown)


@pytest.mark.parametrize(
    ("said", "shown"),
    [
        (one("walk", direction="left"), one("walk", direction="right")),
        (one("walk", direction="left"), one("walk")),
        (one("kick", count=3), one("kick", count=2)),
        (one("jog"), one("run")),
        (one("sprint"), one("run")),
        (one("walk", direction="backward-left"), one("walk", direction="backward")),
        (sequence("walk", "sit"), sequence("sit", "walk")),
        (Scene(((ActionStep("walk"), ActionStep("wave")),)), sequence("walk", "wave")),
        (one("turn", degrees=90), one("turn", degrees=180)),
    ],
)
def test_a_caption_does_not_describe_a_scene_with_one_contrary_fact(said: Scene, shown: Scene) -> None:
    assert not facts(said) <= facts(shown)


def test_hypernyms_are_programs() -> None:
    assert {*HYPERNYMS, *HYPERNYMS.values()} <= set(programs())


def test_entailment_needs_all_facts_and_is_false_for_an_empty_meaning() -> None:
    holds = entailment_of_indices([[0], [0, 1], [2], []], [[0], [0, 1], [0, 1, 2]], 3)
    assert holds.tolist() == [[True, True, True], [False, True, True], [False, False, True], [False] * 3]
    assert holds.dtype == np.bool_


@pytest.mark.parametrize(
    ("said", "shown", "expected"),
    [
        (one("walk"), one("walk", direction="backward"), True),
        (one("walk"), one("sneak"), True),
        (one("walk", direction="forward"), one("sneak", direction="forward"), True),
        (one("run"), one("sprint"), True),
        (one("run"), one("jog"), False),
        (one("walk"), one("walk", direction="forward", style="sad"), False),
        (one("run", speed="fast"), one("sprint"), False),
        (one("walk", style="drunk"), one("sneak", style="drunk"), False),
        (one("wave"), sequence("sneak", "wave"), False),
        (one("wave"), one("wave", side="both"), True),
        (one("wave"), one("wave", side="right"), False),
        (one("wave", speed="slow"), one("wave", side="both", speed="slow"), True),
        (one("wave", side="both"), one("wave", side="both"), False),
        (one("walk", direction="backward"), one("walk", direction="backward"), False),
        (one("jump"), one("jump", direction="up"), False),  # where an unspecified jump may go as well
        (one("jump"), one("jump", direction="backward"), True),
        (one("lie down"), one("lie down", direction="left"), False),
    ],
)
def test_captions_that_omit_a_salient_attribute_are_underspecified(said: Scene, shown: Scene, expected: bool) -> None:
    vocabulary = sorted(facts(said) | facts(shown))
    rows = [[vocabulary.index(fact) for fact in facts(scene)] for scene in (said, shown)]
    assert Underspecified(vocabulary)(rows[:1], rows[1:]).item() is expected
