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
