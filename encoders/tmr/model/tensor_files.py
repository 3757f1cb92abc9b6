"""Tensors out of files that torch and Lightning write, which somebody else may have crafted: nothing in them is run."""

from __future__ import annotations

import pickle
import re
import zipfile
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import torch

from encoders.errors import BundleError

#: Bytes of a file: those of a published model with its optimiser are 200 MB.
LARGEST = 8 << 30
#: The class that torch names where it refuses one.
_CLASS = re.compile(r"GLOBAL (\S+)|(?:global|class|type) [`']?([\w.]+)")


class _Inert:
    """What stands for an object of a class that is neither a tensor nor a plain value: it takes all and does nothing.

    Lightning keeps callbacks, paths and omegaconf's settings beside the weights. They are not needed.
    """

    def __new__(cls, *_: Any, **__: Any) -> _Inert:
        return super().__new__(cls)

    def __init__(self, *_: Any, **__: Any) -> None: ...

    def __setstate__(self, state: Any) -> None: ...


def _plain_dict(*_: Any) -> dict[Any, Any]:
    """What stands for a dictionary of another class, which is filled after it is made."""
    return {}


#: Full name of a class that is filled with items -> what stands for it.
_FILLED = {"collections.defaultdict": _plain_dict}


def read_tensors(path: Path) -> Any:
    """What a torch file holds: tensors and plain values, nothing else.

    Raises
    ------
    BundleError
        If it cannot be read, or holds objects of any class.
    """
    return _load(path, ())


def module_tensors(checkpoint: Path) -> dict[str, dict[str, torch.Tensor]]:
    """Module -> name -> tensor of a Lightning checkpoint; whatever else is in it is passed over, never made.

    Raises
    ------
    BundleError
        If it cannot be read or holds no state of a model.
    """
    _check(checkpoint)
    try:
        # The format before torch 1.6 cannot be looked into; there other objects are refused.
        is_zip = zipfile.is_zipfile(checkpoint)
        names = torch.serialization.get_unsafe_globals_in_checkpoint(checkpoint) if is_zip else []
    except (OSError, RuntimeError, ValueError, pickle.UnpicklingError) as error:
        raise BundleError(f"{checkpoint}: no checkpoint that can be read ({error})") from error
    values = _load(checkpoint, names)
    state = values.get("state_dict") if isinstance(values, dict) else None
    if not isinstance(state, dict) or not state:
        raise BundleError(f"{checkpoint}: has no state_dict, so it is no checkpoint of Lightning")
    modules: dict[str, dict[str, torch.Tensor]] = {}
    for key, value in state.items():
        module, _, name = str(key).partition(".")
        if not isinstance(value, torch.Tensor):
            raise BundleError(f"{checkpoint}: {key} is no tensor")
        modules.setdefault(module, {})[name] = value
    return modules


def checkpoint_of(run: Path) -> Path | None:
    """The last checkpoint of a run: last.ckpt, else that of the highest epoch; None where there is none."""
    folder = run / "logs" / "checkpoints"
    if (folder / "last.ckpt").is_file():
        return folder / "last.ckpt"
    found = [(int(epoch[1]), path) for path in folder.glob("*.ckpt") if (epoch := re.search(r"epoch=(\d+)", path.stem))]
    return max(found)[1] if found else None


def _load(path: Path, inert: Sequence[str]) -> Any:
    _check(path)
    try:
        with torch.serialization.safe_globals([(_FILLED.get(name, _Inert), name) for name in inert]):
            return torch.load(path, map_location="cpu", weights_only=True)
    except pickle.UnpicklingError as error:
        named = _CLASS.search(str(error))
        if named is None:
            raise BundleError(f"{path}: no tensors that can be read") from error
        what = ", ".join(inert) or named[1] or named[2]
        raise BundleError(f"{path}: holds objects of {what}, not only tensors and plain values; refused") from error
    except Exception as error:  # torch raises what a damaged file leads it to
        raise BundleError(f"{path}: no tensors that can be read ({str(error)[:300]})") from error


def _check(path: Path) -> None:
    """Refuse what is not there, too large, or packed so that it grows."""
    try:
        if path.stat().st_size > LARGEST:
            raise BundleError(f"{path}: larger than {LARGEST >> 30} GB")
        if not zipfile.is_zipfile(path):
            return
        with zipfile.ZipFile(path) as archive:
            if any(member.compress_type != zipfile.ZIP_STORED for member in archive.infolist()):
                raise BundleError(f"{path}: is compressed, which torch never writes")
    except (OSError, zipfile.BadZipFile, NotImplementedError) as error:
        raise BundleError(f"{path}: cannot be read ({error})") from error
