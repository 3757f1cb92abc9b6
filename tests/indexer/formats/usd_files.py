"""USD scenes of a small movement, as text."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np
from scipy.spatial.transform import Rotation

from tests.indexer.performances import Performance


def usda(
    acted: Performance,
    *,
    up: str = "Y",
    codes: float = 24.0,
    first: float = 1.0,
    header: str = "",
    root: str = "",
    joints: str = "all",
    bound: bool = True,
    animations: Iterable[str] = ("Walk",),
    rest_frame: int | None = None,
) -> str:
    """A performance as a stage with a SkelRoot, a Skeleton and animations of it.

    Parameters
    ----------
    codes : float
        Time codes a second.
    first : float
        Time code of the first frame.
    header, root : str
        Further metadata of the stage, and attributes of the SkelRoot.
    joints : str
        "all" are animated, or only "turning" ones, those with a joint below, in another order.
    bound : bool
        Whether the skeleton names the first of the animations.
    rest_frame : int, optional
        The frame that is the rest pose, instead of the bind pose.
    """
    paths = paths_of(acted)
    bind = np.repeat(np.eye(4)[None], len(paths), axis=0)
    local = bind.copy()
    for joint, parent in enumerate(acted.parents):
        local[joint, :3, 3] = acted.offsets[joint]
        bind[joint] = (bind[parent] if parent >= 0 else np.eye(4)) @ local[joint]
    if rest_frame is not None:
        local[:, :3, :3] = acted.rotations[rest_frame]
    chosen = list(range(len(paths)))
    if joints == "turning":
        chosen = sorted((set(acted.parents) - {-1}), reverse=True)
    source = f"rel skel:animationSource = </Root/{next(iter(animations))}>" if bound else ""
    return f"""#usda 1.0
(
    upAxis = "{up}"
    timeCodesPerSecond = {codes}
    {header}
)
def SkelRoot "Root" {{
    {root}
    def Skeleton "Skeleton" (prepend apiSchemas = ["SkelBindingAPI"]) {{
        uniform token[] joints = {_texts(paths)}
        uniform matrix4d[] bindTransforms = {_matrices(bind)}
        uniform matrix4d[] restTransforms = {_matrices(local)}
        {source}
    }}
{"".join(_animation(acted, name, chosen, paths, codes, first) for name in animations)}}}
"""


def paths_of(acted: Performance) -> list[str]:
    """Joints as UsdSkel names them, in words that USD takes."""
    paths: list[str] = []
    for joint, name in enumerate(acted.names):
        word = name.replace(":", "_").replace(" ", "_")
        paths.append(f"{paths[acted.parents[joint]]}/{word}" if acted.parents[joint] >= 0 else word)
    return paths


def _animation(acted: Performance, name: str, chosen: list[int], paths: list[str], codes: float, first: float) -> str:
    times = first + np.arange(len(acted.root)) * codes / acted.fps
    turns = [Rotation.from_matrix(matrices[chosen]).as_quat()[:, [3, 0, 1, 2]] for matrices in acted.rotations]
    moves = [np.where(np.arange(len(paths))[:, None] == 0, root, acted.offsets)[chosen] for root in acted.root]
    return f"""    def SkelAnimation "{name}" {{
        uniform token[] joints = {_texts(paths[i] for i in chosen)}
        float3[] translations.timeSamples = {_samples(times, moves)}
        quatf[] rotations.timeSamples = {_samples(times, turns)}
        half3[] scales = [{", ".join(["(1, 1, 1)"] * len(chosen))}]
    }}
"""


def _texts(words: Iterable[str]) -> str:
    return "[" + ", ".join(f'"{word}"' for word in words) + "]"


def _tuple(values: Any) -> str:
    return "(" + ", ".join(f"{value:.5g}" for value in values) + ")"


def _samples(times: np.ndarray, rows: Iterable[np.ndarray]) -> str:
    pairs = zip(times, rows, strict=True)
    return "{" + ", ".join(f"{time:.6g}: [{', '.join(map(_tuple, row))}]" for time, row in pairs) + "}"


def _matrices(matrices: np.ndarray) -> str:
    """For row vectors, as USD has them."""
    return "[" + ", ".join("(" + ", ".join(_tuple(row) for row in matrix.T) + ")" for matrix in matrices) + "]"


if __name__ == "__main__":  # makes the small file of the tests
    from pathlib import Path

    from tests.indexer.performances import performance

    text = usda(performance("bandai", frames=13, fps=12), codes=12)
    (Path(__file__).resolve().parents[2] / "data" / "walk.usda").write_text(text)
