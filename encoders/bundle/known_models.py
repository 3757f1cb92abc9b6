"""Models by name: the shipped one, the bundles in the user's folder of models, and those of other distributions.

The folder is MOTIONSEEK_MODELS where that is set, else `motionseek/models` where the system keeps a user's data.
"""

from __future__ import annotations

import difflib
import os
import re
from collections.abc import Iterator
from dataclasses import dataclass
from os import PathLike
from pathlib import Path

from encoders import extensions
from encoders.arguments import is_text, shown
from encoders.bundle import bundle as bundles
from encoders.bundle.bundle import Bundle
from encoders.bundle.manifest import MANIFEST, Manifest, stated_manifest
from encoders.errors import ArgumentError, BundleError
from encoders.protocol import Encoder

VARIABLE = "MOTIONSEEK_MODELS"
#: The shipped model under any version of it.
SHIPPED = "default"
_NAME = re.compile(r"\w[\w.+-]{0,63}")


@dataclass(frozen=True)
class KnownModel:
    """A model that can be named.

    Attributes
    ----------
    name : str
        What `load_model` takes.
    place : str
        The folder of a bundle, or the distribution that adds the model.
    manifest : Manifest or None
        What a bundle states of itself; None for the model of another distribution, which is not loaded to list it.
    problem : str
        Why a bundle cannot be used; empty if it can.
    """

    name: str
    place: str
    manifest: Manifest | None = None
    problem: str = ""


def models_folder() -> Path:
    """Where bundles are kept under their names; it may not exist yet."""
    named = os.environ.get(VARIABLE)
    if named:
        return Path(named)
    from platformdirs import user_data_path

    return user_data_path("motionseek", appauthor=False) / "models"


def folder_of(name: str) -> Path:
    """The folder that a bundle of this name has or would have.

    Raises
    ------
    ArgumentError
        If it is no plain name, or that of a model that is there already and no bundle of the user's.
    """
    if not isinstance(name, str) or not is_text(name) or not _NAME.fullmatch(name):
        raise ArgumentError(f"name={shown(name)} must be of letters, digits and . + - _, at most 64, such as tmr-kitml")
    if name == SHIPPED or name in dict(extensions.owners(extensions.MODELS)):
        raise ArgumentError(f"name={name!r} is that of a model that is there already; choose another")
    return models_folder() / name


def known_models() -> list[KnownModel]:
    """Every model that can be named: the shipped one, the user's in order of their names, those of distributions."""
    return [
        *_bundles(),
        *(KnownModel(name, owner) for name, owner in extensions.owners(extensions.MODELS)),
    ]


def load_model(name: str | PathLike[str] | None = None) -> Encoder:
    """A model by its name, or the bundle in a folder; None for the shipped one.

    Raises
    ------
    BundleError
        If there is no such model, or it is damaged.
    """
    if name is None or name == SHIPPED:
        return Bundle.load()
    if isinstance(name, str) and _NAME.fullmatch(name):
        folder = models_folder() / name
        if (folder / MANIFEST).is_file():
            return Bundle.load(folder)
        model = extensions.load_extension(extensions.MODELS, name)
        if model is not None:
            return _made(name, model)
    if not isinstance(name, str) or (Path(name) / MANIFEST).is_file() or Path(name).name != name:
        return Bundle.load(Path(name))
    known = [model.name for model in known_models()]
    close = difflib.get_close_matches(name, known, n=1)
    hint = f"did you mean {close[0]!r}?" if close else f"there are {', '.join(known)}"
    raise BundleError(f"no model {name!r} in {models_folder()}; {hint} ('motionseek model import' adds one)")


def model_with(fingerprint: str, name: str) -> Encoder | None:
    """The model of a fingerprint, whatever it is called here; None where it is not there.

    Parameters
    ----------
    name : str
        What the model called itself, by which those of other distributions are found.

    Raises
    ------
    BundleError
        If it is damaged.
    """
    for known in _bundles():
        if known.manifest is not None and known.manifest.fingerprint == fingerprint:
            return Bundle.load(known.place)
    maker = extensions.load_extension(extensions.MODELS, name)
    model = None if maker is None else _made(name, maker)
    return model if model is not None and model.fingerprint == fingerprint else None


def _bundles() -> Iterator[KnownModel]:
    """The shipped one, then the user's in order of their names."""
    yield KnownModel(SHIPPED, str(bundles.DEFAULT), stated_manifest(bundles.DEFAULT))
    try:
        folders = sorted(
            path for path in models_folder().iterdir() if _NAME.fullmatch(path.name) and (path / MANIFEST).is_file()
        )
    except (FileNotFoundError, NotADirectoryError):
        return
    for folder in folders:
        try:
            yield KnownModel(folder.name, str(folder), stated_manifest(folder))
        except BundleError as error:
            yield KnownModel(folder.name, str(folder), problem=str(error))


def _made(name: str, model: object) -> Encoder:
    """What the class or function that an entry point names makes."""
    if not callable(model):
        raise BundleError(f"{extensions.MODELS} {name!r} names {type(model).__name__}, not what makes an Encoder")
    try:
        made = model()
    except Exception as error:  # whatever the other distribution raises
        raise BundleError(f"{extensions.MODELS} {name!r} cannot be made ({error!r})") from error
    if not isinstance(made, Encoder):
        raise BundleError(f"{extensions.MODELS} {name!r} makes {type(made).__name__}, which is no Encoder")
    return made
