"""A licensed body model, where the user has one: the joints at rest of the person whose shape a file states.

The environment variable `MOTIONSEEK_BODY_MODELS` names a folder with the models as `.npz`, called as they are
published: `SMPLH_MALE.npz`, or `smplh/male/model.npz`.
"""

from __future__ import annotations

import os
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from encoders.errors import UnreadableMotion
from encoders.skeleton import JOINTS
from indexer.formats.numpy_files.npz_archive import NpzArchive, opened
from indexer.formats.opening import read_bytes

FOLDER = "MOTIONSEEK_BODY_MODELS"
_MODELS = ("smplh", "smplx", "smpl")
#: Numbers of rotations in a frame of the models that are told by it.
_OF_WIDTH = {72: "smpl", 156: "smplh", 165: "smplx"}
_MAX_BYTES = 1 << 30


def rest_joints(archive: NpzArchive) -> NDArray[np.float64] | None:
    """The 22 joints at rest (22, 3) of the `betas` in an archive of parameters, metres.

    They are regressed from the template's vertices after these are moved by the shape, as in SMPL (Loper et al.,
    SIGGRAPH Asia 2015). None where no folder of models is named, it has no model of that kind, or the file no shape.

    Raises
    ------
    UnreadableMotion
        If the shape or the model is damaged.
    """
    folder = os.environ.get(FOLDER)
    if not folder or "betas" not in archive.names:
        return None
    model = _model(Path(folder), _kinds(archive), _gender(archive))
    if model is None:
        return None
    betas = np.atleast_1d(archive.array("betas").astype(np.float64))
    betas = betas.reshape(-1, max(betas.shape[-1], 1))[0] if betas.size else betas.reshape(-1)
    with opened(model, read_bytes(model, max_bytes=_MAX_BYTES)) as arrays:
        missing = {"v_template", "shapedirs", "J_regressor"} - arrays.names
        if missing:
            raise UnreadableMotion(model, f"this is no body model: it has no {', '.join(sorted(missing))}")
        template, directions, regressor = (arrays.array(name) for name in ("v_template", "shapedirs", "J_regressor"))
    regressor = regressor[: len(JOINTS)]
    fits = template.ndim == 2 and directions.ndim == 3 and directions.shape[:2] == template.shape
    if not fits or template.shape[1] != 3 or regressor.shape != (len(JOINTS), len(template)):
        raise UnreadableMotion(model, "this is no body model: its arrays do not match")
    count = min(len(betas), directions.shape[2])
    joints: NDArray[np.float64] = regressor.astype(np.float64) @ (template + directions[..., :count] @ betas[:count])
    return joints


def _kinds(archive: NpzArchive) -> tuple[str, ...]:
    """The models that parameters may be of."""
    if "surface_model_type" in archive.names:
        return (archive.word("surface_model_type").lower(),)
    shape = archive.shapes().get("poses")
    return (_OF_WIDTH[shape[1]],) if shape and len(shape) == 2 and shape[1] in _OF_WIDTH else _MODELS


def _gender(archive: NpzArchive) -> str:
    try:
        return archive.word("gender").lower() if "gender" in archive.names else "neutral"
    except UnreadableMotion:  # some files state it as bytes or as an object
        return "neutral"


def _model(folder: Path, kinds: tuple[str, ...], gender: str) -> Path | None:
    """The file of a model, of the gender if there is one, else the neutral."""
    for kind in kinds:
        if kind not in _MODELS:
            continue
        for who in (gender if gender in ("male", "female") else "neutral", "neutral"):
            name = f"{kind}_{who}".upper()
            places = (folder / f"{name}.npz", folder / kind / who / "model.npz")
            if found := next((path for path in places if path.is_file()), None):
                return found
    return None
