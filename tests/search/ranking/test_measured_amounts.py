"""Repetitions and turns are measured, on synthetic motion of which they are known."""

from __future__ import annotations

import numpy as np
import pytest

from encoders.corpus.composition.scene_clips import make_clip
from encoders.corpus.scene import ActionStep, Scene
from encoders.motion import Motion
from search.query.amounts import Amounts
from search.query.question import EncodedQuestion
from search.ranking.answers import Answer
from search.ranking.by_amounts import MEASURED, bonus, ranked_by_amounts
from search.ranking.measured_amounts import times_done, turned
from search.source import MotionSource
from search.spans import Moment


def made(action: str, **manner: object) -> Motion:
    scene = Scene(((ActionStep(action, **manner),),))  # type: ignore[arg-type]
    return Motion(make_clip(scene, np.random.default_rng(1), variation=0).joints)


@pytest.fixture(scope="module")
def squats() -> dict[int, Motion]:
    return {count: made("squat", count=count) for count in (1, 2, 3, 4)}


def test_repetitions_are_counted(squats: dict[int, Motion]) -> None:
    assert [int(times_done(motion).argmax()) for motion in squats.values()] == list(squats)


def test_nothing_repeats_in_a_motion_of_one_frame_or_without_movement() -> None:
    joints = made("stand").joints
    for still in (joints[:1], joints[:1].repeat(40, axis=0)):
        assert times_done(Motion(still)).max() == 0
        assert turned(Motion(still)) == 0


@pytest.mark.parametrize("count", [1, 2, 3])
def test_turns_are_added_up_with_their_side(count: int) -> None:
    assert turned(made("spin", count=count, direction="counterclockwise")) == pytest.approx(360 * count, abs=15)
    assert turned(made("spin", count=count, direction="clockwise")) == pytest.approx(-360 * count, abs=15)


def test_a_turn_to_the_other_side_does_not_agree() -> None:
    left = made("turn", direction="left")
    asked = Amounts(degrees=abs(turned(left)), side=1)
    assert bonus(left, asked) > 0.45
    assert bonus(left.mirror(), asked) < 0.01


def answers(motions: list[Motion]) -> list[Answer]:
    return [Answer(MotionSource.of_motion(m), Moment(0, m.duration, 0.5, 0.5), (0.5,)) for m in motions]


def question(sentence: str) -> EncodedQuestion:
    return EncodedQuestion(np.zeros((1, 4), np.float32), (sentence,))


def test_what_agrees_comes_first_and_later_answers_stay(squats: dict[int, Motion]) -> None:
    given = answers([squats[1], squats[4], squats[3], *[squats[1]] * MEASURED, squats[3]])
    ranked = list(ranked_by_amounts(question("squats three times"), iter(given)))
    assert ranked[0] is given[2]
    assert ranked[-1] is given[-1]
    assert len(ranked) == len(given)
    assert list(ranked_by_amounts(question("squats"), iter(given))) == given
