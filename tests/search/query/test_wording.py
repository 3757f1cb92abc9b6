"""What is said of a sentence that is not understood."""

import pytest

from search.query.known_words import lexicon
from search.query.wording import remark

KNOWN = lexicon(["a person walks forward like a robot", "sits down slowly then waves", "jumping"])


@pytest.mark.parametrize("sentence", ["a person walks forward", "sits down, then waves", "Jumping!"])
def test_nothing_is_said_of_known_words(sentence: str) -> None:
    assert remark(sentence, KNOWN) == ""


def test_slips_are_put_right_and_the_rest_of_the_sentence_stays() -> None:
    assert remark("a Person wlaks, then jumps slowli", KNOWN) == 'did you mean "a Person walks, then jumps slowly"?'


def test_another_language_is_told_from_nonsense() -> None:
    assert "German" in remark("jemand geht nach links", KNOWN)
    assert "Japanese" in remark("人が歩く", KNOWN)
    assert "not understood" in remark("en kvinna lyfter höger arm", KNOWN)
    nonsense = remark("qxzv wjkp", KNOWN)
    assert nonsense.startswith("no word of it describes movement")
    assert '"a person waves"' in nonsense


def test_words_without_a_near_one_are_named() -> None:
    assert remark("a person walks like a zyxwv", KNOWN) == '"zyxwv" is a word that the model has not learned'


def test_a_short_word_is_no_slip_of_another() -> None:
    assert "did you mean" not in remark("a person sti", KNOWN)
