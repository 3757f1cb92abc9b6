"""Which joint of a rig is which joint of the body."""

from __future__ import annotations

import numpy as np
import pytest

from encoders.errors import UnknownRig, UnreadableMotion
from indexer.rigs.joint_names import parse_joint_name
from indexer.rigs.mapping import map_names, map_rig
from indexer.take import Take
from tests.indexer.example_rigs import RIGS, standing, tree

OPTIONAL = ("collar", "toe", "neck", "head")


def take_of(rig_name: str, rename: bool = False) -> Take:
    names, parents, _ = tree(RIGS[rig_name])
    figure = standing(RIGS[rig_name])
    if rename:
        names = [f"bone{i}" for i in range(len(names))]
    return Take(tuple(names), np.array(parents), figure, figure[None], 30.0)


@pytest.mark.parametrize("rig", RIGS)
def test_names_alone_find_every_landmark(rig: str) -> None:
    names, _, expected = tree(RIGS[rig])
    found = map_rig(take_of(rig), "x.bvh").joints
    wanted = {mark: names[joint] for mark, joint in expected.items() if mark in found or "collar" not in mark}
    assert {mark: names[joint] for mark, joint in found.items() if mark in wanted} == wanted


@pytest.mark.parametrize("rig", ["mixamo", "unreal", "poser", "smpl", "collar and joint names", "cmu asf", "bandai"])
def test_without_names_the_shape_of_the_tree_tells(rig: str) -> None:
    _, _, expected = tree(RIGS[rig])
    found = map_rig(take_of(rig, rename=True), "x.bvh").joints
    limbs = {mark: joint for mark, joint in expected.items() if not mark.endswith(OPTIONAL)}
    assert {mark: found[mark] for mark in limbs} == limbs
    assert found["head"] >= expected["neck"]


def test_the_spine_runs_from_the_legs_to_the_arms() -> None:
    take = take_of("xsens")
    assert [take.names[j] for j in map_rig(take, "x.bvh").spine] == ["L5", "L3", "T12", "T8"]


def test_a_joint_map_overrides() -> None:
    take = take_of("smpl")
    rig = map_rig(take, "x.bvh", {"left_wrist": "L_Hand", "left_foot": "L_Ankle"})
    assert take.names[rig.joints["left_wrist"]] == "L_Hand"
    assert take.names[rig.joints["left_toe"]] == "L_Ankle"
    assert take.names[rig.joints["right_wrist"]] == "R_Wrist"


@pytest.mark.parametrize("joint_map", [{"left_wrist": "Nothing"}, {"tail": "L_Hand"}])
def test_a_joint_map_that_names_nothing_is_an_error(joint_map: dict[str, str]) -> None:
    with pytest.raises(UnreadableMotion, match="joint map"):
        map_rig(take_of("smpl"), "x.bvh", joint_map)


def test_what_cannot_be_mapped_is_named() -> None:
    take = Take(("Shoulder", "Elbow", "Wrist"), np.array([-1, 0, 1]), np.eye(3), np.eye(3)[None], 30.0)
    with pytest.raises(UnknownRig) as error:
        map_rig(take, "arm.bvh")
    assert {"left_hip", "right_wrist", "head"} <= set(error.value.missing)
    assert "arm.bvh" in str(error.value)


def test_a_joint_map_mends_what_is_missing() -> None:
    names, parents, _ = tree(RIGS["bandai"])
    renamed = tuple("strange" if name == "Hand_L" else name for name in names)
    figure = standing(RIGS["bandai"])
    take = Take(renamed, np.array(parents), figure, figure[None], 30.0)
    rig = map_rig(take, "x.bvh", {"left_wrist": "strange"})
    assert take.names[rig.joints["left_wrist"]] == "strange"


@pytest.mark.parametrize(
    ("name", "side", "role"),
    [
        ("LeftUpLeg", "left", "hip"),
        ("thigh.R", "right", "hip"),
        ("lThigh", "left", "hip"),
        ("rightlowerleg", "right", "knee"),
        ("Bip01 L Calf", "left", "knee"),
        ("右足首", "right", "ankle"),
        ("Rig|L_Toe0", "left", "toe"),
        ("foot_l", "left", "ankle"),
        ("LUArm", "left", "shoulder"),
        ("R-Forearm", "right", "elbow"),
        ("CC_Base_NeckTwist01", "", "neck"),
        ("Head_M", "", "head"),
    ],
)
def test_a_name_says_side_and_role(name: str, side: str, role: str) -> None:
    found = parse_joint_name(name)
    assert found.side == side
    assert role in found.roles


@pytest.mark.parametrize(
    "name",
    [
        "LeftHandThumb1",
        "thigh_twist_01_l",
        "ik_foot_l",
        "LeftEye",
        "L_Radius_RIGMESH",
        "LeftForeArmRoll",
        "J_Sec_Hair_L",
    ],
)
def test_fingers_twists_handles_and_faces_play_no_role(name: str) -> None:
    assert not parse_joint_name(name).roles


def test_names_are_enough_for_every_rig() -> None:
    lacking = [rig for rig in RIGS if "left_wrist" not in map_names(take_of(rig))]
    assert not lacking
