"""A chain that ends at elbow, knee or ankle without an end site goes on straight."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest

from encoders.geometry import angle_between
from encoders.skeleton import INDEX
from indexer.ingest.load import load_motion
from tests.indexer.performances import bvh, performance

LIMBS = {"elbow": ("Hand", "wrist"), "knee": ("Foot", "ankle"), "ankle": ("Toes", "foot")}


@pytest.mark.parametrize("leaf", LIMBS)
def test_the_missing_bone_goes_on_from_a_last_joint_as_that_is_turned(tmp_path: Path, leaf: str) -> None:
    below, joint = LIMBS[leaf]
    text = bvh(performance())
    whole, cut = tmp_path / "whole.bvh", tmp_path / "cut.bvh"
    whole.write_text(text, encoding="utf-8")
    for side in ("L", "R"):
        text = without_subtree(text, f"{below}_{side}")
    cut.write_text(text, encoding="utf-8")
    expected, found = load_motion(whole).joints, load_motion(cut).joints
    for side in ("left", "right"):
        bones = (_bone(joints, f"{side}_{joint}", f"{side}_{leaf}") for joints in (expected, found))
        assert angle_between(*bones).mean() < (35 if leaf == "ankle" else 12)  # how a foot turns outwards is unknown


def _bone(joints: np.ndarray, end: str, start: str) -> np.ndarray:
    return joints[:, INDEX[end]] - joints[:, INDEX[start]]


def without_subtree(text: str, name: str) -> str:
    """A BVH without a joint and all below it, and without their channels."""
    lines = text.split("\n")
    first = next(i for i, line in enumerate(lines) if re.fullmatch(rf"\s*JOINT {name}", line))
    depth, last = 0, first
    while True:
        last += 1
        depth += lines[last].count("{") - lines[last].count("}")
        if depth == 0:
            break
    counts = [int(line.split()[1]) if "CHANNELS" in line else 0 for line in lines]
    start, end = sum(counts[:first]), sum(counts[: last + 1])
    time = next(i for i, line in enumerate(lines) if line.startswith("Frame Time"))
    frames = [" ".join((row := line.split())[:start] + row[end:]) for line in lines[time + 1 :]]
    return "\n".join([*lines[:first], *lines[last + 1 : time + 1], *frames])
