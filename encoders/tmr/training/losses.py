"""TMR's losses: reconstruction, four KL terms, distance of the latents, and InfoNCE with a false-negative mask;
beside them the ranking loss before TMR, and the hard-negative loss.

Formulas (4.1)-(4.3) and (5.1) of Petrovich's thesis, averaged as the published code averages them: over all
elements, padding included (there both sides are zero).
"""

from __future__ import annotations

from dataclasses import dataclass

import torch
import torch.nn.functional as F
from torch import Tensor

from encoders.tmr.model.network import Gaussian


@dataclass(frozen=True)
class LossWeights:
    """Weights of the terms in the sum; the defaults are those of published TMR."""

    reconstruction: float = 1.0
    kl: float = 1e-5
    latent: float = 1e-5
    contrastive: float = 0.1
    sentence_head: float = 0.5


def reconstruction(target: Tensor, *decoded: Tensor) -> Tensor:
    """Smooth L1 between the target (B, T, F) and each decoded motion, summed over the decoded ones."""
    return torch.stack([F.smooth_l1_loss(motion, target) for motion in decoded]).sum()


def kl(p: Gaussian, q: Gaussian) -> Tensor:
    """KL(p || q) of diagonal Gaussians, averaged over batch and dimensions."""
    variance_ratio = torch.exp(p.logvar - q.logvar)
    distance = (p.mu - q.mu) ** 2 * torch.exp(-q.logvar)
    return 0.5 * (variance_ratio + distance - 1 - (p.logvar - q.logvar)).mean()


def kl_terms(text: Gaussian, motion: Gaussian) -> Tensor:
    """The sum of KL(text || motion), KL(motion || text), KL(motion || N(0, 1)) and KL(text || N(0, 1))."""
    standard = Gaussian(torch.zeros_like(text.mu), torch.zeros_like(text.logvar))
    return kl(text, motion) + kl(motion, text) + kl(motion, standard) + kl(text, standard)


def latent_loss(text: Tensor, motion: Tensor) -> Tensor:
    """Smooth L1 between the latents (B, D) of the two sides."""
    return F.smooth_l1_loss(text, motion)


def contrastive(text: Tensor, motion: Tensor, temperature: float | Tensor, ignore: Tensor | None = None) -> Tensor:
    """Symmetric InfoNCE over cosines of latents; row i of one side belongs to row i of the other.

    Parameters
    ----------
    text : (B + E, D)
        The E further sentences belong to no motion: they are negatives only.
    motion : (B, D)
    temperature : float or scalar tensor
        A tensor may be learned.
    ignore : boolean (B + E, B), text by motion
        Pairs left out of both denominators; the diagonal is never left out.
    """
    count = len(motion)
    logits = F.normalize(text, dim=-1) @ F.normalize(motion, dim=-1).T / temperature
    rows = torch.arange(count, device=logits.device)
    if ignore is not None:
        own = torch.eye(len(text), count, dtype=torch.bool, device=logits.device)
        logits = logits.masked_fill(ignore & ~own, -torch.inf)
    return (F.cross_entropy(logits[:count], rows) + F.cross_entropy(logits.T, rows)) / 2


def margin(text: Tensor, motion: Tensor, distance: float = 10.0) -> Tensor:
    """The ranking loss of retrieval before TMR (Guo et al., CVPR 2022) over unscaled latents (B + E, D) and (B, D).

    Own pairs are drawn together, each motion and one other sentence pushed `distance` apart, Euclidean; the E further
    sentences do not count.
    """
    count = len(motion)
    own = (text[:count] - motion).norm(dim=1)
    other = (text[:count] - motion.roll(1, 0)).norm(dim=1)
    return (own**2).mean() + (F.relu(distance - other) ** 2).mean()


def hard_negative_loss(text: Tensor, motion: Tensor, owners: Tensor, temperature: float | Tensor) -> Tensor:
    """Cross-entropy of choosing, for a motion, its own caption over a hard negative of it.

    Parameters
    ----------
    text : (B + E, D)
        The S hard negatives right after the motions' own captions.
    motion : (B, D)
    owners : (S,)
        The motion of each hard negative.
    """
    count = len(motion)
    motion = F.normalize(motion[owners], dim=-1)
    own = (F.normalize(text[owners], dim=-1) * motion).sum(-1)
    other = (F.normalize(text[count : count + len(owners)], dim=-1) * motion).sum(-1)
    return F.softplus((other - own) / temperature).mean()


def total(terms: dict[str, Tensor], weights: LossWeights) -> Tensor:
    """The weighted sum of terms, which are named as the fields of `LossWeights`."""
    return torch.stack([getattr(weights, name) * term for name, term in terms.items()]).sum()
