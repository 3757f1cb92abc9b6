"""The hierarchy of a BVH file: joints with their offsets and channels."""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from functools import lru_cache
from os import PathLike

import numpy as np
from numpy.typing import NDArray

from encoders.errors import UnreadableMotion
from indexer.formats.kinematics import tips
from indexer.formats.numbers import as_number

MAX_JOINTS = 2048
MAX_CHANNELS = 12
MAX_NAME = 256

_MAX_KEPT = 1 << 20  # bytes of a hierarchy that is remembered for the next file

# What stands between words is never a part of them, so that nothing is tried twice over.
_BEGIN = re.compile(r"\ufeff?\s*hierarchy\b", re.IGNORECASE)
_TOKEN = re.compile(
    r"[\s,;]*(?:(?P<brace>[{}])|(?P<offset>offset)\b|(?P<channels>channels)\b"
    r"|(?P<site>end[ \t_]*site)|(?P<joint>root|joint)\b)",
    re.IGNORECASE,
)
_NAME = re.compile(r"[^\r\n{]*")
_NUMBERS = re.compile(r"(?:[-+.,;:\d\s]|e[-+\d])*", re.IGNORECASE)
_CHANNELS = re.compile(r"[\s,:]*(\d*)((?:[\s,]*\b[xyz](?:position|rotation|translation|pos|rot)\b)*)", re.IGNORECASE)


@dataclass
class Joint:
    """A joint: number of its parent, offset from there (3,), channels as ("p" or "r", axis) in the order written.

    Files of one skeleton share it, so that it is not to be changed once it is read.
    """

    name: str
    parent: int
    is_site: bool = False
    offset: NDArray[np.float64] = field(default_factory=lambda: np.zeros(3))
    channels: list[tuple[str, int]] = field(default_factory=list)


def read_hierarchy(path: str | PathLike[str], header: bytes) -> list[Joint]:
    """The joints of the text before MOTION, parents before children; last joints that turn have an end site.

    Raises
    ------
    UnreadableMotion
        Where it is no hierarchy; names the line.
    """
    try:
        parse = _parsed if len(header) <= _MAX_KEPT else _parsed.__wrapped__
        return list(parse(header))
    except ValueError as error:
        raise UnreadableMotion(path, str(error)) from None


@lru_cache(maxsize=16)  # few skeletons belong to all motions of a folder
def _parsed(header: bytes) -> tuple[Joint, ...]:
    """The joints; raises ValueError with what is wrong."""
    text = _decode(header)
    begin = _BEGIN.match(text)
    if begin is None:
        raise ValueError("the file does not begin with HIERARCHY")
    joints: list[Joint] = []
    stack: list[int] = []
    waiting: int | None = None
    at, end = begin.end(), len(text.rstrip(" \t\r\n,;"))
    while at < end:
        token = _TOKEN.match(text, at)
        if token is None:
            raise ValueError(f"the hierarchy cannot be read at {_place(text, at)}")
        here, at = token.start(), token.end()
        if token["joint"] or token["site"]:
            if waiting is not None:
                raise ValueError(f"an opening brace is missing before {_place(text, here)}")
            if token["site"] and not stack:
                raise ValueError("an End Site stands outside any joint")
            parent = stack[-1] if stack else -1
            written = _NAME.match(text, at)
            assert written is not None
            at = written.end()
            name = f"{joints[parent].name}_end" if token["site"] else written[0].strip(" \t,:\"'")[:MAX_NAME]
            waiting = len(joints)
            joints.append(Joint(name or f"joint{waiting}", parent, bool(token["site"])))
            if len(joints) > MAX_JOINTS:
                raise ValueError(f"more than {MAX_JOINTS} joints: this is no skeleton of a person")
        elif token["brace"] == "{":
            if waiting is None:
                raise ValueError(f"an opening brace without a joint at {_place(text, here)}")
            stack.append(waiting)
            waiting = None
        elif not stack:
            raise ValueError(f"the hierarchy is out of order at {_place(text, here)}")
        elif token["brace"]:
            stack.pop()
        elif token["offset"]:
            written = _NUMBERS.match(text, at)
            assert written is not None
            offset = three_numbers(written[0])
            if offset is None:
                raise ValueError(f"the hierarchy cannot be read at {_place(text, here)}")
            joints[stack[-1]].offset, at = offset, written.end()
        else:
            written = _CHANNELS.match(text, at)
            assert written is not None
            words = re.findall(r"[xyz][a-z]+", written[2].lower())
            if str(len(words)) != written[1].lstrip("0").rjust(1, "0") or len(words) > MAX_CHANNELS:
                raise ValueError(f"CHANNELS {written[1]} names {len(words)} channels")
            joints[stack[-1]].channels = [("r" if w[1] == "r" else "p", "xyz".index(w[0])) for w in words]
            at = written.end()
    if stack or waiting is not None:
        raise ValueError(f"the hierarchy is not closed: {len(stack)} closing braces are missing")
    if not joints:
        raise ValueError("the hierarchy holds no joints")
    return tuple(_with_tips(joints))


def three_numbers(text: str) -> NDArray[np.float64] | None:
    """The three numbers of a text, parted by spaces or commas, or with decimal commas; None if it holds none such."""
    words = [word.strip(",;:") for word in text.split()]
    words = [word for word in words if word]
    if len(words) == 3:
        words = [word.replace(",", ".") for word in words]
    else:
        words = re.split(r"[\s,;:]+", text.strip(" \t\r\n,;:"))
    values = np.array([as_number(word.encode()) for word in words])
    return values if values.shape == (3,) and np.isfinite(values).all() else None


def _with_tips(joints: list[Joint]) -> list[Joint]:
    """The joints, and an end site for each last one that turns but has none."""
    parents = np.array([joint.parent for joint in joints])
    rest = rest_positions(joints)
    added = [
        Joint(f"{joints[leaf].name}_end", leaf, True, step)
        for leaf, step in tips(parents, rest)
        if joints[leaf].channels
    ]
    return joints + added


def rest_positions(joints: list[Joint]) -> NDArray[np.float64]:
    """Where the joints are without any channel, (J, 3)."""
    rest = np.zeros((len(joints), 3))
    for i, joint in enumerate(joints):
        rest[i] = joint.offset + (rest[joint.parent] if joint.parent >= 0 else 0)
    return rest


def _place(text: str, at: int) -> str:
    rest = text[at:].lstrip()
    line = text.count("\n", 0, len(text) - len(rest)) + 1
    return f"line {line}: {rest.splitlines()[0][:60]!r}" if rest else f"line {line}"


def _decode(header: bytes) -> str:
    try:
        return header.decode("utf-8")
    except UnicodeDecodeError:
        return header.decode("latin-1")
