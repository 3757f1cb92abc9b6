"""Skeletons as many programs name them, for tests of the mapping; and a walking figure on any of them.

A limb is written as its left chain, each joint with its role before a colon (h hip, k knee, a ankle, t toe, c collar,
s shoulder, e elbow, w wrist, n neck, d head); a dash stands for no role, an x for a side branch of the joint before.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

ROLES = {
    "h": "hip", "k": "knee", "a": "ankle", "t": "toe", "c": "collar", "s": "shoulder", "e": "elbow", "w": "wrist",
    "n": "neck", "d": "head",
}  # fmt: skip


class Rig(NamedTuple):
    """Trunk (the legs part from its first joint, the arms from its last), head, left leg, left arm, left and right."""

    trunk: str
    head: str
    leg: str
    arm: str
    sides: tuple[str, str]


RIGS = {
    "mixamo": Rig(
        "mixamorig:Hips mixamorig:Spine mixamorig:Spine1 mixamorig:Spine2",
        "n:mixamorig:Neck d:mixamorig:Head -:mixamorig:HeadTop_End",
        "h:mixamorig:LeftUpLeg k:mixamorig:LeftLeg a:mixamorig:LeftFoot t:mixamorig:LeftToeBase"
        " -:mixamorig:LeftToe_End",
        "c:mixamorig:LeftShoulder s:mixamorig:LeftArm e:mixamorig:LeftForeArm w:mixamorig:LeftHand"
        " x:mixamorig:LeftHandThumb1 -:mixamorig:LeftHandIndex1 -:mixamorig:LeftHandIndex2",
        ("Left", "Right"),
    ),
    "unreal": Rig(
        "pelvis spine_01 spine_02 spine_03",
        "n:neck_01 d:head",
        "h:thigh_l x:thigh_twist_01_l k:calf_l x:calf_twist_01_l a:foot_l t:ball_l",
        "c:clavicle_l s:upperarm_l x:upperarm_twist_01_l e:lowerarm_l w:hand_l -:middle_01_l",
        ("_l", "_r"),
    ),
    "unity": Rig(
        "Hips Spine Chest UpperChest",
        "n:Neck d:Head x:Jaw x:LeftEye",
        "h:LeftUpperLeg k:LeftLowerLeg a:LeftFoot t:LeftToes",
        "c:LeftShoulder s:LeftUpperArm e:LeftLowerArm w:LeftHand -:Left_Thumb_Proximal",
        ("Left", "Right"),
    ),
    "biped": Rig(
        "Bip01 Bip01_Spine Bip01_Spine1",
        "n:Bip01_Neck d:Bip01_Head -:Bip01_HeadNub",
        "h:Bip01_L_Thigh k:Bip01_L_Calf a:Bip01_L_Foot t:Bip01_L_Toe0 -:Bip01_L_Toe0Nub",
        "c:Bip01_L_Clavicle s:Bip01_L_UpperArm e:Bip01_L_Forearm w:Bip01_L_Hand -:Bip01_L_Finger0",
        ("_L_", "_R_"),
    ),
    "poser": Rig(
        "hip abdomen chest",
        "n:neck d:head x:leftEye",
        "-:lButtock h:lThigh k:lShin a:lFoot t:lToe",
        "c:lCollar s:lShldr e:lForeArm w:lHand -:lIndex1",
        ("l", "r"),
    ),
    "daz": Rig(
        "hip pelvis abdomenLower abdomenUpper chestLower chestUpper",
        "n:neckLower -:neckUpper d:head",
        "h:lThighBend -:lThighTwist k:lShin a:lFoot t:lMetatarsals -:lToe",
        "c:lCollar s:lShldrBend -:lShldrTwist e:lForearmBend -:lForearmTwist w:lHand -:lThumb1",
        ("l", "r"),
    ),
    "makehuman": Rig(
        "root spine05 spine04 spine03 spine02 spine01",
        "n:neck01 -:neck02 -:neck03 d:head x:jaw x:tongue00",
        "-:pelvis.L h:upperleg01.L -:upperleg02.L k:lowerleg01.L -:lowerleg02.L a:foot.L t:toe1-1.L",
        "c:clavicle.L -:shoulder01.L s:upperarm01.L -:upperarm02.L e:lowerarm01.L -:lowerarm02.L w:wrist.L"
        " -:finger1-1.L",
        (".L", ".R"),
    ),
    "xsens": Rig(
        "Pelvis L5 L3 T12 T8",
        "n:Neck d:Head",
        "h:LeftUpperLeg k:LeftLowerLeg a:LeftFoot t:LeftToe",
        "c:LeftShoulder s:LeftUpperArm e:LeftForeArm w:LeftHand",
        ("Left", "Right"),
    ),
    "rokoko": Rig(
        "Hips Spine1 Spine2 Spine3 Spine4",
        "n:Neck d:Head",
        "h:LeftThigh k:LeftShin a:LeftFoot t:LeftToe -:LeftToeTip",
        "c:LeftShoulder s:LeftArm e:LeftForeArm w:LeftHand -:LeftFinger1Metacarpal",
        ("Left", "Right"),
    ),
    "optitrack": Rig(
        "Skeleton_001:Hip Skeleton_001:Ab Skeleton_001:Chest",
        "n:Skeleton_001:Neck d:Skeleton_001:Head",
        "h:Skeleton_001:LThigh k:Skeleton_001:LShin a:Skeleton_001:LFoot t:Skeleton_001:LToe",
        "c:Skeleton_001:LShoulder s:Skeleton_001:LUArm e:Skeleton_001:LFArm w:Skeleton_001:LHand",
        (":L", ":R"),
    ),
    "rigify": Rig(
        "DEF-spine DEF-spine.001 DEF-spine.002 DEF-spine.003",
        "n:DEF-spine.004 -:DEF-spine.005 d:DEF-spine.006",
        "h:DEF-thigh.L -:DEF-thigh.L.001 k:DEF-shin.L -:DEF-shin.L.001 a:DEF-foot.L t:DEF-toe.L",
        "c:DEF-shoulder.L s:DEF-upper_arm.L -:DEF-upper_arm.L.001 e:DEF-forearm.L -:DEF-forearm.L.001 w:DEF-hand.L",
        (".L", ".R"),
    ),
    "smpl": Rig(
        "Pelvis Spine1 Spine2 Spine3",
        "n:Neck d:Head",
        "h:L_Hip k:L_Knee a:L_Ankle t:L_Foot",
        "c:L_Collar s:L_Shoulder e:L_Elbow w:L_Wrist -:L_Hand",
        ("L_", "R_"),
    ),
    "vrm": Rig(
        "J_Bip_C_Hips J_Bip_C_Spine J_Bip_C_Chest J_Bip_C_UpperChest",
        "n:J_Bip_C_Neck d:J_Bip_C_Head x:J_Sec_Hair1_01",
        "h:J_Bip_L_UpperLeg k:J_Bip_L_LowerLeg a:J_Bip_L_Foot t:J_Bip_L_ToeBase",
        "c:J_Bip_L_Shoulder s:J_Bip_L_UpperArm e:J_Bip_L_LowerArm w:J_Bip_L_Hand -:J_Bip_L_Index1",
        ("_L_", "_R_"),
    ),
    "iclone": Rig(
        "CC_Base_Hip CC_Base_Waist CC_Base_Spine01 CC_Base_Spine02",
        "n:CC_Base_NeckTwist01 -:CC_Base_NeckTwist02 d:CC_Base_Head x:CC_Base_FacialBone",
        "h:CC_Base_L_Thigh x:CC_Base_L_ThighTwist01 k:CC_Base_L_Calf x:CC_Base_L_KneeShareBone a:CC_Base_L_Foot"
        " x:CC_Base_L_ToeBaseShareBone t:CC_Base_L_ToeBase x:CC_Base_L_BigToe1",
        "c:CC_Base_L_Clavicle s:CC_Base_L_Upperarm x:CC_Base_L_UpperarmTwist01 e:CC_Base_L_Forearm w:CC_Base_L_Hand",
        ("_L_", "_R_"),
    ),
    "kinect": Rig(
        "SpineBase SpineMid SpineShoulder",
        "n:Neck d:Head",
        "h:HipLeft k:KneeLeft a:AnkleLeft t:FootLeft",
        "s:ShoulderLeft e:ElbowLeft w:WristLeft x:ThumbLeft -:HandLeft -:HandTipLeft",
        ("Left", "Right"),
    ),
    "mocopi": Rig(
        "root torso_1 torso_2 torso_3 torso_4 torso_5 torso_6 torso_7",
        "n:neck_1 -:neck_2 d:head",
        "h:l_up_leg k:l_low_leg a:l_foot t:l_toes",
        "c:l_shoulder s:l_up_arm e:l_low_arm w:l_hand",
        ("l_", "r_"),
    ),
    "cmu asf": Rig(
        "root lowerback upperback thorax",
        "n:lowerneck -:upperneck d:head",
        "-:lhipjoint h:lfemur k:ltibia a:lfoot t:ltoes",
        "c:lclavicle s:lhumerus e:lradius w:lwrist -:lhand -:lfingers",
        ("l", "r"),
    ),
    "collar and joint names": Rig(
        "Hips Chest Chest2",
        "n:Neck d:Head",
        "h:LeftHip k:LeftKnee a:LeftAnkle t:LeftToe",
        "c:LeftCollar s:LeftShoulder e:LeftElbow w:LeftWrist",
        ("Left", "Right"),
    ),
    "bandai": Rig(
        "Hips Spine Chest",
        "n:Neck d:Head",
        "h:UpperLeg_L k:LowerLeg_L a:Foot_L t:Toes_L",
        "c:Shoulder_L s:UpperArm_L e:LowerArm_L w:Hand_L",
        ("_L", "_R"),
    ),
    "mikumikudance": Rig(
        "センター 上半身 上半身2",
        "n:首 d:頭",
        "h:左足 k:左ひざ a:左足首 t:左つま先",
        "c:左肩 s:左腕 e:左ひじ w:左手首 -:左人指１",
        ("左", "右"),
    ),
    "maya advanced skeleton": Rig(
        "Root_M Spine1_M Chest_M",
        "n:Neck_M d:Head_M",
        "h:Hip_L k:Knee_L a:Ankle_L t:Toes_L",
        "c:Scapula_L s:Shoulder_L e:Elbow_L w:Wrist_L",
        ("_L", "_R"),
    ),
    "second life": Rig(
        "mPelvis mTorso mChest",
        "n:mNeck d:mHead",
        "h:mHipLeft k:mKneeLeft a:mAnkleLeft -:mFootLeft t:mToeLeft",
        "c:mCollarLeft s:mShoulderLeft e:mElbowLeft w:mWristLeft",
        ("Left", "Right"),
    ),
    "auto-rig pro": Rig(
        "root.x spine_01.x spine_02.x",
        "n:neck.x d:head.x",
        "h:thigh_stretch.l k:leg_stretch.l a:foot.l t:toes_01.l",
        "c:shoulder.l s:arm_stretch.l e:forearm_stretch.l w:hand.l",
        (".l", ".r"),
    ),
    "source engine": Rig(
        "ValveBiped.Bip01_Pelvis ValveBiped.Bip01_Spine ValveBiped.Bip01_Spine1",
        "n:ValveBiped.Bip01_Neck1 d:ValveBiped.Bip01_Head1",
        "h:ValveBiped.Bip01_L_Thigh k:ValveBiped.Bip01_L_Calf a:ValveBiped.Bip01_L_Foot t:ValveBiped.Bip01_L_Toe0",
        "c:ValveBiped.Bip01_L_Clavicle s:ValveBiped.Bip01_L_UpperArm e:ValveBiped.Bip01_L_Forearm"
        " w:ValveBiped.Bip01_L_Hand",
        ("_L_", "_R_"),
    ),
    "joint suffixes": Rig(
        "hips_JNT spine_JNT spine1_JNT",
        "n:neck_JNT d:head_JNT",
        "h:l_upleg_JNT k:l_leg_JNT a:l_foot_JNT t:l_toebase_JNT",
        "c:l_shoulder_JNT s:l_arm_JNT e:l_forearm_JNT w:l_hand_JNT",
        ("l_", "r_"),
    ),
    "game avatar": Rig(
        "LowerTorso UpperTorso",
        "d:Head",
        "h:LeftUpperLeg k:LeftLowerLeg a:LeftFoot",
        "s:LeftUpperArm e:LeftLowerArm w:LeftHand",
        ("Left", "Right"),
    ),
    "spaces and rolls": Rig(
        "Hips Spine",
        "n:Neck d:Head",
        "h:Left_Up_Leg x:Left_Up_Leg_Roll k:Left_Leg a:Left_Foot t:Left_Toe_Base",
        "c:Left_Shoulder s:Left_Arm x:Left_Arm_Roll e:Left_Fore_Arm w:Left_Hand",
        ("Left", "Right"),
    ),
    "spanish": Rig(
        "cadera columna pecho",
        "n:cuello d:cabeza",
        "h:muslo_izq k:rodilla_izq a:tobillo_izq t:dedos_izq",
        "c:clavicula_izq s:brazo_izq e:codo_izq w:muneca_izq",
        ("_izq", "_der"),
    ),
    "motion builder": Rig(
        "Character1_Hips Character1_Spine Character1_Spine1",
        "n:Character1_Neck d:Character1_Head",
        "h:Character1_LeftUpLeg k:Character1_LeftLeg a:Character1_LeftFoot t:Character1_LeftToeBase",
        "c:Character1_LeftShoulder s:Character1_LeftArm e:Character1_LeftForeArm x:L_Radius_RIGMESH"
        " w:Character1_LeftHand",
        ("Left", "Right"),
    ),
}


def tree(rig: Rig) -> tuple[list[str], list[int], dict[str, int]]:
    """Names, parents and landmarks of a rig."""
    names: list[str] = []
    parents: list[int] = []
    marks: dict[str, int] = {}

    def grow(words: list[str], parent: int, side: str) -> int:
        for word in words:
            role, _, name = word.partition(":")
            name = name if side != "right" else mirrored(name, rig.sides)
            names.append(name)
            parents.append(parent)
            if role in ROLES:
                marks[f"{side}_{ROLES[role]}" if side else ROLES[role]] = len(names) - 1
            if role != "x":
                parent = len(names) - 1
        return parent

    top = grow([f"-:{name}" for name in rig.trunk.split()], -1, "")
    for side in ("left", "right"):
        grow(rig.leg.split(), 0, side)
        grow(rig.arm.split(), top, side)
    grow(rig.head.split(), top, "")
    return names, parents, marks


def mirrored(name: str, sides: tuple[str, str]) -> str:
    """The right joint's name of a left one."""
    left, right = sides
    if len(left) == 1 and left.isascii():
        return right + name[1:]
    return right + name[len(left) :] if name.startswith(left) else right.join(name.rsplit(left, 1))


def standing(rig: Rig) -> np.ndarray:
    """A standing figure (J, 3) of a rig in metres, Y up, facing +Z, arms out; side branches lie beside their joint."""
    names, parents, marks = tree(rig)
    where = {
        "hip": (0.1, 0.9, 0.0), "knee": (0.1, 0.5, 0.02), "ankle": (0.1, 0.08, 0.0), "toe": (0.1, 0.02, 0.13),
        "collar": (0.05, 1.4, 0.0), "shoulder": (0.18, 1.42, 0.0), "elbow": (0.45, 1.42, -0.01),
        "wrist": (0.7, 1.42, 0.0), "neck": (0.0, 1.5, 0.0), "head": (0.0, 1.6, 0.02),
    }  # fmt: skip
    trunk = len(rig.trunk.split())
    places = np.full((len(names), 3), np.nan)
    places[:trunk] = np.linspace((0, 0.95, 0), (0, 1.38, 0), trunk)
    for mark, joint in marks.items():
        side, _, role = mark.rpartition("_")
        places[joint] = np.array(where[role]) * [-1 if side == "right" else 1, 1, 1]
    for joint in range(len(names)):
        if np.isnan(places[joint]).any():
            places[joint] = _between(joint, parents, places)
    return places


def _between(joint: int, parents: list[int], places: np.ndarray) -> np.ndarray:
    """A place on the way from a joint's parent to the next joint known below, else just beyond the parent."""
    start = places[parents[joint]]
    below = joint
    while np.isnan(places[below]).any() and below in parents[below:]:
        below = parents.index(below, below)
    if np.isnan(places[below]).any():
        return start + np.array([0.0, -0.01, 0.02])
    return (start + places[below]) / 2
