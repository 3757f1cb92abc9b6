"""The share of sentences whose verbs are known, and that are parsed completely."""

from __future__ import annotations

import random
from pathlib import Path

import numpy as np
import pytest

from encoders.corpus.language.caption_generation import captions
from encoders.corpus.language.coverage import coverage
from tests.encoders.corpus.scenes import one


def test_verbs_of_generated_captions_are_mostly_known() -> None:
    rng = np.random.default_rng(7)
    found = coverage(captions(one("walk", direction="forward"), rng, 60))
    assert found.verbs_known > 0.5


@pytest.mark.slow
def test_human_sentences_are_covered(shared: Path) -> None:
    lines = (shared / "data/texts/sentences_humanml3d.txt").read_text(encoding="utf-8").splitlines()
    found = coverage(random.Random(0).sample(lines, 1500))
    assert found.verbs_known > 0.78
    assert found.parsed > 0.25
