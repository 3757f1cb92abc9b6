"""Every module of actions is imported, so that a misspelt or forgotten one cannot drop its actions silently."""

from __future__ import annotations

import pkgutil
import subprocess
import sys

import pytest

from encoders.corpus import actions
from encoders.corpus.actions.programs import FAMILIES, compatible, parts_of, programs
from encoders.corpus.engine.program import program
from encoders.corpus.heldout import heldout_actions
from encoders.corpus.scene import ActionStep
from tests.conftest import ROOT


def test_every_module_of_the_actions_is_registered() -> None:
    prefix = f"{actions.__name__}."
    modules = {found.name for found in pkgutil.walk_packages(actions.__path__, prefix) if not found.ispkg}
    registered = {family.__name__ for family in FAMILIES} - {heldout_actions.__name__}
    assert registered == modules - {f"{prefix}programs"}


@pytest.mark.parametrize("missing", ["jumps", "gestures.waving"])
def test_a_missing_module_of_actions_is_an_error_that_names_it(missing: str) -> None:
    name = f"{actions.__name__}.{missing}"
    script = f"import sys; sys.modules[{name!r}] = None; import {actions.__name__}.programs"
    done = subprocess.run([sys.executable, "-c", script], cwd=ROOT, capture_output=True, text=True, check=False)
    assert done.returncode != 0
    assert name in done.stderr


def test_programs_have_the_attributes_that_they_support() -> None:
    assert len(programs()) >= 300
    assert {"left", "backward", "zigzag", "clockwise", "in place"} <= set(programs()["walk"].directions)
    assert all(p.weight > 0 and p.starts and p.ends for p in programs().values())


def test_a_step_occupies_the_arm_of_its_side() -> None:
    assert parts_of(ActionStep("wave", side="left")) == {"left_arm"}
    assert compatible(ActionStep("walk"), ActionStep("wave", side="left"))
    assert not compatible(ActionStep("walk"), ActionStep("run"))


def test_an_action_has_one_program() -> None:
    with pytest.raises(ValueError, match="'walk' is registered twice"):
        program("walk", group="locomotion")(programs()["walk"].make)
