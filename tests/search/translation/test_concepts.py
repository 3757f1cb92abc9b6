"""What a sentence names, in any language."""

from __future__ import annotations

import pytest

from search.translation.concepts import concept_names, concepts_of, languages


def named(sentence: str, language: str) -> set[str]:
    return {concept_names()[number] for number in concepts_of(sentence, language)}


@pytest.mark.parametrize(
    ("language", "sentence"),
    [
        ("English", "raises the left hand"),
        ("German", "hebt die linke Hand"),
        ("French", "lève la main gauche"),
        ("Spanish", "levanta la mano izquierda"),
        ("Italian", "solleva la mano sinistra"),
        ("Portuguese", "levanta a mão esquerda"),
        ("Dutch", "heft de linkerhand"),
        ("Polish", "podnosi lewą rękę"),
        ("Russian", "поднимает левую руку"),
        ("Turkish", "sol elini kaldırıyor"),
        ("Arabic", "يرفع اليد اليسرى"),
        ("Chinese", "举起左手"),
        ("Japanese", "左手を上げる"),
        ("Korean", "왼손을 올린다"),
        ("Thai", "ยกมือซ้าย"),
    ],
)
def test_a_side_and_an_action_are_the_same_in_every_language(language: str, sentence: str) -> None:
    found = named(sentence, language)
    assert {"left", "raise"} <= found
    assert "right" not in found


def test_parts_of_a_stem_may_have_words_between_them() -> None:
    assert "get_up" in named("jemand steht vom Stuhl auf", "German")
    assert "get_up" not in named("jemand steht still", "German")


def test_a_whole_word_is_no_beginning() -> None:
    assert "run" in named("he ran", "English")
    assert "run" not in named("a random thing", "English")


@pytest.mark.parametrize("language", languages())
def test_a_lexicon_has_sides_and_only_concepts_that_english_has(language: str) -> None:
    from search.translation.concepts import _entries

    entries = _entries(language)
    assert {"left", "right", "forward", "backward", "walk", "jump"} <= entries.keys() <= set(concept_names())
    assert all(entries.values())
