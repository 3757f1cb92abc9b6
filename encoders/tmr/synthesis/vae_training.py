"""Training the generator: reconstruction, and the Gaussians of sentences drawn to those of their motions."""

from __future__ import annotations

import math
import os
import pickle
import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
import torch
import torch.nn.functional as F
from numpy.typing import NDArray
from torch import Tensor

from encoders.errors import MotionSeekError
from encoders.tmr.model.network import Gaussian
from encoders.tmr.model.normaliser import Normaliser
from encoders.tmr.model.padding import pad
from encoders.tmr.synthesis.captioned_motions import CaptionedMotions, batches_of
from encoders.tmr.synthesis.motion_vae import MotionVAE, VAEConfig
from encoders.tmr.training.losses import kl

_FILE = "generator.pt"
#: Motions of a label that its Gaussian is estimated from.
_MOST = 256


@dataclass(frozen=True)
class VAERecipe:
    """What decides a run: AdamW with a linear warm-up and a cosine, over `steps` batches.

    `divergence` weighs KL(motion || text), which makes a sentence's Gaussian as wide as what the sentence leaves open,
    and a tenth of it KL(motion || N(0, 1)). TEMOS has two more such terms at 1e-5 and decodes the sentences' samples in
    training, too, which makes motions the mean of what a sentence may mean. `change` weighs the error of the change
    from frame to frame. Losses are printed and weights saved every `reported` steps; `sizes` are fields of `VAEConfig`
    that differ from its defaults.
    """

    steps: int = 6000
    batch: int = 64
    rate: float = 6e-4
    warmup: int = 100
    divergence: float = 1e-3
    change: float = 1.0
    seed: int = 0
    reported: int = 100
    sizes: Mapping[str, int] = field(default_factory=dict)


def train_vae(
    folder: Path,
    data: CaptionedMotions,
    normaliser: Normaliser,
    recipe: VAERecipe,
    *,
    minutes: float = math.inf,
    say: Callable[[str], None] = print,
) -> tuple[MotionVAE, int]:
    """Train a generator in a folder, or go on with the one there; stops after `minutes`, with a small learning rate.

    Returns
    -------
    model : MotionVAE
    steps : int
        Of all its training.
    """
    torch.manual_seed(recipe.seed)
    rng = np.random.default_rng(recipe.seed)
    model = MotionVAE(VAEConfig(features=data.motions[0].shape[1], sentence=data.vectors.shape[1], **recipe.sizes))
    optimiser = torch.optim.AdamW(model.parameters(), lr=recipe.rate, weight_decay=0.01, betas=(0.9, 0.98))
    first = step = _restore(folder, model, optimiser)
    lengths = [len(motion) for motion in data.motions]
    started, seen = time.monotonic(), []
    while True:
        for rows in batches_of(lengths, recipe.batch, rng):
            progress = max(step / recipe.steps, (time.monotonic() - started) / (60 * minutes))
            if progress >= 1:
                _save(folder, model, optimiser, step)
                return model.eval().requires_grad_(False), step
            for group in optimiser.param_groups:
                group["lr"] = recipe.rate * _share(step - first, progress, recipe)
            terms = vae_losses(model, *_batch(data, normaliser, rows, rng), recipe)
            optimiser.zero_grad()
            torch.stack(list(terms.values())).sum().backward()
            torch.nn.utils.clip_grad_norm_(model.parameters(), 1.0)
            optimiser.step()
            seen.append([term.item() for term in terms.values()])
            step += 1
            if step % recipe.reported == 0:
                means = zip(terms, np.mean(seen, axis=0), strict=True)
                say(f"step {step}  " + "  ".join(f"{name} {value:.4f}" for name, value in means))
                _save(folder, model, optimiser, step)
                seen.clear()


def _share(step: int, progress: float, recipe: VAERecipe) -> float:
    """Of the learning rate: a linear warm-up, then a cosine down to a fiftieth."""
    return min((step + 1) / recipe.warmup, 0.02 + 0.49 * (1 + math.cos(math.pi * progress)))


def _save(folder: Path, model: MotionVAE, optimiser: torch.optim.Optimizer, step: int) -> None:
    partial = folder / "generator.partial"
    torch.save({"step": step, "model": model.state_dict(), "optimiser": optimiser.state_dict()}, partial)
    os.replace(partial, folder / _FILE)


def _restore(folder: Path, model: MotionVAE, optimiser: torch.optim.Optimizer) -> int:
    """Load what is in the folder; the steps it was trained for, 0 where nothing is there."""
    path = folder / _FILE
    if not path.exists():
        return 0
    try:
        saved = torch.load(path, map_location="cpu", weights_only=True)
        model.load_state_dict(saved["model"])
        optimiser.load_state_dict(saved["optimiser"])
        return int(saved["step"])
    except (OSError, RuntimeError, KeyError, TypeError, ValueError, pickle.UnpicklingError) as error:
        raise MotionSeekError(f"{path}: no generator of this model that can be trained on ({error})") from error


def vae_losses(
    model: MotionVAE, motions: Tensor, mask: Tensor, vectors: Tensor, recipe: VAERecipe
) -> dict[str, Tensor]:
    """The weighted terms of a batch: motions (B, T, F) standardised, mask (B, T), sentence vectors (B, D)."""
    motion = model.motion_encoder(motions, mask)
    text = model.text_gaussian(vectors)
    decoded = model.motion_decoder(motion.sample(), mask)
    standard = Gaussian(torch.zeros_like(motion.mu), torch.zeros_like(motion.logvar))
    both = (mask[:, 1:] & mask[:, :-1])[..., None]
    return {
        "reconstruction": _over_frames(F.smooth_l1_loss(decoded, motions, reduction="none"), mask[..., None]),
        "change": recipe.change
        * _over_frames(F.smooth_l1_loss(decoded.diff(dim=1), motions.diff(dim=1), reduction="none"), both),
        "text": recipe.divergence * kl(motion, text),
        "prior": 0.1 * recipe.divergence * kl(motion, standard),
    }


def _over_frames(errors: Tensor, mask: Tensor) -> Tensor:
    """Mean of errors (B, T, F) over the frames that count."""
    return (errors * mask).sum() / (mask.sum() * errors.shape[-1]).clamp(min=1)


def _batch(
    data: CaptionedMotions, normaliser: Normaliser, rows: NDArray[np.int64], rng: np.random.Generator
) -> tuple[Tensor, Tensor, Tensor]:
    """Motions, mask, and the vector of one caption of each, drawn at random."""
    motions, mask = pad([(data.motions[i].astype(np.float32) - normaliser.mean) / normaliser.std for i in rows])
    texts = [rng.choice(data.captions[i]) for i in rows]
    return motions, mask, torch.from_numpy(data.vectors[texts].astype(np.float32))


def label_gaussians(
    model: MotionVAE, data: CaptionedMotions, normaliser: Normaliser, least: int = 5
) -> tuple[list[str], NDArray[np.float32], NDArray[np.float32]]:
    """The Gaussian of each label with at least `least` motions: that of all their latents together.

    ACTOR learns a mean and a variance of each label; here they are those of the mixture of the motions' own Gaussians.

    Returns
    -------
    names : L strings, sorted
    mu, logvar : float32 arrays (L, latent)
    """
    members: dict[str, list[int]] = {}
    for place, label in enumerate(data.labels):
        if label:
            members.setdefault(label, []).append(place)
    names = sorted(name for name, rows in members.items() if len(rows) >= least)
    mu, logvar = (np.zeros((len(names), model.config.latent), np.float32) for _ in range(2))
    for i, name in enumerate(names):
        rows = members[name][:_MOST]
        motions, mask = pad([(data.motions[row].astype(np.float32) - normaliser.mean) / normaliser.std for row in rows])
        with torch.inference_mode():
            each = model.motion_encoder(motions, mask)
        mu[i] = each.mu.mean(0).numpy()
        logvar[i] = (each.mu.var(0, unbiased=False) + each.logvar.exp().mean(0)).log().numpy()
    return names, mu, logvar
