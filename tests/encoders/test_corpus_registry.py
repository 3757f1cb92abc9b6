"""Every module of actions is imported, so that a misspelt or forgotten one cannot drop its actions silently."""

from __future__ import annotations

import pkgutil

import pytest

from encoders.corpus import actions
from encoders.corpus.actions.programs import FAMILIES, programs
from encoders.corpus.engine.program import program
from encoders.corpus.heldout import heldout_actions


def test_every_module_of_the_actions_is_registered() -> None:
    prefix = f"{actions.__name__}."
    modules = {found.name for found in pkgutil.walk_packages(actions.__path__, prefix) if not found.ispkg}
    registered = {family.__name__ for family in FAMILIES} - {heldout_actions.__name__}
    assert registered == modules - {f"{prefix}programs"}


@pytest.mark.parametrize("family", FAMILIES, ids=lambda family: family.__name__.removeprefix("encoders.corpus."))
def test_every_module_of_actions_adds_a_program(family: object) -> None:
    assert any(vars(family).values()), "a module of actions is not empty"


def test_an_action_has_one_program() -> None:
    with pytest.raises(ValueError, match="'walk' is registered twice"):
        program("walk", group="locomotion")(programs()["walk"].make)
