"""ASF: the skeleton that Acclaim motions refer to."""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from functools import cached_property, lru_cache
from os import PathLike
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from encoders.errors import UnreadableMotion
from indexer.formats.kinematics import Pose, turn
from indexer.formats.opening import read_bytes

MAX_BYTES = 4_000_000
MAX_BONES = 1024
ROOT = "root"

_DECIMAL_COMMA = re.compile(r"(?<!\S)([-+]?\d+),(\d+)(?!\S)")


@dataclass
class Bone:
    """A bone: from its parent's tip by `offset` (3,), turning about `axis`, moved by `dof` values a frame.

    `axis` lists (axis, radians) in the order applied; `dof` names such as "rx", "tz" or "l".
    For the root, `offset` is its resting place.
    """

    name: str
    parent: str = ""
    offset: NDArray[np.float64] = field(default_factory=lambda: np.zeros(3))
    axis: list[tuple[int, float]] = field(default_factory=list)
    dof: list[str] = field(default_factory=list)
    is_last: bool = False

    @cached_property
    def axes(self) -> NDArray[np.float64]:
        """Its axes as columns (3, 3)."""
        axes = Pose.identity(1).axes
        for axis, angle in reversed(self.axis):
            axes = turn(axes, axis, np.array([angle]))
        return np.concatenate(axes, axis=1)


@dataclass(frozen=True)
class Skeleton:
    """Bones by name; `order` has parents first; `radians` is the file's unit of angles."""

    bones: dict[str, Bone]
    order: list[Bone]
    radians: bool


def read_skeleton(path: str | PathLike[str]) -> Skeleton:
    """Read an ASF file.

    Raises
    ------
    UnreadableMotion
        If it is no complete skeleton; names the section.
    """
    path = Path(path)
    data = read_bytes(path, max_bytes=MAX_BYTES)
    try:
        return _parsed(data)
    except (ValueError, IndexError, KeyError) as error:
        raise UnreadableMotion(path, f"the skeleton cannot be read: {error}") from None


@lru_cache(maxsize=2)  # one skeleton belongs to all motions of a folder
def _parsed(data: bytes) -> Skeleton:
    sections = _sections(data.decode("latin-1"))
    absent = [name for name in ("root", "bonedata", "hierarchy") if name not in sections]
    if absent:
        raise ValueError(f"it has no :{absent[0]} section")
    radians = any(
        line[:2] == ["angle", "rad"] or line[:2] == ["angle", "radians"] for line in sections.get("units", [])
    )
    bones = {ROOT: _root(sections["root"], radians)}
    for lines in _blocks(sections["bonedata"]):
        bone = _bone(lines, radians)
        bones[bone.name] = bone
    return Skeleton(bones, _order(sections["hierarchy"], bones), radians)


def _sections(text: str) -> dict[str, list[list[str]]]:
    """Lines, split into words, under each `:keyword`."""
    sections: dict[str, list[list[str]]] = {}
    lines: list[list[str]] = []
    for line in text.splitlines():
        words = _DECIMAL_COMMA.sub(r"\1.\2", line.split("#")[0]).replace(",", " ").split()
        if words and words[0].startswith(":"):
            lines = sections.setdefault(words[0][1:].lower(), [])
            if len(words) > 1:
                lines.append(words[1:])
        elif words:
            lines.append(words)
    return sections


def _blocks(lines: list[list[str]]) -> list[list[list[str]]]:
    """What stands between each `begin` and `end`."""
    blocks: list[list[list[str]]] = []
    inside = False
    for words in lines:
        word = words[0].lower()
        if word == "begin":
            inside = True
            blocks.append([])
        elif word == "end":
            inside = False
        elif inside:
            blocks[-1].append(words)
    if inside:
        raise ValueError("a bone is not closed by `end`: the file is cut short")
    if len(blocks) > MAX_BONES:
        raise ValueError(f"more than {MAX_BONES} bones")
    return blocks


def _vector(words: list[str]) -> NDArray[np.float64]:
    vector = np.array([float(word) for word in words[:3]])
    if vector.shape != (3,) or not np.isfinite(vector).all():
        raise ValueError(f"{' '.join(words)!r} are no three numbers")
    return vector


def _turns(angles: NDArray[np.float64], order: str, radians: bool) -> list[tuple[int, float]]:
    values = angles if radians else np.deg2rad(angles)
    return [("xyz".index(axis), float(value)) for axis, value in zip(order.lower(), values, strict=True)]


def _root(lines: list[list[str]], radians: bool) -> Bone:
    entries = {words[0].lower(): words[1:] for words in lines}
    angles = _vector(entries.get("orientation", ["0", "0", "0"]))
    return Bone(
        ROOT,
        offset=_vector(entries.get("position", ["0", "0", "0"])),
        axis=_turns(angles, entries.get("axis", ["XYZ"])[0], radians),
        dof=_dof(entries.get("order", ["TX", "TY", "TZ", "RX", "RY", "RZ"])),
    )


def _bone(lines: list[list[str]], radians: bool) -> Bone:
    entries = {words[0].lower(): words[1:] for words in lines}
    axis = entries.get("axis", ["0", "0", "0", "XYZ"])
    direction = _vector(entries["direction"])
    size = float(np.linalg.norm(direction))
    length = float(entries["length"][0])
    if not np.isfinite(length):
        raise ValueError(f"bone {entries['name'][0]} has no length")
    return Bone(
        entries["name"][0],
        offset=direction * (length / size if size else 0.0),
        axis=_turns(_vector(axis), axis[3] if len(axis) > 3 else "XYZ", radians),
        dof=_dof(entries.get("dof", [])),
    )


def _dof(words: list[str]) -> list[str]:
    dof = [word.lower() for word in words]
    unknown = [word for word in dof if word not in ("rx", "ry", "rz", "tx", "ty", "tz", "l")]
    if unknown:
        raise ValueError(f"degree of freedom {unknown[0]!r} is none of tx ty tz rx ry rz l")
    return dof


def _order(lines: list[list[str]], bones: dict[str, Bone]) -> list[Bone]:
    """Bones with parents first; sets each bone's parent and whether it is the last of its chain."""
    children: dict[str, list[str]] = {}
    for parent, *kids in lines:
        if parent.lower() in ("begin", "end"):
            continue
        children.setdefault(parent, []).extend(kids)
    order: list[Bone] = []
    waiting = [(ROOT, "")]
    while waiting:
        name, parent = waiting.pop()
        if name not in bones:
            raise ValueError(f"the hierarchy names {name!r}, which is no bone")
        if any(bone.name == name for bone in order):
            raise ValueError(f"{name!r} stands in the hierarchy twice")
        bone = bones[name]
        bone.parent, bone.is_last = parent, not children.get(name)
        order.append(bone)
        waiting.extend((kid, name) for kid in reversed(children.get(name, [])))
    return order
