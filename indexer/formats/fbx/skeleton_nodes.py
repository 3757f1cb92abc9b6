"""Which models of a scene are a skeleton's joints."""

from __future__ import annotations

from collections import Counter, defaultdict

from indexer.formats.fbx.objects import FbxScene

_BONES = ("LimbNode", "Limb", "Root", "Effector")
_PASSIVE = ("Null", "None", "", "Mesh")
#: Bones below a model from which on it holds a whole figure and is no joint of one.
_FIGURE = 15


def joints_of(scene: FbxScene, turning: set[int]) -> list[int]:
    """The joints' places among the scene's models, parents before children.

    They are the bones and the models that move a skin; where more others turn than there are of these, the models that
    turn, as in rigs of nulls or boxes. With them come the models that stand between joints, the one that joins them,
    and the nulls that hang on them.

    Parameters
    ----------
    turning : set of int
        Models whose rotation moves in any animation.
    """
    models = scene.models
    bones = {at for at, model in enumerate(models) if model.kind in _BONES} | scene.skinned
    others = {at for at in turning - bones if models[at].kind in _PASSIVE}
    if len(others) > len(bones):
        bones |= others
    below = _bones_below(scene, bones)
    joints = set(bones)
    for at, branches in below.items():
        if at < 0 or at in bones:
            continue
        hangs_on_bone = _has_ancestor(scene, at, bones)
        figures = sum(count >= _FIGURE for count in branches.values())
        if hangs_on_bone or (len(branches) > 1 and figures < 2):
            joints.add(at)
    for at, model in enumerate(models):  # parents come before children
        if model.parent in joints and model.kind == "Null":
            joints.add(at)
    return sorted(joints)


def _bones_below(scene: FbxScene, bones: set[int]) -> dict[int, Counter[int]]:
    """For each model above bones: how many there are in each of its branches."""
    below: dict[int, Counter[int]] = defaultdict(Counter)
    for bone in bones:
        at = bone
        while (parent := scene.models[at].parent) >= 0:
            below[parent][at] += 1
            at = parent
    return below


def _has_ancestor(scene: FbxScene, at: int, bones: set[int]) -> bool:
    while (at := scene.models[at].parent) >= 0:
        if at in bones:
            return True
    return False
