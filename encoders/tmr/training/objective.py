"""TMR's objective on one batch: every term of it, as a recipe wants it."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor

from encoders.tmr.model.network import TMR, Gaussian, TransformerEncoder
from encoders.tmr.model.padding import pad
from encoders.tmr.training import losses
from encoders.tmr.training.batches import Batch
from encoders.tmr.training.recipe import Recipe


def step_losses(model: TMR, log_temperature: Tensor, batch: Batch, recipe: Recipe) -> dict[str, Tensor]:
    """Every term of TMR's objective on one batch, named as the fields of `losses.LossWeights`."""
    count = len(batch.motions)
    motion = encode(model.motion_encoder, batch.motions)
    texts = encode(model.text_encoder, batch.texts)
    text = Gaussian(texts.mu[:count], texts.logvar[:count])
    sampled_text, sampled_motion = text.sample(), motion.sample()
    terms = {}
    if recipe.contrast != "none":
        sides = (
            (torch.cat((sampled_text, texts.mu[count:])), sampled_motion) if recipe.sampled else (texts.mu, motion.mu)
        )
        terms["contrastive"] = contrast(*sides, log_temperature.exp(), batch, recipe)
        if model.text_encoder.sentence_head is not None:
            head = model.text_encoder.sentence_head(*pad(batch.texts))
            terms["sentence_head"] = contrast(head, sides[1], log_temperature.exp(), batch, recipe)
    if model.motion_decoder is not None:
        every = max(1, count // recipe.decoded)
        target, mask = pad(batch.motions[::every])
        decoded = [model.motion_decoder(z[::every], mask) for z in (sampled_text, sampled_motion)]
        terms["reconstruction"] = losses.reconstruction(target, *decoded)
        terms["kl"] = losses.kl_terms(text, motion)
        terms["latent"] = losses.latent_loss(sampled_text, sampled_motion)
    return terms


def published_terms(
    model: TMR,
    motions: tuple[Tensor, Tensor],
    tokens: tuple[Tensor, Tensor],
    *,
    temperature: float,
    ignore: Tensor | None,
    noise: tuple[Tensor, Tensor] | None = None,
) -> dict[str, Tensor]:
    """Every term of TMR's objective as published: on sampled latents, reconstructing every motion from both.

    Parameters
    ----------
    motions, tokens : padded features (B, L, F) and mask (B, L)
        Of motions, standardised, and of their captions.
    ignore : boolean (B, B), text by motion
        False negatives.
    noise : two tensors (B, latent), optional
        Standard normal, for text and motion; drawn where not given, first that of text.
    """
    target, mask = motions
    text, motion = model.text_encoder(*tokens), model.motion_encoder(target, mask)
    drawn = (None, None) if noise is None else noise
    latents = text.sample(drawn[0]), motion.sample(drawn[1])
    if model.motion_decoder is None:
        raise ValueError("TMR's objective needs a decoder")
    decoded = [model.motion_decoder(latent, mask) for latent in latents]
    return {
        "reconstruction": losses.reconstruction(target, *decoded),
        "kl": losses.kl_terms(text, motion),
        "latent": losses.latent_loss(*latents),
        "contrastive": losses.contrastive(*latents, temperature, ignore),
    }


def contrast(text: Tensor, motion: Tensor, temperature: Tensor, batch: Batch, recipe: Recipe) -> Tensor:
    """The contrastive term of latents, text (B + E, D) and motion (B, D), with the hard-negative loss."""
    if recipe.contrast == "margin":
        term = losses.margin(text, motion)
    else:
        term = losses.contrastive(text, motion, temperature, batch.ignore)
    if recipe.hard_negative_weight and len(batch.owners):
        term = term + recipe.hard_negative_weight * losses.hard_negative_loss(text, motion, batch.owners, temperature)
    return term


def encode(encoder: TransformerEncoder, rows: Sequence[NDArray[np.floating]], groups: int = 3) -> Gaussian:
    """Rows of mixed lengths through an encoder, in groups of like length so that little is padding."""
    order = np.argsort([len(row) for row in rows], kind="stable")
    parts = [encoder(*pad([rows[i] for i in part])) for part in np.array_split(order, groups) if len(part)]
    back = torch.from_numpy(np.argsort(order))
    return Gaussian(*(torch.cat(side)[back] for side in zip(*parts, strict=True)))
