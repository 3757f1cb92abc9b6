"""Scenes of one step, for tests of the language."""

from __future__ import annotations

from encoders.corpus.scene import ActionStep, Scene


def one(action: str, **fields: object) -> Scene:
    return Scene(((ActionStep(action, **fields),),))  # type: ignore[arg-type]
