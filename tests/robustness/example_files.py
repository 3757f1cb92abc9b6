"""A file of each kind that is read, of a whole body, and captions tables."""

from __future__ import annotations

import io
import json
import zipfile
from pathlib import Path
from typing import NamedTuple

import numpy as np
from scipy.spatial.transform import Rotation

from encoders.motion import Motion
from search.export import bvh_writer
from tests.conftest import ROOT
from tests.indexer.bodies import archived, body, parameters, saved
from tests.indexer.folders import moving
from tests.indexer.formats import fbx_writer as fbx
from tests.indexer.formats.gltf_files import asset_of
from tests.indexer.formats.usd_files import usda
from tests.indexer.performances import bvh, performance

DATA = ROOT / "tests" / "data"


class Example(NamedTuple):
    """Files beside each other; the one that is read is the first, where it is in no archive."""

    read: str
    files: dict[str, bytes]


def examples() -> dict[str, Example]:
    acted = performance("mixamo", frames=20, fps=30)
    angles, way = parameters(up="z")
    amc, asf = _acclaim()
    walk, gltf = bvh(acted).encode(), asset_of(acted)
    exported = io.BytesIO()
    bvh_writer.write(exported, Motion(moving(3, 2.0).astype(np.float32)))
    table = "path,text,start,end,fps\n" + "".join(f"take {i}.bvh,a person walks,{i},{i + 1},\n" for i in range(20))
    rows = [json.dumps({"path": f"{i}.bvh", "text": "he runs", "start": i, "end": i + 1}) for i in range(20)]
    found = {
        "BVH": Example("a.bvh", {"a.bvh": walk}),
        "BVH of ours": Example("a.bvh", {"a.bvh": exported.getvalue()}),
        "AMC": Example("a.amc", {"a.amc": amc, "a.asf": asf}),
        "ASF": Example("a.amc", {"a.asf": asf, "a.amc": amc}),
        "npy": Example("a.npy", {"a.npy": saved(body().astype(np.float32))}),
        "npz": Example("a.npz", {"a.npz": archived(joints=body(), fps=30.0)}),
        "SMPL": Example(
            "a.npz", {"a.npz": archived(poses=angles, trans=way, betas=np.zeros(16), mocap_framerate=np.float64(60))}
        ),
        "stored SMPL": Example("a.npz", {"a.npz": archived(False, poses=angles, trans=way, mocap_framerate=60.0)}),
        "binary FBX": Example("a.fbx", {"a.fbx": fbx.binary(_scene(), 7400)}),
        "old binary FBX": Example("a.fbx", {"a.fbx": fbx.binary(_scene(), 7100, pack=False)}),
        "ASCII FBX": Example("a.fbx", {"a.fbx": fbx.text(_scene())}),
        "GLB": Example("a.glb", {"a.glb": gltf.glb()}),
        "glTF": Example("a.gltf", {"a.gltf": gltf.gltf()}),
        "USD": Example("a.usda", {"a.usda": usda(acted).encode()}),
        "ZIP": Example("a.zip/b/walk.bvh", {"a.zip": _packed({"b/walk.bvh": walk, "a.npy": saved(body())})}),
        "csv": Example("captions.csv", {"captions.csv": table.encode()}),
        "tsv": Example("captions.tsv", {"captions.tsv": table.replace(",", "\t").encode()}),
        "jsonl": Example("captions.jsonl", {"captions.jsonl": "\n".join(rows).encode()}),
        "captions": Example("a.txt", {"a.txt": b"a person walks#a/DET person/NOUN#0.0#2.5\nhe runs\n" * 5}),
    }  # fmt: skip
    return found


def _acclaim() -> tuple[bytes, bytes]:
    """The first 40 frames of the demo's take."""
    demo = ROOT / "search" / "demo_data" / "session_01"
    amc = demo.with_suffix(".amc").read_bytes()
    return amc[: amc.index(b"\n41\n") + 1], demo.with_suffix(".asf").read_bytes()


def _scene() -> fbx.Tree:
    acted = performance("mixamo", frames=20, fps=30)
    nodes, moves, times = [], {}, (np.arange(20) / 30).tolist()
    for joint, name in enumerate(acted.names):
        parent = acted.parents[joint]
        offset = tuple((acted.offsets[joint] * 100).tolist())
        nodes.append(
            fbx.Node(name, parent=acted.names[parent] if parent >= 0 else "", properties={"Lcl Translation": offset})
        )
        angles = Rotation.from_matrix(acted.rotations[:, joint]).as_euler("xyz", degrees=True)
        moves[name, "Lcl Rotation"] = {a: fbx.Keys(times, angles[:, i].tolist()) for i, a in enumerate("XYZ")}
    moves[acted.names[0], "Lcl Translation"] = {
        axis: fbx.Keys(times, (acted.root[:, i] * 100).tolist()) for i, axis in enumerate("XYZ")
    }
    return fbx.scene(nodes, [fbx.Stack("Walk", [fbx.Layer(moves)], (0, 19 / 30))])


def _packed(files: dict[str, bytes]) -> bytes:
    stream = io.BytesIO()
    with zipfile.ZipFile(stream, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, data in files.items():
            archive.writestr(name, data)
    return stream.getvalue()


def write(example: Example, folder: Path) -> Path:
    """Write an example's files; the path that is read."""
    for name, data in example.files.items():
        (folder / name).write_bytes(data)
    return folder / example.read
