"""Animals and machines are refused as what they are; people with tails, wings and capes are read."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from encoders.errors import UnreadableMotion
from indexer.ingest.load import load_motion
from indexer.rigs.retarget import retarget
from indexer.take import Take
from tests.indexer.example_rigs import RIGS, standing, tree

Joint = tuple[str, str, tuple[float, float, float]]  # name, parent, place at rest in metres


def beast(arm: str, leg: str, size: float = 1.0, tail: bool = True) -> list[Joint]:
    """A four-legged animal that faces +Z; `arm` and `leg` name the joints of a limb, with {} for the side."""
    joints: list[Joint] = [
        ("Hips", "", (0, 0.6, 0)),
        ("Spine", "Hips", (0, 0.62, 0.3)),
        ("Chest", "Spine", (0, 0.62, 0.6)),
        ("Neck", "Chest", (0, 0.75, 0.7)),
        ("Head", "Neck", (0, 0.85, 0.85)),
    ]
    for side, x in (("Left", 0.1), ("Right", -0.1)):
        places = [(x, 0.58, 0.6), (x, 0.32, 0.55), (x, 0.05, 0.6)]
        for names, top, z in ((arm, "Chest", 0.0), (leg, "Hips", -0.6)):
            above = top
            for name, place in zip(names.format(*[side] * 3).split(), places, strict=True):
                joints.append((name, above, (place[0], place[1], place[2] + z)))
                above = name
    if tail:
        joints += [("Tail1", "Hips", (0, 0.6, -0.2)), ("Tail2", "Tail1", (0, 0.5, -0.4))]
    return [(name, parent, tuple(size * v for v in place)) for name, parent, place in joints]


def person(*more: Joint) -> list[Joint]:
    names, parents, _ = tree(RIGS["mixamo"])
    places = standing(RIGS["mixamo"])
    return [
        (name, names[parent] if parent >= 0 else "", tuple(place))
        for name, parent, place in zip(names, parents, places, strict=True)
    ] + list(more)


def take(joints: list[Joint]) -> Take:
    names = [name for name, _, _ in joints]
    rest = np.array([place for _, _, place in joints], np.float64)
    parents = np.array([names.index(parent) if parent else -1 for _, parent, _ in joints])
    return Take(tuple(names), parents, rest, np.stack([rest] * 20), 30.0)


def leg(name: str, x: float, z: float, height: float = 0.9, parent: str = "mixamorig:Hips") -> list[Joint]:
    places = [(x, height, z), (x, height / 2, z + 0.02), (x, 0.05, z)]
    names = [f"{name}_{k}" for k in range(3)]
    return [(own, above, place) for own, above, place in zip(names, [parent, *names], places, strict=False)]


def person_with_wings_for_arms() -> list[Joint]:
    """A bird that stands upright, without a tail."""
    return [
        (
            name.replace("ForeArm", "Wing2").replace("Arm", "Wing1"),
            parent.replace("ForeArm", "Wing2").replace("Arm", "Wing1"),
            place,
        )
        for name, parent, place in person()
    ]


ANIMALS = {
    "dog": beast("{}UpperArm {}Forearm {}Hand", "{}Thigh {}Calf {}Foot"),
    "horse named as a person": beast("{}Arm {}ForeArm {}Hand", "{}UpLeg {}Leg {}Foot", size=2.5, tail=False),
    "quadruped robot": beast("{}Shoulder {}Elbow {}Wrist", "{}Hip {}Knee {}Ankle", tail=False),
    "centaur": person(*leg("HindLegL", 0.15, -0.8), *leg("HindLegR", -0.15, -0.8)),
    "bird": person_with_wings_for_arms(),
    "spider": person(
        *[joint for k, z in enumerate((0.5, -0.5)) for x in (0.5, -0.5) for joint in leg(f"b{k}{x}", x, z)]
    ),
}
TAIL = [
    ("Tail1", "mixamorig:Hips", (0, 0.9, -0.2)),
    ("Tail2", "Tail1", (0, 0.5, -0.3)),
    ("Tail3", "Tail2", (0, 0.05, -0.4)),
]
WINGS = [
    joint
    for side, x in (("L", 1), ("R", -1))
    for joint in (
        (f"Wing1{side}", "mixamorig:Spine2", (0.1 * x, 1.3, -0.1)),
        (f"Wing2{side}", f"Wing1{side}", (0.6 * x, 1.5, -0.2)),
        (f"Wing3{side}", f"Wing2{side}", (1.0 * x, 0.1, -0.2)),
    )
]
PEOPLE = {
    "tail": person(*TAIL),
    "wings": person(*WINGS),
    "cape": person(*leg("Cape_L", 0.2, -0.2, 1.4), *leg("Cape_R", -0.2, -0.2, 1.4)),
    "staff": person(*leg("Staff", 0.6, 0.3)),
}


@pytest.mark.parametrize("animal", ANIMALS)
def test_an_animal_is_refused(animal: str) -> None:
    with pytest.raises(UnreadableMotion, match="not a human figure"):
        retarget(take(ANIMALS[animal]), path="x.bvh")


def test_a_car_holds_no_body() -> None:
    wheels = [(f"Wheel{x}{z}", "Car", (x, 0.3, z)) for x in (0.8, -0.8) for z in (1.2, -1.2)]
    with pytest.raises(UnreadableMotion, match="any part of a body: not a human figure"):
        retarget(take([("Car", "", (0, 0.5, 0)), *wheels]), path="x.bvh")


@pytest.mark.parametrize("prop", PEOPLE)
def test_people_with_props_are_read(prop: str) -> None:
    assert len(retarget(take(PEOPLE[prop]), path="x.bvh"))


def test_the_dog_is_refused(shared: Path) -> None:
    with pytest.raises(UnreadableMotion, match="not a human figure: at rest its trunk is level, on four legs"):
        load_motion(shared / "cases" / "files" / "four-legged" / "dog.bvh")
