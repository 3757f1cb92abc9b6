"""What sentences leave open: decided as people act, known as facts, and left out of captions again."""

from __future__ import annotations

import numpy as np

from encoders.corpus.actions.programs import programs
from encoders.corpus.composition.open_scenes import accompanied, complete_scene, open_directions, unmentioned
from encoders.corpus.scene import ActionStep, Scene, StepGroup


def one(action: str) -> Scene:
    return Scene(((ActionStep(action),),))


def test_open_directions_are_directions_of_the_action() -> None:
    for name, program in programs().items():
        assert set(open_directions(name)) <= set(program.directions), name


def test_open_directions_are_the_actions_own_choice() -> None:
    def drawn(action: str) -> set[str]:
        return {complete_scene(one(action), np.random.default_rng(i)).steps[0][0].direction for i in range(60)}

    assert drawn("walk") == {"forward"}
    assert drawn("jump") == {"up", "in place", "forward"}
    assert drawn("lie down") == {"forward", "backward", "left", "right"}
    assert drawn("backflip") == {"backward"}


def test_a_performer_lies_and_sits_the_same_way_throughout() -> None:
    scene = Scene(tuple((ActionStep(action),) for action in ("lie down", "lie", "get up", "sit down", "sit")))
    for seed in range(20):
        lies, *_, sits, sitting = (group[0] for group in complete_scene(scene, np.random.default_rng(seed)).steps)
        assert len({step[0].direction for step in complete_scene(scene, np.random.default_rng(seed)).steps[:3]}) == 1
        assert lies.direction
        assert sits.height == sitting.height != ""


def test_who_carries_something_mostly_walks_and_captions_may_name_the_load_alone() -> None:
    rng = np.random.default_rng(0)
    groups = [accompanied(one("carry"), rng).steps[0] for _ in range(200)]
    walking = [group for group in groups if [step.action for step in group] == ["walk", "carry"]]
    assert 80 < len(walking) < 160
    said: set[StepGroup] = {unmentioned(Scene((walking[0],)), rng).steps[0] for _ in range(20)}
    assert said == {walking[0], walking[0][1:]}


def test_what_a_sentence_says_is_kept() -> None:
    rng = np.random.default_rng(0)
    said = Scene(((ActionStep("walk", direction="backward"), ActionStep("carry")),))
    assert all(accompanied(said, rng) == said for _ in range(50))
