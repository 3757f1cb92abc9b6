"""What a sentence asks for, and what it takes away."""

from __future__ import annotations

from itertools import product

import numpy as np
import pytest

from search.query import languages
from search.query.encoding import encode_queries, taken_away
from search.query.known_words import lexicon
from search.query.negation import ANYTHING, STILL, Parts, parts_of
from search.query.wording import remark
from tests.search.answers import KnownAnswers

WANTED = ("walks", "a person kicks with the left leg", "does jumping-jacks", "waves and turns")
UNWANTED = ("turning", "swinging the arms", "forward", "with the right hand", "a T-pose")
FORMS = ("{0} without {1}", "{0}, not {1}", "{0} but not {1}", "{0} and not {1}", '{0} -"{1}"', "{0}, without {1}.")


@pytest.mark.parametrize("form", FORMS)
def test_every_form_takes_away_what_it_negates_and_leaves_the_rest(form: str) -> None:
    for wanted, unwanted in product(WANTED, UNWANTED):
        assert parts_of(form.format(wanted, unwanted)) == Parts(wanted, (unwanted,))


@pytest.mark.parametrize(
    ("sentence", "wanted", "unwanted"),
    [
        ("kicks -left", "kicks", ["left"]),
        ("-left kicks", "kicks", ["left"]),
        ('sits down -chair -"on the floor"', "sits down", ["chair", "on the floor"]),
        ("runs and never falls", "runs", ["falls"]),
        ("walks and doesn't stop", "walks", ["stop"]),
        ("walks and doesn’t stop", "walks", ["stop"]),
        ("walks but isnt limping", "walks", ["limping"]),
        ("a person who is not walking but running", "a person running", ["walking"]),
        ("kicks not left but right", "kicks right", ["left"]),
        ("does not walk but runs", "runs", ["walk"]),
        ("runs instead of walking", "runs", ["walking"]),
        ("walks with no arm swing", "walks", ["arm swing"]),
        ("walks, but not too fast", "walks", ["fast"]),
        ("without stopping, a person walks forward", "a person walks forward", ["stopping"]),
        ("runs without turning, jumping or falling", "runs", ["turning", "jumping", "falling"]),
        ("a person walks, not turning, not stopping", "a person walks", ["turning", "stopping"]),
        ("walks without swinging the arms and waves", "walks and waves", ["swinging the arms"]),
        ("walks without turning, jumps and lands", "walks, jumps and lands", ["turning"]),
        ("walks without turning while waving", "walks while waving", ["turning"]),
        ("walks and the arms do not swing", "walks", ["the arms swing"]),
        ("jumps, her heels never leave the floor", "jumps", ["her heels leave the floor"]),
        ("jumps not to the left", "jumps", ["to the left"]),
        ("kicks with the left foot not moving the arms", "kicks with the left foot", ["moving the arms"]),
        ("stumbles over, but he doesn't fall", "stumbles over", ["fall"]),
        ("throws a ball and catches it, not falling", "throws a ball and catches it", ["falling"]),
        ("jumps, not high, over a box", "jumps, over a box", ["high"]),
        ("walks and no jumping", "walks", ["jumping"]),
        ("walks but no turns", "walks", ["turns"]),
        ("no jumping, walks", "walks", ["jumping"]),
        ("reaches up, does not jump because it is low", "reaches up, because it is low", ["jump"]),
    ],
)
def test_a_negation_reaches_as_far_as_people_mean_it(sentence: str, wanted: str, unwanted: list[str]) -> None:
    assert parts_of(sentence) == Parts(wanted, tuple(unwanted))


@pytest.mark.parametrize(
    "sentence",
    [
        "walks forward",
        "nothing happens",
        "ties a knot and notes it",
        "not only walks but also waves",
        "does a jumping-jack, a side-step and sit-ups",
        "stands in a T-pose",
        "walks - slowly",
        "turns -90 degrees",
        "walks in a c -shape",
        "balances, trying not to fall",
        "walks as if not wanting to be seen",
        "walks without a care",
        "shakes the head no",
        "makes an i don't know gesture",
        "a no-look pass",
        "no-look pass",
        "no",
        "no, it sits down",
        "waves and says no",
        "take_-left_02",
        "sits down without it",
        "walks, not",
        "without",
        "-",
        "人が歩く",
    ],
)
def test_other_words_take_nothing_away(sentence: str) -> None:
    assert parts_of(sentence) == Parts(sentence)


def test_who_never_stops_goes_on() -> None:
    assert parts_of("someone who never stops dancing") == Parts("someone dancing")


@pytest.mark.parametrize(
    "sentence",
    [
        "not walking",
        "a person isn't walking",
        "anything except walking",
        "-walking",
        "no walking",
        "anything but walking",
        "nobody is walking",
    ],
)
def test_where_nothing_is_asked_for_anybody_is(sentence: str) -> None:
    assert parts_of(sentence) == Parts(ANYTHING, ("walking",), True)


def test_who_does_not_move_stands_still() -> None:
    assert parts_of("a person is not moving") == Parts(STILL, ("moving",), True)
    assert parts_of("nobody moves") == Parts(STILL, ("moves",), True)
    assert parts_of(f"{STILL}, not moving") == Parts(STILL, ("moving",)), "which is asked for in words"
    assert parts_of("lies without moving") == Parts("lies", ("moving",))


@pytest.mark.skipif(not languages.is_installed(), reason="needs the extra languages")
@pytest.mark.parametrize(
    ("sentence", "wanted", "unwanted"),
    [
        ("ein Mensch geht ohne die Arme zu schwingen", "ein Mensch geht", "die Arme zu schwingen"),
        ("ein Mensch springt, aber nicht nach vorne", "ein Mensch springt", "nach vorne"),
        ("une personne marche sans bouger les bras", "une personne marche", "bouger les bras"),
        ("una persona camina sin girar", "una persona camina", "girar"),
        ("eine Person tritt mit dem Bein -links", "eine Person tritt mit dem Bein", "links"),
    ],
)
def test_other_languages_take_away_by_their_own_words(sentence: str, wanted: str, unwanted: str) -> None:
    assert parts_of(sentence) == Parts(wanted, (unwanted,))


@pytest.mark.parametrize("count", [1, 2, 8])
def test_a_question_is_less_like_what_is_taken_away_and_stays_like_what_is_asked_for(count: int) -> None:
    for vectors in np.random.default_rng(0).normal(size=(50, count + 1, 64)).astype(np.float32):
        wanted, *unwanted = vectors / np.linalg.norm(vectors, axis=1, keepdims=True)
        left = taken_away(wanted, np.stack(unwanted))
        assert np.linalg.norm(left) == pytest.approx(1, abs=1e-5)
        assert left @ wanted > 0.7
        assert np.mean(unwanted @ left) < np.mean(unwanted @ wanted)
        assert np.allclose(taken_away(wanted, -wanted[None]), wanted, atol=1e-6), "what is its opposite already"


def test_a_part_of_the_vector_of_what_is_taken_away_is_subtracted() -> None:
    encoder = KnownAnswers()
    plain = encoder.encode_texts(["one", "two"])
    vectors = encode_queries(encoder, ["one", "one -two", "one, not two or three", "two"])
    assert np.array_equal(vectors[[0, 3]], plain), "as without any negation beside them"
    one, two, three = vectors[1:3, 1], vectors[1:3, 2], vectors[1:3, 3]
    assert (one > 0.9).all()
    assert two[0] < two[1] < 0, "of several things each counts less"
    assert three[0] == 0 > three[1]


def test_what_is_taken_away_is_said() -> None:
    known = lexicon(["a person walks", "kicks left", "stop moving"])
    assert remark("kicks -left", known) == 'taken away: "left"'
    assert remark("a person walks and doesn't stop", known) == 'taken away: "stop"'
    assert remark("a person not kicking", known).startswith('taken away: "kicking"; no movement is named')
    assert remark("kicks without leftt", known) == 'taken away: "leftt"; did you mean "kicks without left"?'


@pytest.mark.skipif(not languages.is_installed(), reason="needs the extra languages")
@pytest.mark.parametrize(
    ("sentence", "negation"),
    [
        ("eine Person geht nicht", "nicht"),
        ("il ne marche pas", "ne marche pas"),
        ("una persona no camina", "no"),
        ("una persona non cammina", "non"),
        ("uma pessoa não anda", "não"),
        ("iemand loopt niet", "niet"),
        ("человек не идёт", "не"),
        ("人が歩かない", "ない"),
        ("一个人不走路", "不"),
    ],
)
def test_a_negation_of_another_language_that_is_not_understood_is_named(sentence: str, negation: str) -> None:
    assert f'but not "{negation}"' in remark(sentence, lexicon(["a person walks"]))


@pytest.mark.skipif(not languages.is_installed(), reason="needs the extra languages")
@pytest.mark.parametrize("sentence", ["une personne fait un pas en avant", "ein Mensch springt, aber nicht nach vorne"])
def test_of_other_languages_what_is_no_negation_or_understood_is_not_named(sentence: str) -> None:
    assert "but not" not in remark(sentence, lexicon(["a person walks"]))
