"""Read a run directory as the published TMR code writes it.

    config.json
    last_weights/{motion_encoder,text_encoder,motion_decoder}.pt
    logs/checkpoints/{last,latest-epoch=N}.ckpt      where there are no weights by module

Statistics of the features lie outside a run, as mean.pt and std.pt in a folder of their own.
"""

from __future__ import annotations

import json
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import torch
from numpy.typing import NDArray

from encoders.errors import BundleError
from encoders.tmr.model.network import TMR, TMRConfig, TransformerConfig
from encoders.tmr.model.tensor_files import checkpoint_of, module_tensors, read_tensors
from encoders.tmr.training.losses import LossWeights

MODULES = ("motion_encoder", "text_encoder", "motion_decoder")
_ENCODERS = MODULES[:2]
Array = NDArray[np.float32]


@dataclass(frozen=True)
class PublishedData:
    """What a run was trained on, as its config.json states it.

    Attributes
    ----------
    features : str
        Folder of the motions' features, of which the last part is their kind: "guoh3dfeats".
    size : int
        Numbers a frame.
    fps : float
        Feature frames a second.
    statistics : str
        Folder of mean and standard deviation, relative to the folder in which the run was started.
    epsilon : float
        What is added to the standard deviation.
    language_model : str
        Name of the model whose token features the text encoder reads.
    """

    features: str
    size: int
    fps: float
    statistics: str
    epsilon: float
    language_model: str


def read_config(run: Path) -> TMRConfig:
    """The sizes that a run's config.json states; raises BundleError where it is no such file."""
    model = _read_part(run, "model")
    try:
        motion, text = (_transformer_config(model[name]) for name in _ENCODERS)
        decoder = None if model.get("motion_decoder") is None else _transformer_config(model["motion_decoder"])
        widths = {name: one.width for name, one in zip(MODULES, (motion, text, decoder), strict=True) if one}
        if len(set(widths.values())) > 1:
            raise ValueError(f"latent_dim differs: {widths}")
        return TMRConfig(motion=motion, text=text, decoder=decoder, latent=motion.width)
    except (AttributeError, KeyError, TypeError, ValueError) as error:
        raise _no_config(run, error) from error


def read_data(run: Path) -> PublishedData:
    """What a run's config.json says of its data; raises BundleError where it says nothing of it."""
    data = _read_part(run, "data")
    try:
        motions = data["motion_loader"]
        return PublishedData(
            features=str(motions["base_dir"]),
            size=int(motions["nfeats"]),
            fps=float(motions["fps"]),
            statistics=str(motions["normalizer"]["base_dir"]),
            epsilon=float(motions["normalizer"].get("eps", 1e-12)),
            language_model=str(data["text_to_token_emb"]["modelname"]),
        )
    except (AttributeError, KeyError, TypeError, ValueError) as error:
        raise _no_config(run, error) from error


def read_weights(run: Path) -> tuple[LossWeights, float, float]:
    """What a run's config.json says of the objective: weights of the terms, temperature, threshold of the filter."""
    model = _read_part(run, "model")
    try:
        lmd = model["lmd"]
        weights = LossWeights(
            reconstruction=lmd["recons"], kl=lmd["kl"], latent=lmd["latent"], contrastive=lmd["contrastive"]
        )
        return weights, model["temperature"], model["threshold_selfsim"]
    except (KeyError, TypeError) as error:
        raise _no_config(run, error) from error


def load_run(run: Path) -> TMR:
    """The networks of a run, ready for inference; its decoder is None where the weights have none.

    Raises
    ------
    BundleError
        If a file is missing, holds anything but plain tensors, does not fit the configuration, or has numbers that are
        not finite.
    """
    network = TMR(read_config(run))
    tensors = _read_modules(run)
    for name in MODULES:
        module = getattr(network, name)
        if name not in tensors or module is None:
            network.motion_decoder = None
            continue
        place, values = tensors[name]
        try:
            module.load_state_dict(values)
        except (RuntimeError, TypeError) as error:
            raise BundleError(f"{place}: does not fit the run's configuration ({_first_line(error)})") from error
        for parameter, value in module.state_dict().items():
            if not torch.isfinite(value).all():
                raise BundleError(f"{place}: {name}.{parameter} has numbers that are not finite; the run has diverged")
    return network.eval().requires_grad_(False)


def load_stats(folder: Path, size: int | None = None) -> tuple[Array, Array]:
    """Mean and standard deviation of the features, (F,) each, from mean.pt and std.pt or mean.npy and std.npy.

    Raises
    ------
    BundleError
        If they are not there, have other sizes than `size`, or numbers that are none of a mean or deviation.
    """
    mean, std = (_statistic(folder, name) for name in ("mean", "std"))
    for name, values in (("mean", mean), ("std", std)):
        if values.ndim != 1 or values.shape != mean.shape or (size is not None and len(values) != size):
            wanted = "one number a feature" if size is None else f"{size} numbers, one a feature"
            raise BundleError(f"{folder}: {name} has the shape {values.shape}, not {wanted}; is it of other features?")
        if not np.isfinite(values).all():
            raise BundleError(f"{folder}: {name} has numbers that are not finite")
    if (std <= 0).any():
        raise BundleError(f"{folder}: std is not positive for feature {int(np.argmax(std <= 0))}")
    return mean, std


def _statistic(folder: Path, name: str) -> Array:
    for path in (folder / f"{name}.pt", folder / f"{name}.npy", folder / f"{name.capitalize()}.npy"):
        if not path.is_file():
            continue
        if path.suffix == ".pt":
            values = read_tensors(path)
            if not isinstance(values, torch.Tensor):
                raise BundleError(f"{path}: holds {type(values).__name__}, not a tensor")
            return values.float().numpy()
        try:
            return np.asarray(np.load(path, allow_pickle=False), np.float32)
        except (OSError, ValueError, EOFError) as error:
            raise BundleError(f"{path}: no array that can be read ({error})") from error
    raise BundleError(f"{folder}: no {name}.pt here, nor {name}.npy")


def _read_modules(run: Path) -> dict[str, tuple[Path, dict[str, Any]]]:
    """Module -> its file and its tensors, from the weights by module, else from a checkpoint."""
    files = {name: run / "last_weights" / f"{name}.pt" for name in MODULES}
    missing = [files[name] for name in _ENCODERS if not files[name].is_file()]
    if not missing:
        return {name: (path, read_tensors(path)) for name, path in files.items() if path.is_file()}
    checkpoint = checkpoint_of(run)
    if checkpoint is None:
        raise BundleError(f"{missing[0]}: missing, and there is no checkpoint in {run / 'logs' / 'checkpoints'}")
    tensors = module_tensors(checkpoint)
    for name in _ENCODERS:
        if name not in tensors:
            raise BundleError(f"{checkpoint}: holds no {name}, so it is no checkpoint of TMR")
    return {name: (checkpoint, tensors[name]) for name in MODULES if name in tensors}


def _read_part(run: Path, part: str) -> dict[str, Any]:
    path = run / "config.json"
    try:
        return dict(json.loads(path.read_text("utf-8"))[part])
    except FileNotFoundError as error:
        raise BundleError(f"{path}: missing; a published run has it beside its weights") from error
    except (OSError, ValueError, KeyError, TypeError) as error:
        raise _no_config(run, error) from error


def _no_config(run: Path, error: Exception) -> BundleError:
    what = f"{error} is missing" if isinstance(error, KeyError) else error
    return BundleError(f"{run / 'config.json'}: not the configuration of a TMR run ({what})")


def _transformer_config(values: dict[str, Any]) -> TransformerConfig:
    if values.get("activation", "gelu") != "gelu" or not values.get("vae", True):
        raise ValueError("only gelu and vae networks are supported")
    return TransformerConfig(
        features=values["nfeats"],
        width=values["latent_dim"],
        layers=values["num_layers"],
        heads=values["num_heads"],
        feedforward=values["ff_size"],
        dropout=values["dropout"],
    )


def _first_line(error: Exception) -> str:
    return "; ".join(list(_lines(error))[1:3]) or str(error)


def _lines(error: Exception) -> Iterator[str]:
    return (line.strip() for line in str(error).splitlines() if line.strip())
