"""Which language a sentence is written in."""

import pytest

from search.query import languages
from search.query.languages import language_of


@pytest.mark.parametrize(
    ("sentence", "language"),
    [
        ("ein Mann springt über eine Kiste", "German"),
        ("sie dreht sich nach rechts", "German"),
        ("un homme saute par-dessus une boîte", "French"),
        ("elle tourne à gauche et s'assoit", "French"),
        ("una mujer levanta la mano derecha", "Spanish"),
        ("alguien camina hacia atrás", "Spanish"),
        ("una donna alza la mano destra", "Italian"),
        ("uma mulher levanta a mão direita", "Portuguese"),
        ("een vrouw draait naar links", "Dutch"),
        ("kobieta podnosi prawą rękę", "Polish"),
        ("bir kadın sağ kolunu kaldırıyor", "Turkish"),
        ("en kvinna lyfter höger arm", "Swedish"),
        ("женщина поднимает руку", "Russian"),
        ("女の人が右手を上げる", "Japanese"),
        ("一个女人举起右手", "Chinese"),
        ("여자가 오른손을 든다", "Korean"),
        ("ผู้หญิงยกมือขวา", "Thai"),
        ("امرأة ترفع يدها اليمنى", "Arabic"),
        ("camina", "Spanish"),
        ("die Arme kreisen lassen", "German"),
    ],
)
def test_a_sentence_shows_its_language(sentence: str, language: str) -> None:
    assert language_of(sentence) == language


@pytest.mark.parametrize(
    "sentence",
    [
        "a person walks to the left",
        "tai chi",
        "xkcd qwrt",
        "",
        "123",
        "a",
        "T-pose",
        "pirouette",
        "tilt head",
        "trotting",
    ],
)
def test_english_and_what_is_no_language_have_none(sentence: str) -> None:
    assert language_of(sentence) == ""


def test_a_language_is_understood_where_its_lexicon_and_the_encoder_are_there(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(languages, "is_installed", lambda: True)
    assert languages.understood_language_of("jemand geht nach links") == "German"
    assert languages.understood_language_of("en kvinna lyfter höger arm") == ""
    monkeypatch.setattr(languages, "is_installed", lambda: False)
    assert languages.understood_language_of("jemand geht nach links") == ""
