"""Random scenes are legal for their programs and chain postures."""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from encoders.corpus.actions.programs import programs
from encoders.corpus.language.random_scenes import random_scene


def test_random_scenes_are_legal_and_chain_postures() -> None:
    rng = np.random.default_rng(6)
    known = programs()
    for _ in range(100):
        scene = random_scene(rng)
        assert 1 <= len(scene.steps) <= 4
        firsts = [known[group[0].action] for group in scene.steps]
        assert all(before.ends == after.starts for before, after in pairwise(firsts))
        for group in scene.steps:
            for step in group:
                program = known[step.action]
                assert step.side in ("", *program.sides)
                assert step.direction in ("", *program.directions)
