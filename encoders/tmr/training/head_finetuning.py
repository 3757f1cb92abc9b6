"""Head fine-tuning: at the end of a run the sentence head is trained alone, on fixed embeddings of motions.

Trained along with the encoders it converges slowly. Alone it is a small perceptron on sentence means: thousands of
steps take minutes.
"""

from __future__ import annotations

import numpy as np
import torch

from encoders.tmr.model.network import TMR
from encoders.tmr.model.padding import pad
from encoders.tmr.training.batches import Batches
from encoders.tmr.training.objective import contrast
from encoders.tmr.training.recipe import Recipe

#: Share of the steps in which the rate rises.
_WARMUP = 0.02


def finetune_head(model: TMR, batches: Batches, temperature: float, recipe: Recipe) -> None:
    """Train the sentence head of a model for `recipe.head_steps`, in place; all other weights stay.

    Its final weights are their running mean, as for the run.
    """
    head = model.text_encoder.sentence_head
    assert head is not None
    head.requires_grad_(True).train()
    rng, tau = np.random.default_rng(recipe.seed), torch.tensor(temperature)
    motions = torch.from_numpy(batches.embed(model))
    optimiser = torch.optim.AdamW(head.parameters(), lr=recipe.rate, weight_decay=recipe.decay, betas=(0.9, 0.98))
    schedule = torch.optim.lr_scheduler.OneCycleLR(
        optimiser, recipe.rate, total_steps=recipe.head_steps, pct_start=_WARMUP, div_factor=20, cycle_momentum=False
    )
    average = {name: value.detach().clone() for name, value in head.state_dict().items()}
    for _ in range(recipe.head_steps):
        batch = batches.draw(rng)
        loss = contrast(head(*pad(batch.texts)), motions[batch.picked], tau, batch, recipe)
        optimiser.zero_grad()
        loss.backward()
        optimiser.step()
        schedule.step()
        for name, value in head.state_dict().items():
            average[name].lerp_(value, 1 - recipe.averaging)
    head.load_state_dict(average)
    head.requires_grad_(False).eval()
