"""Objects: the models of an FBX scene as a tree, with their properties, and the scene's settings."""

from __future__ import annotations

from collections import defaultdict
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from indexer.formats.fbx.records import DamagedFbx, Record

Identity = int | str
Properties = dict[str, tuple[float, ...]]

#: Frames a second of the time modes 0 to 17; 14 is a rate of the file's own.
_RATES = (30, 120, 100, 60, 50, 48, 30, 30, 30 / 1.001, 30 / 1.001, 25, 24, 1000, 24 / 1.001, 0, 96, 72, 60 / 1.001)
_CUSTOM = 14
_TICKS, _SHORT_TICKS = 46_186_158_000, 141_120_000


@dataclass
class Model:
    """A node of the scene: a bone, a null, a mesh, a camera ...

    `parent` is its place among the scene's models, -1 where nothing is above it.
    """

    identity: Identity
    name: str
    kind: str
    properties: Properties
    parent: int = -1


@dataclass
class FbxScene:
    """What is read of a file beside its animation.

    Attributes
    ----------
    models : list of Model
        Parents before children.
    places : dict
        Place of each model by its identity.
    sources : dict
        For each identity, (identity, property) of what is connected to it.
    bind : dict
        Place of a model -> its matrix (4, 4) in the world when it was bound to its mesh.
    skinned : set of int
        Places of the models that move a mesh.
    fps : float or None
        Frames a second, where the file states a rate.
    ticks : int
        Units of time in a second.
    up : str or None
        The axis that is up.
    unit : float
        Centimetres in a unit.
    has_constraints : bool
    """

    models: list[Model] = field(default_factory=list)
    places: dict[Identity, int] = field(default_factory=dict)
    sources: dict[Identity, list[tuple[Identity, str]]] = field(default_factory=dict)
    bind: dict[int, NDArray[np.float64]] = field(default_factory=dict)
    skinned: set[int] = field(default_factory=set)
    fps: float | None = None
    ticks: int = _TICKS
    up: str | None = None
    unit: float = 1.0
    has_constraints: bool = False


def read_scene(root: Record) -> FbxScene:
    """The scene of a file's records.

    Raises
    ------
    DamagedFbx
        Where the file has no objects.
    """
    objects = root.find("Objects")
    if objects is None:
        raise DamagedFbx("it holds no objects")
    scene = FbxScene(sources=_connections(root), ticks=_ticks(root))
    _read_settings(scene, root.find("GlobalSettings") or objects.find("GlobalSettings"))
    _read_models(scene, root, objects)
    _read_binding(scene, objects)
    scene.has_constraints = objects.find("Constraint") is not None
    return scene


def properties(record: Record) -> Properties:
    """The numbers of a record's properties, by their names."""
    found = {}
    for block in record.children:
        skipped = {"Properties70": 4, "Properties60": 3}.get(block.name)
        if skipped is None:
            continue
        for row in block.children:
            numbers = tuple(value for value in row.values[skipped:] if isinstance(value, (int, float)))
            if numbers:
                found[row.text(0)] = numbers
    return found


def identity_of(record: Record) -> Identity:
    """What connections call an object: its number, or before version 7 its name."""
    first = record.values[0] if record.values else ""
    return first if isinstance(first, (int, str)) else ""


def name_of(record: Record) -> str:
    """The name of an object, without the word for its class."""
    texts = [value for value in record.values[:2] if isinstance(value, str)]
    return plain_name(texts[0]) if texts else ""


def plain_name(text: str) -> str:
    """A name as it is written, `name NUL SOH class` in binary files and `class::name` in texts, without its class."""
    name = text.split("\0\1")[0] if "\0\1" in text else text.partition("::")[2] or text
    return " ".join(name.replace("\0", " ").split())


def _connections(root: Record) -> dict[Identity, list[tuple[Identity, str]]]:
    sources: dict[Identity, list[tuple[Identity, str]]] = defaultdict(list)
    for connections in root.all("Connections"):
        for row in connections.children:
            if len(row.values) >= 3 and row.name in ("C", "Connect"):
                child, parent = row.values[1:3]
                if isinstance(child, (int, str)) and isinstance(parent, (int, str)):
                    sources[parent].append((child, row.text(3) if row.text(0) == "OP" else ""))
    return dict(sources)


def _ticks(root: Record) -> int:
    """Units of time in a second: a file may say by a 0 that it uses the units of later days."""
    header = root.find("FBXHeaderExtension")
    flags = header.find("OtherFlags") if header is not None else None
    definition = flags.number("TCDefinition", 127) if flags is not None else 127
    version = root.values[0] if root.values else header.number("FBXVersion", 0) if header is not None else 0
    return _SHORT_TICKS if version >= 8000 and definition != 127 else _TICKS


def _read_settings(scene: FbxScene, record: Record | None) -> None:
    settings = properties(record) if record is not None else {}
    mode = int(settings.get("TimeMode", (0,))[0]) if "TimeMode" in settings else None
    if mode == _CUSTOM:
        scene.fps = settings.get("CustomFrameRate", (24.0,))[0]
    elif mode is not None and 0 <= mode < len(_RATES):
        scene.fps = _RATES[mode]
    if scene.fps is not None and not 1 <= scene.fps <= 1000:
        scene.fps = None
    scene.unit = settings.get("UnitScaleFactor", (1.0,))[0]
    axis, sign = settings.get("UpAxis", (-1,))[0], settings.get("UpAxisSign", (1,))[0]
    if axis in (0, 1, 2):
        scene.up = ("" if sign > 0 else "-") + "xyz"[int(axis)]


def _read_models(scene: FbxScene, root: Record, objects: Record) -> None:
    """Models in the order of a walk from the scene's top; those that stand in a circle are left out."""
    defaults = _template(root)
    found = {}
    for record in objects.all("Model"):
        texts = [value for value in record.values if isinstance(value, str)]
        kind = texts[-1] if len(texts) > 1 else ""
        found[identity_of(record)] = Model(
            identity_of(record), name_of(record), kind, {**defaults, **properties(record)}
        )
    children: dict[Identity, list[Identity]] = defaultdict(list)
    owned = set()
    for parent, sources in scene.sources.items():
        for child, of_property in sources:
            if child in found and not of_property and parent in found and child != parent and child not in owned:
                children[parent].append(child)
                owned.add(child)
    waiting = [(identity, -1) for identity in reversed(found) if identity not in owned]
    while waiting:
        identity, parent = waiting.pop()
        scene.places[identity] = len(scene.models)
        model = found[identity]
        model.parent = parent
        scene.models.append(model)
        waiting += [(child, scene.places[identity]) for child in reversed(children[identity])]


def _template(root: Record) -> Properties:
    """The properties that a model has where it states no others."""
    definitions = root.find("Definitions")
    for kind in definitions.children if definitions is not None else ():
        template = kind.find("PropertyTemplate")
        if kind.name == "ObjectType" and kind.text(0) == "Model" and template is not None:
            return properties(template)
    return {}


def _read_binding(scene: FbxScene, objects: Record) -> None:
    """Where models were when they were bound: of a bind pose, else of the clusters of a skin."""
    for record in objects.all("Deformer"):
        link = record.numbers("TransformLink", "f8")
        for source, _ in scene.sources.get(identity_of(record), ()):
            if source in scene.places and "Cluster" in record.values:
                scene.skinned.add(scene.places[source])
                _bind(scene, source, link)
    for pose in objects.all("Pose"):
        if "BindPose" not in pose.values:
            continue
        for row in pose.all("PoseNode"):
            node = row.find("Node")
            if node is not None:
                _bind(scene, identity_of(node), row.numbers("Matrix", "f8"))


def _bind(scene: FbxScene, identity: Identity, matrix: NDArray[np.float64]) -> None:
    if identity in scene.places and matrix.size == 16 and np.isfinite(matrix).all() and np.abs(matrix).max() < 1e12:
        scene.bind[scene.places[identity]] = matrix.reshape(4, 4).T
