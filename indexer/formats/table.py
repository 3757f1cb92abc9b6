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
from indexer.formats import amc, bvh, npy, npz
from indexer.take import Take

#: Bytes at the start of a file in which its signature is looked for, and that of a companion.
START, COMPANION_START = 4096, 65_536
_BOM = b"\xef\xbb\xbf"


class Companion(NamedTuple):
    """A file beside a motion that the motion is read with: its ending, and bytes that tell it from the motion."""

    ending: str
    signature: bytes


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
        Whether a file can state its frame rate.
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
    Format(".bvh", bvh.read, rb"hierarchy", is_text=True),
    Format(".amc", amc.read, rb".*:(fully-specified|degrees|radians)", is_text=True,
           default_fps=120.0, states_fps=False, companion=Companion(".asf", b":bonedata")),
    Format(".npy", npy.read, rb"\x93numpy", default_fps=20.0, states_fps=False),
    Format(".npz", npz.read, rb"pk", needs_ending=True, default_fps=20.0),
)
# fmt: on
READABLE: dict[str, Format] = {row.ending: row for row in FORMATS}


class UnsupportedFormat(NamedTuple):
    """A format that is known but cannot be read.

    Files of motion (`is_motion`) are listed as failed where a folder is indexed; the others are passed over. Some
    formats (`is_scene`) open in programs that write BVH.
    """

    name: str
    endings: tuple[str, ...]
    signatures: tuple[bytes, ...] = ()
    is_scene: bool = False
    is_motion: bool = True


UNSUPPORTED = (
    UnsupportedFormat("FBX", (".fbx",), (b"kaydara fbx binary", b"; fbx"), is_scene=True),
    UnsupportedFormat("glTF", (".glb", ".gltf"), (b"gltf",), is_scene=True),
    UnsupportedFormat("USD", (".usd", ".usda", ".usdc", ".usdz"), (b"#usda", b"pxr-usdc"), is_scene=True),
    UnsupportedFormat("Collada", (".dae",), is_scene=True),
    UnsupportedFormat("C3D", (".c3d",), is_scene=True),
    UnsupportedFormat("TRC", (".trc",), is_scene=True),
    UnsupportedFormat("Blender", (".blend",), is_scene=True),
    UnsupportedFormat("Alembic", (".abc",)),
    UnsupportedFormat("ANIM", (".anim",)),
    UnsupportedFormat("Biped", (".bip",)),
    UnsupportedFormat("CSM", (".csm",)),
    UnsupportedFormat("HTR", (".htr",)),
    UnsupportedFormat("MVNX", (".mvnx",)),
    UnsupportedFormat("Motive TAK", (".tak",)),
    UnsupportedFormat("VMD", (".vmd",)),
    UnsupportedFormat("VRM", (".vrm", ".vrma")),
    UnsupportedFormat("pickle", (".pkl",), is_motion=False),
    UnsupportedFormat("PyTorch", (".pt",), is_motion=False),
    UnsupportedFormat("CSV", (".csv",), is_motion=False),
    UnsupportedFormat("ZIP", (".zip",), is_motion=False),
)
_UNSUPPORTED_ENDINGS = {ending: row for row in UNSUPPORTED for ending in row.endings}


def is_motion(ending: str) -> bool:
    """Whether files of an ending are motions, whether or not they can be read."""
    return ending in READABLE or (ending in _UNSUPPORTED_ENDINGS and _UNSUPPORTED_ENDINGS[ending].is_motion)


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
    unsupported = next((row for row in UNSUPPORTED if start.startswith(row.signatures)), None)
    if unsupported is None:
        for row in FORMATS:
            if row.companion and is_text and row.companion.signature in data[:COMPANION_START].lower():
                raise UnreadableMotion(
                    path, f"this is a skeleton without motion; read the {row.ending} files that belong to it"
                )
            fits = is_text or not row.is_text
            if fits and re.match(row.signature, start, re.DOTALL) and (ending == row.ending or not row.needs_ending):
                return row
        if is_text and ending in READABLE and READABLE[ending].is_text:
            return READABLE[ending]
        unsupported = _UNSUPPORTED_ENDINGS.get(ending)
    if unsupported is not None and unsupported.is_scene:
        raise UnreadableMotion(
            path, f"{unsupported.name} cannot be read; export it as BVH, as Blender and MotionBuilder do"
        )
    name = "this kind of file" if unsupported is None else unsupported.name
    raise UnreadableMotion(path, f"{name} cannot be read; what can be: {', '.join(READABLE)}")
