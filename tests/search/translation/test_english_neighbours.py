"""Sentences of other languages have the vectors of English ones."""

from __future__ import annotations

import numpy as np
import pytest

from encoders.bundle.bundle import Bundle
from search.query import languages
from search.query.encoding import encode_queries
from search.query.steps import split
from search.translation.concepts import concepts_of
from search.translation.english_neighbours import english_neighbours
from search.translation.sentence_table import sentence_table

needs_extra = pytest.mark.skipif(not languages.is_installed(), reason="needs the extra languages")

PAIRS = {
    "a person waves with the left hand": "eine Person winkt mit der linken Hand",
    "a person waves with the right hand": "une personne salue de la main droite",
    "a person walks backward": "una persona camina hacia atrás",
    "a person jumps three times": "人が三回ジャンプする",
    "a person sits down on a chair": "一个人坐到椅子上",
    "a person kicks with the right foot": "uma pessoa chuta com o pé direito",
}


@pytest.fixture(scope="module")
def bundle() -> Bundle:
    return Bundle.load()


@needs_extra
def test_translations_meet_their_english_sentence_first(bundle: Bundle) -> None:
    similarity = encode_queries(bundle, list(PAIRS.values())) @ encode_queries(bundle, list(PAIRS)).T
    assert similarity.argmax(axis=1).tolist() == list(range(len(PAIRS)))
    assert np.diag(similarity).min() > 0.75


@needs_extra
def test_neighbours_have_the_side_that_is_asked_for() -> None:
    near = english_neighbours("eine Person hebt den linken Arm", "German")
    assert sum(weight for _, weight in near) == pytest.approx(1)
    assert sum(weight for text, weight in near if "left" in text) > 0.9


@needs_extra
def test_words_of_order_divide_other_languages_too() -> None:
    assert split("eine Person geht vorwärts, dann setzt sie sich") == ["eine Person geht vorwärts", "setzt sie sich"]
    assert split("一个人向前走，然后坐下") == ["一个人向前走", "坐下"]


def test_english_never_asks_the_multilingual_encoder(bundle: Bundle, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("search.translation.english_neighbours._multilingual_encoder", None)
    monkeypatch.setattr("search.query.encoding.encode_foreign", None)
    assert encode_queries(bundle, ["a person walks", "take_016"]).shape == (2, bundle.latent_size)


def test_without_the_extra_a_sentence_is_encoded_as_it_is(bundle: Bundle, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(languages, "is_installed", lambda: False)
    sentence = "eine Person geht rückwärts"
    assert np.allclose(encode_queries(bundle, [sentence]), bundle.encode_texts([sentence]), atol=1e-6)


def test_the_table_fits_the_lexicon() -> None:
    table = sentence_table()
    for row in range(0, len(table.sentences), 500):
        expected = concepts_of(table.sentences[row], "English").tolist()
        assert table.concepts[table.rows == row].tolist() == expected, "run benchmarks.make_sentences again"
