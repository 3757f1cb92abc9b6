"""Forms of English verbs."""

from __future__ import annotations

from encoders.english import gerund, past, third_person


def test_verb_forms() -> None:
    assert [gerund(verb) for verb in ("run", "wave", "lie", "tiptoe", "hop", "kick")] == [
        "running", "waving", "lying", "tiptoeing", "hopping", "kicking",
    ]  # fmt: skip
    assert [past(verb) for verb in ("run", "clap", "carry", "bow")] == ["ran", "clapped", "carried", "bowed"]
    assert [third_person(verb) for verb in ("go", "crouch", "carry")] == ["goes", "crouches", "carries"]
