"""The last lesson of a training run: the gist alone learns, from motions that stay where the encoders have put them.

Beside everything else it learns slowly. Alone it is a small perceptron over sentence means, so that thousands of steps
take minutes.
"""

from __future__ import annotations

import numpy as np
import torch

from encoders.tmr.model.network import TMR
from encoders.tmr.model.padding import pad
from encoders.tmr.training.batches import Batches
from encoders.tmr.training.embed import embed_motions
from encoders.tmr.training.objective import contrast
from encoders.tmr.training.recipe import Recipe

#: Share of the steps in which the rate rises.
_WARMUP = 0.02


def finetune_head(model: TMR, batches: Batches, temperature: float, recipe: Recipe) -> None:
    """Train the gist of a model for `recipe.gist_steps`, in place; what the model says otherwise stays.

    Its weights at the end are their running mean, as those of the run.
    """
    gist = model.text_encoder.gist
    assert gist is not None
    gist.requires_grad_(True).train()
    rng, tau = np.random.default_rng(recipe.seed), torch.tensor(temperature)
    motions = batches.place(model)
    if batches.real:
        real = embed_motions(model, batches.real, batches.normaliser, recipe.max_frames)
        motions = np.concatenate([motions, real])
    optimiser = torch.optim.AdamW(gist.parameters(), lr=recipe.rate, weight_decay=recipe.decay, betas=(0.9, 0.98))
    schedule = torch.optim.lr_scheduler.OneCycleLR(
        optimiser, recipe.rate, total_steps=recipe.gist_steps, pct_start=_WARMUP, div_factor=20, cycle_momentum=False
    )
    average = {name: value.detach().clone() for name, value in gist.state_dict().items()}
    for _ in range(recipe.gist_steps):
        batch = batches.draw(rng)
        loss = contrast(gist(*pad(batch.texts)), torch.from_numpy(motions[batch.picked]), tau, batch, recipe)
        optimiser.zero_grad()
        loss.backward()
        optimiser.step()
        schedule.step()
        for name, value in gist.state_dict().items():
            average[name].lerp_(value, 1 - recipe.averaging)
    gist.load_state_dict(average)
    gist.requires_grad_(False).eval()
