"""Read a run directory as the published TMR code writes it.

    config.json
    last_weights/{motion_encoder,text_encoder,motion_decoder}.pt

Normaliser statistics lie outside a run, as mean.pt and std.pt in a folder of their own.
"""

from __future__ import annotations

import json
import pickle
from pathlib import Path
from typing import Any

import numpy as np
import torch
from numpy.typing import NDArray

from encoders.errors import BundleError
from encoders.tmr.model.network import TMR, TMRConfig, TransformerConfig
from encoders.tmr.training.losses import LossWeights

MODULES = ("motion_encoder", "text_encoder", "motion_decoder")


def read_config(run: Path) -> TMRConfig:
    """The sizes that a run's config.json states; raises BundleError where it is no such file."""
    model = _read_model(run)
    try:
        motion, text, decoder = (_transformer_config(model[name]) for name in MODULES)
        return TMRConfig(motion=motion, text=text, decoder=decoder, latent=model["motion_encoder"]["latent_dim"])
    except (KeyError, TypeError, ValueError) as error:
        raise BundleError(f"{run / 'config.json'}: not the configuration of a TMR run ({error})") from error


def read_weights(run: Path) -> tuple[LossWeights, float, float]:
    """What a run's config.json says of the objective: weights of the terms, temperature, threshold of the filter."""
    model = _read_model(run)
    try:
        lmd = model["lmd"]
        weights = LossWeights(
            reconstruction=lmd["recons"], kl=lmd["kl"], latent=lmd["latent"], contrastive=lmd["contrastive"]
        )
        return weights, model["temperature"], model["threshold_selfsim"]
    except (KeyError, TypeError) as error:
        raise BundleError(f"{run / 'config.json'}: not the configuration of a TMR run ({error})") from error


def load_run(run: Path) -> TMR:
    """The networks of a run, ready for inference.

    Raises
    ------
    BundleError
        If a file is missing, holds anything but plain tensors, or does not fit the configuration.
    """
    network = TMR(read_config(run))
    for name in MODULES:
        path = run / "last_weights" / f"{name}.pt"
        try:
            getattr(network, name).load_state_dict(_read_tensors(path))
        except (RuntimeError, TypeError) as error:
            raise BundleError(f"{path}: does not fit the run's configuration ({error})") from error
    return network.eval().requires_grad_(False)


def load_stats(folder: Path) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
    """Mean and standard deviation of the features, (F,) each, from mean.pt and std.pt."""
    mean, std = (_read_tensors(folder / f"{name}.pt").numpy() for name in ("mean", "std"))
    return mean, std


def _read_model(run: Path) -> dict[str, Any]:
    path = run / "config.json"
    try:
        return dict(json.loads(path.read_text("utf-8"))["model"])
    except (OSError, ValueError, KeyError, TypeError) as error:
        raise BundleError(f"{path}: not the configuration of a TMR run ({error!r})") from error


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


def _read_tensors(path: Path) -> Any:
    try:
        return torch.load(path, map_location="cpu", weights_only=True)
    except (OSError, RuntimeError, pickle.UnpicklingError, EOFError) as error:
        raise BundleError(f"{path}: no tensors that can be read ({error})") from error
