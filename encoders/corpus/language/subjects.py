"""Subjects of captions, and the words that agree with them."""

from __future__ import annotations

from dataclasses import dataclass, replace

from encoders.corpus.language.weighted_choice import RandomSource, pick, pick_weighted
from encoders.english import indefinite


@dataclass(frozen=True)
class Subject:
    """A subject and its pronouns.

    Attributes
    ----------
    text : str
        "a person"; empty for captions without a subject.
    gender : str
        "they", "he", "she" or "it": the pronoun.
    plural : bool
        Whether the verb is plural ("they walk").
    """

    text: str
    gender: str
    plural: bool = False

    @property
    def possessive(self) -> str:
        return {"they": "their", "he": "his", "she": "her", "it": "its", "the": "the"}[self.gender]

    @property
    def reflexive(self) -> str:
        return {"they": "themselves", "he": "himself", "she": "herself", "it": "itself", "the": "themselves"}[
            self.gender
        ]

    @property
    def pronoun(self) -> str:
        return "they" if self.gender == "the" else self.gender

    def be(self, *, past: bool = False) -> str:
        """The form of "to be" after the pronoun."""
        if past:
            return "were" if self.pronoun == "they" else "was"
        return "are" if self.pronoun == "they" else "is"

    @property
    def have(self) -> str:
        return "have" if self.pronoun == "they" else "has"


_ANY = ("they", "they", "they", "they", "he", "he", "he", "she", "the")
_MALE = ("he", "he", "he", "they", "the")
_FEMALE = ("she", "she", "she", "they", "the")
_SUBJECTS: tuple[tuple[str, tuple[str, ...], float], ...] = (
    ("a person", _ANY, 40.0),
    ("the person", _ANY, 11.0),
    ("person", _ANY, 7.0),
    ("someone", _ANY, 7.0),
    ("a man", _MALE, 8.0),
    ("the man", _MALE, 3.5),
    ("a woman", _FEMALE, 4.0),
    ("the woman", _FEMALE, 1.5),
    ("this person", _ANY, 2.5),
    ("the figure", _ANY, 2.5),
    ("a figure", _ANY, 2.0),
    ("he", ("he",), 3.0),
    ("she", ("she",), 1.5),
    ("they", ("they",), 1.5),
    ("an individual", _ANY, 1.5),
    ("a stick figure", _ANY, 0.7),
    ("the character", _ANY, 0.8),
    ("a character", _ANY, 0.5),
    ("somebody", _ANY, 0.6),
    ("a guy", _MALE, 0.4),
    ("the actor", _ANY, 0.3),
    ("a human", _ANY, 0.4),
    ("the subject", _ANY, 0.3),
    ("the performer", _ANY, 0.2),
    ("man", _MALE, 0.3),
    ("a dude", _MALE, 0.1),
    ("a boy", _MALE, 0.3),
    ("a girl", _FEMALE, 0.3),
    ("a lady", _FEMALE, 0.2),
)
_WEIGHTS = tuple(weight for _, _, weight in _SUBJECTS)


def draw_subject(rng: RandomSource) -> Subject:
    """A subject, distributed as in human captions: "a person" half of the time."""
    text, genders, _ = pick_weighted(rng, _SUBJECTS, _WEIGHTS)
    return Subject(text, pick(rng, genders), plural=text == "they")


def no_subject(rng: RandomSource) -> Subject:
    """An empty subject with a possessive: "raising their arm", "raising the arm"."""
    return Subject("", pick(rng, ("they", "they", "he", "the", "the")))


def with_adjective(subject: Subject, adjective: str) -> Subject | None:
    """ "a person" -> "a tired person"; None if no adjective fits ("someone", "he")."""
    article, _, noun = subject.text.rpartition(" ")
    if article not in ("a", "an", "the"):
        return None
    return replace(subject, text=f"the {adjective} {noun}" if article == "the" else f"{indefinite(adjective)} {noun}")
