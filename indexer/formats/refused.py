"""Formats that are known and cannot be read: what tells such a file, and what to do with it."""

from __future__ import annotations

from typing import NamedTuple


class Refused(NamedTuple):
    """A format that is known but cannot be read.

    `signature` is a pattern as in `indexer.formats.table.Format`, empty where nothing tells such a file but its ending.
    Files of motion (`is_motion`) are listed as failed where a folder is indexed; the others are passed over.
    """

    name: str
    endings: tuple[str, ...]
    advice: str
    signature: bytes = b""
    is_motion: bool = True


#: Endings of archives that are not read. A .gz file is read where it is named, so it is none of them.
PACKINGS = (".tar", ".tgz", ".bz2", ".xz", ".zst", ".7z", ".rar")

_XML = rb"(<[?!][^>]*>\s*)*"
_SOLVE = "it holds markers and no skeleton: solve them in MotionBuilder or the program that recorded it, and export BVH"
_TRUST = "to open one is to run what is in it; if you trust it and it holds arrays by name:"
_SAVE = "save its joints (frames, 22, 3) in SMPL order with numpy.savez('walk.npz', joints=joints, fps=30)"

# fmt: off
REFUSED = (
    Refused("Collada", (".dae",), "convert it to glTF, as assimp and Blender up to 4.5 do", _XML + rb"<collada"),
    Refused("Blender", (".blend",), "export glTF or BVH from Blender", rb"blender[-_\d]"),
    Refused("Maya", (".ma", ".mb"), "export its skeleton as FBX from Maya", rb"//maya ascii|for[48].{4,12}maya"),
    Refused("3ds Max", (".max",), "export its skeleton as FBX from 3ds Max"),
    Refused("Cinema 4D", (".c4d",), "export its skeleton as FBX or glTF from Cinema 4D", rb"qc4dc4d6"),
    Refused("Biped", (".bip",), "load it onto a Biped in 3ds Max and export FBX"),
    Refused("C3D", (".c3d",), _SOLVE, rb"[\x01-\x08]p"),
    Refused("TRC", (".trc",), _SOLVE, rb"pathfiletype\s"),
    Refused("CSM", (".csm",), _SOLVE, rb"\$comments|\$filename"),
    Refused("HTR", (".htr", ".htr2"), "import it in MotionBuilder and export BVH", rb"(#[^\n]*\n\s*)*\[header\]"),
    Refused("MVNX", (".mvnx", ".mvn"), "export BVH or FBX from Xsens MVN", _XML + rb"<mvnx"),
    Refused("Motive TAK", (".tak",), "export its skeletons as BVH or FBX from Motive"),
    Refused("ANIM", (".anim",), "export the animated character as FBX, from Unity by its FBX Exporter or from Maya",
            rb"%yaml 1\.1\s+%tag !u! tag:unity3d|animversion\s"),
    Refused("VMD", (".vmd",), "import it in Blender onto its model with MMD Tools, and export glTF or BVH",
            rb"vocaloid motion data"),
    Refused("MD5 or SMD", (".md5anim", ".smd"), "import it in Blender onto its model, and export glTF or BVH"),
    Refused("Alembic", (".abc",), "it holds surfaces and no skeleton: export the rig that it was made with", rb"ogawa"),
    Refused("pickle", (".pkl", ".pickle"), f"{_TRUST} numpy.savez('a.npz', **numpy.load('a.pkl', allow_pickle=True))",
            is_motion=False),
    Refused("PyTorch", (".pt", ".pth"), f"{_TRUST} numpy.savez('a.npz', **torch.load('a.pt', map_location='cpu'))",
            is_motion=False),
    Refused("CSV", (".csv",), _SAVE, is_motion=False),
    Refused("an archive of this kind", PACKINGS, "unpack it, or pack it as .zip",
            rb"7z\xbc\xaf|rar!\x1a|\xfd7zxz|bzh[1-9]1ay|.{257}ustar", is_motion=False),
    Refused("ZIP", (".zip",), "unpack it", is_motion=False),
)
# fmt: on
