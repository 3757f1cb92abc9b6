"""The table of formats: for each its ending, reader, signature, companion files and default frame rate.

Which frame rate a file is read at, and what overrides it: `indexer.store.read_options`.

A new format is one module beside this one, with a function `read(path, data, *, fps=None) -> list[Take]`, and one row
here.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass
from os import PathLike
from pathlib import Path
from typing import NamedTuple

from encoders.errors import UnreadableMotion
from indexer.formats.acclaim import amc
from indexer.formats.bvh import bvh_reader
from indexer.formats.fbx import fbx
from indexer.formats.gltf import gltf_reader
from indexer.formats.numpy_files import npy, npz
from indexer.formats.refused import REFUSED
from indexer.formats.usd import usd_reader
from indexer.take import Take

#: Bytes at the start of a file in which its signature is looked for, and that of a companion.
START, COMPANION_START = 4096, 65_536
_BOM = b"\xef\xbb\xbf"


class Companion(NamedTuple):
    """Files beside a motion that it may be read with.

    Attributes
    ----------
    ending : str
    signature : bytes
        What tells such a file from the motion; empty where nothing does.
    same_name : bool
        Whether only one of the motion's own name is taken.
    """

    ending: str
    signature: bytes = b""
    same_name: bool = False


@dataclass(frozen=True)
class Format:
    """A format that can be read.

    Attributes
    ----------
    ending : str
        In lower case, with the dot.
    read : callable
        (path, data, *, fps) -> the takes of the file, at least one; `fps` overrides what the file states.
    signature : regular expression
        Matches the start of such a file in lower case, after white space and byte order mark.
    is_text : bool
        A text is taken for this format by its ending, too.
    needs_ending : bool
        Other formats share the signature, so that the ending must be right as well.
    default_fps : float or None
        Frame rate of a file that states none and for which none is given; None where every file states one.
    states_fps : bool
        Whether every file states its frame rate; an AMC may.
    companion : Companion or None
    """

    ending: str
    read: Callable[..., list[Take]]
    signature: bytes
    is_text: bool = False
    needs_ending: bool = False
    default_fps: float | None = None
    states_fps: bool = True
    companion: Companion | None = None


# fmt: off
FORMATS = (
    Format(".bvh", bvh_reader.read, rb"hierarchy", is_text=True),
    Format(".amc", amc.read, rb".*:(fully-specified|degrees|radians)", is_text=True,
           default_fps=120.0, states_fps=False, companion=Companion(".asf", b":bonedata")),
    Format(".fbx", fbx.read, rb"kaydara fbx binary|; *fbx|fbxheaderextension"),
    Format(".npy", npy.read, rb"\x93numpy", default_fps=20.0, states_fps=False),
    Format(".npz", npz.read, rb"pk", needs_ending=True, default_fps=20.0),
    Format(".glb", gltf_reader.read, rb"gltf"),
    Format(".gltf", gltf_reader.read, rb"\{", needs_ending=True, companion=Companion(".bin", same_name=True)),
    Format(".vrm", gltf_reader.read, rb"gltf"),
    Format(".vrma", gltf_reader.read, rb"gltf"),
    Format(".usd", usd_reader.read, rb"#usda|pxr-usdc"),
    Format(".usda", usd_reader.read, rb"#usda"),
    Format(".usdc", usd_reader.read, rb"pxr-usdc"),
    Format(".usdz", usd_reader.read, rb"pk", needs_ending=True),
)
# fmt: on
READABLE: dict[str, Format] = {row.ending: row for row in FORMATS}
_REFUSED_ENDINGS = {ending: row for row in REFUSED for ending in row.endings}


def is_motion(ending: str) -> bool:
    """Whether files of an ending are motions, whether or not they can be read."""
    return ending in READABLE or (ending in _REFUSED_ENDINGS and _REFUSED_ENDINGS[ending].is_motion)


def detect(path: str | PathLike[str], data: bytes) -> Format:
    """The format of a file: by its content, else by its ending.

    Parameters
    ----------
    data : bytes
        Its content, or the first `COMPANION_START` bytes.

    Raises
    ------
    UnreadableMotion
        If it is of none that can be read; says what it is, and what to do.
    """
    ending = Path(path).suffix.lower()
    start = data[:START].removeprefix(_BOM).lstrip().lower()
    is_text = b"\0" not in start
    refused = next((row for row in REFUSED if row.signature and _matches(row.signature, start)), None)
    if refused is None:
        for row in FORMATS:
            mark = row.companion.signature if row.companion else b""
            if mark and is_text and mark in data[:COMPANION_START].lower():
                raise UnreadableMotion(
                    path, f"this is a skeleton without motion; read the {row.ending} files that belong to it"
                )
            fits = is_text or not row.is_text
            if fits and _matches(row.signature, start) and (ending == row.ending or not row.needs_ending):
                return row
        if is_text and ending in READABLE and READABLE[ending].is_text:
            return READABLE[ending]
        refused = _REFUSED_ENDINGS.get(ending)
    if refused is not None:
        raise UnreadableMotion(path, f"{refused.name} cannot be read; {refused.advice}")
    raise UnreadableMotion(path, f"this kind of file cannot be read; what can be: {', '.join(READABLE)}")


def _matches(signature: bytes, start: bytes) -> bool:
    return re.match(signature, start, re.DOTALL) is not None
