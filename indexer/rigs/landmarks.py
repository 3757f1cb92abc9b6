"""Landmarks: where the joints of a body are over time, in the file's units, before it is rebuilt on the 22 joints."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from encoders.geometry import Array, interpolate, length
from indexer.rigs.mapping import SIDES, RigMap


@dataclass(frozen=True)
class Landmarks:
    """Landmarks and back of a body.

    Attributes
    ----------
    marks : dict of str to array (T, 3)
        Hips, knees, ankles, shoulders, elbows, wrists, neck and head; toes where there are any.
    spine : array (T, S, 3)
        Points along the back between hips and neck, upwards; S may be 0.
    """

    marks: dict[str, Array]
    spine: Array

    @classmethod
    def of(cls, positions: Array, rig: RigMap) -> Landmarks:
        """The landmarks among joint positions (T, J, 3); a missing neck or head is placed from the other."""
        marks = {name: positions[:, joint] for name, joint in rig.joints.items()}
        for side in SIDES:
            if f"{side}_toe" in marks and _is_one(marks[f"{side}_toe"], marks[f"{side}_ankle"]):
                del marks[f"{side}_toe"]
        if "neck" in marks and "head" in marks and _is_one(marks["neck"], marks["head"]):
            del marks["neck"]
        shoulders = (marks["left_shoulder"] + marks["right_shoulder"]) / 2
        if "neck" not in marks:
            marks["neck"] = shoulders + (marks["head"] - shoulders) * 0.3
        if "head" not in marks:
            marks["head"] = marks["neck"] * 2 - shoulders
        return cls(marks, positions[:, rig.spine])

    def __len__(self) -> int:
        return len(self.spine)

    def __getitem__(self, frames: slice) -> Landmarks:
        return Landmarks({name: place[frames] for name, place in self.marks.items()}, self.spine[frames])

    def transformed(self, matrix: Array) -> Landmarks:
        """Every point times a matrix (3, 3): turned, mirrored or scaled."""
        return Landmarks({name: place @ matrix.T for name, place in self.marks.items()}, self.spine @ matrix.T)

    def sampled(self, at: Array) -> Landmarks:
        """The landmarks at times counted in frames, interpolated linearly."""
        marks = {name: interpolate(place, at) for name, place in self.marks.items()}
        return Landmarks(marks, interpolate(self.spine, at))

    def middle(self, joint: str) -> Array:
        """Point (T, 3) between the left and the right one."""
        middle: Array = (self.marks[f"left_{joint}"] + self.marks[f"right_{joint}"]) / 2
        return middle

    def across(self, joint: str) -> Array:
        """From the right one to the left one, (T, 3)."""
        across: Array = self.marks[f"left_{joint}"] - self.marks[f"right_{joint}"]
        return across

    def bone(self, start: str, end: str) -> Array:
        """From one landmark to another, (T, 3)."""
        bone: Array = self.marks[end] - self.marks[start]
        return bone

    @cached_property
    def leg_length(self) -> float:
        """Upper leg and shank together, mean of both sides, in the file's units."""
        bones = [self.bone(f"{s}_{a}", f"{s}_{b}") for s in SIDES for a, b in (("hip", "knee"), ("knee", "ankle"))]
        return float(np.median(length(np.stack(bones)), axis=-1).sum() / 2)

    def points(self, names: Iterable[str] | None = None) -> Array:
        """Landmarks as (T, L, 3): all, or those named."""
        return np.stack([self.marks[name] for name in names or self.marks], axis=1)


def _is_one(a: Array, b: Array) -> bool:
    """Are two tracks (T, 3) the same?"""
    return bool(np.abs(a - b).max() <= 1e-6 * max(float(np.abs(a).max()), 1e-9))
