"""The table of formats: for each its ending, reader, signature, companion files and default frame rate.

Which frame rate a file is read at, and what overrides it: `indexer.store.read_options`.

A new format is one module beside this one, with a function `read(path, data, *, fps=None) -> list[Take]`, and one row
here. Modules are imported when a file is read: most commands only need to know the endings.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from importlib import import_module
from os import PathLike
from pathlib import Path
from typing import NamedTuple

from encoders.errors import UnreadableMotion
from indexer.formats.refused import REFUSED
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
    module : str
        The module that reads it, within `indexer.formats`.
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
    module: str
    signature: bytes
    is_text: bool = False
    needs_ending: bool = False
    default_fps: float | None = None
    states_fps: bool = True
    companion: Companion | None = None

    def read(self, path: str | PathLike[str], data: bytes, *, fps: float | None = None) -> list[Take]:
        """The takes of a file, at least one; `fps` overrides what the file states."""
        takes: list[Take] = import_module(f"indexer.formats.{self.module}").read(path, data, fps=fps)
        return takes


# fmt: off
FORMATS = (
    Format(".bvh", "bvh.bvh_reader", rb"hierarchy", is_text=True),
    Format(".amc", "acclaim.amc", rb".*:(fully-specified|degrees|radians)", is_text=True,
           default_fps=120.0, states_fps=False, companion=Companion(".asf", b":bonedata")),
    Format(".fbx", "fbx.fbx", rb"kaydara fbx binary|; *fbx|fbxheaderextension"),
    Format(".npy", "numpy_files.npy", rb"\x93numpy", default_fps=20.0, states_fps=False),
    Format(".npz", "numpy_files.npz", rb"pk", needs_ending=True, default_fps=20.0),
    Format(".glb", "gltf.gltf_reader", rb"gltf"),
    Format(".gltf", "gltf.gltf_reader", rb"\{", needs_ending=True, companion=Companion(".bin", same_name=True)),
    Format(".vrm", "gltf.gltf_reader", rb"gltf"),
    Format(".vrma", "gltf.gltf_reader", rb"gltf"),
    Format(".usd", "usd.usd_reader", rb"#usda|pxr-usdc"),
    Format(".usda", "usd.usd_reader", rb"#usda"),
    Format(".usdc", "usd.usd_reader", rb"pxr-usdc"),
    Format(".usdz", "usd.usd_reader", rb"pk", needs_ending=True),
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
    if ending in READABLE:
        raise UnreadableMotion(path, f"cannot be read as {ending[1:].upper()}; it may be damaged or misnamed")
    raise UnreadableMotion(path, f"this kind of file cannot be read; what can be: {', '.join(READABLE)}")


def _matches(signature: bytes, start: bytes) -> bool:
    return re.match(signature, start, re.DOTALL) is not None
