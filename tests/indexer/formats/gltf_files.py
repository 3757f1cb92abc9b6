"""glTF files of a small movement, written as exporters write them."""

from __future__ import annotations

import base64
import json
import struct
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from scipy.spatial.transform import Rotation

from tests.indexer.performances import Performance

COMPONENTS = {"i1": 5120, "u1": 5121, "i2": 5122, "u2": 5123, "u4": 5125, "f4": 5126}
TYPES = {1: "SCALAR", 3: "VEC3", 4: "VEC4", 16: "MAT4"}


@dataclass
class Asset:
    """A glTF document in the making; `json` may be changed before it is written."""

    json: dict[str, Any] = field(
        default_factory=lambda: {
            "asset": {"version": "2.0"}, "nodes": [], "accessors": [], "bufferViews": [], "buffers": [{}],
        }
    )  # fmt: skip
    data: bytearray = field(default_factory=bytearray)

    def view(self, data: bytes, **more: Any) -> int:
        """Put bytes into the buffer."""
        self.data += b"\0" * (-len(self.data) % 4)
        self.json["bufferViews"].append({"buffer": 0, "byteOffset": len(self.data), "byteLength": len(data), **more})
        self.data += data
        return len(self.json["bufferViews"]) - 1

    def accessor(self, values: np.ndarray, kind: str = "f4", *, stride: int = 0, **more: Any) -> int:
        """Store numbers (N,) or (N, C), as normalized integers where `kind` is of integers."""
        values = np.asarray(values, float).reshape(len(values), -1)
        if kind != "f4":
            values = np.round(values * np.iinfo(kind).max)
            more["normalized"] = True
        rows = np.ascontiguousarray(values.astype(f"<{kind}")).view(np.uint8).reshape(len(values), -1)
        if stride:
            rows = np.concatenate([rows, np.full((len(rows), stride - rows.shape[1]), 170, np.uint8)], axis=1)
        view = self.view(rows.tobytes(), **({"byteStride": stride} if stride else {}))
        self.json["accessors"].append(
            {
                "bufferView": view, "componentType": COMPONENTS[kind], "count": len(values),
                "type": TYPES[values.shape[1]], **more,
            }
        )  # fmt: skip
        return len(self.json["accessors"]) - 1

    def animate(
        self, name: str | None, channels: list[tuple[int, str, int, int]], interpolation: str = "LINEAR"
    ) -> None:
        """Add an animation of channels (node, path, input, output)."""
        self.json.setdefault("animations", []).append(
            {
                **({} if name is None else {"name": name}),
                "samplers": [{"input": i, "output": o, "interpolation": interpolation} for *_, i, o in channels],
                "channels": [
                    {"sampler": s, "target": {"node": node, "path": path}}
                    for s, (node, path, *_) in enumerate(channels)
                ],
            }
        )  # fmt: skip

    def glb(self) -> bytes:
        """As one file."""
        document = {**self.json, "buffers": [{"byteLength": len(self.data)}]}
        text = json.dumps(document).encode()
        text += b" " * (-len(text) % 4)
        data = bytes(self.data) + b"\0" * (-len(self.data) % 4)
        size = 12 + 8 + len(text) + 8 + len(data)
        head = b"glTF" + struct.pack("<II", 2, size) + struct.pack("<II", len(text), 0x4E4F534A)
        return head + text + struct.pack("<II", len(data), 0x004E4942) + data

    def gltf(self, uri: str | None = None) -> bytes:
        """As JSON with the buffer inside, or in the file that `uri` names."""
        uri = uri or "data:application/octet-stream;base64," + base64.b64encode(self.data).decode()
        return json.dumps({**self.json, "buffers": [{"byteLength": len(self.data), "uri": uri}]}).encode()


def asset_of(
    acted: Performance, *, with_skin: bool = True, rotations: str = "f4", name: str | None = "Walk", keys: int = 1
) -> Asset:
    """A performance as a glTF asset: nodes 0 to J - 1 are the joints, with a skin and one animation of them.

    Parameters
    ----------
    rotations : str
        Kind of the quaternions' numbers.
    keys : int
        Only every so many frames have keys.
    """
    asset = Asset()
    asset.json["nodes"] = [
        {
            "name": joint, "translation": acted.offsets[i].tolist(),
            "children": [kid for kid, parent in enumerate(acted.parents) if parent == i],
        }
        for i, joint in enumerate(acted.names)
    ]  # fmt: skip
    times = asset.accessor(np.arange(len(acted.root))[::keys] / acted.fps)
    channels = [(0, "translation", times, asset.accessor(acted.root[::keys]))]
    for joint in range(len(acted.names)):
        quaternions = Rotation.from_matrix(acted.rotations[::keys, joint]).as_quat()
        channels.append((joint, "rotation", times, asset.accessor(quaternions, rotations)))
    asset.animate(name, channels)
    if with_skin:
        bind = np.repeat(np.eye(4)[None], len(acted.names), axis=0)
        for joint, parent in enumerate(acted.parents):
            bind[joint, :3, 3] = acted.offsets[joint] + (bind[parent, :3, 3] if parent >= 0 else 0)
        inverse = np.linalg.inv(bind).swapaxes(1, 2).reshape(-1, 16)
        skin = {"joints": list(range(len(acted.names))), "inverseBindMatrices": asset.accessor(inverse)}
        asset.json["skins"] = [skin]
        asset.json["nodes"].append({"name": "Body", "mesh": 0, "skin": 0})
    return asset


def positions_of(acted: Performance) -> np.ndarray:
    """Where the joints of a performance are, (T, J, 3), by forward kinematics of its own."""
    turns = np.empty_like(acted.rotations)
    places = np.empty((*acted.rotations.shape[:2], 3))
    for joint, parent in enumerate(acted.parents):
        if parent < 0:
            turns[:, joint], places[:, joint] = acted.rotations[:, joint], acted.root
        else:
            turns[:, joint] = turns[:, parent] @ acted.rotations[:, joint]
            places[:, joint] = places[:, parent] + turns[:, parent] @ acted.offsets[joint]
    return places


if __name__ == "__main__":  # makes the small file of the tests
    from pathlib import Path

    from tests.indexer.performances import performance

    small = asset_of(performance("bandai", frames=31, fps=30), rotations="i2")
    (Path(__file__).resolve().parents[2] / "data" / "walk.glb").write_bytes(small.glb())
