"""The training loop: the steps of a recipe, with checkpoints in a folder to resume from."""

from __future__ import annotations

import json
import math
import os
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
import torch

from encoders.errors import MotionSeekError
from encoders.tmr.model.network import TMR
from encoders.tmr.training import losses
from encoders.tmr.training.batches import Batches
from encoders.tmr.training.checkpoint import read_checkpoint, read_recipe
from encoders.tmr.training.head_finetuning import finetune_head
from encoders.tmr.training.objective import step_losses
from encoders.tmr.training.recipe import Recipe

#: Steps after which the synthetic clips are embedded again with the model as it then is.
_EMBED_EVERY = 600


def learning_rate(step: int, recipe: Recipe) -> float:
    """Linear warm-up, then a cosine down to a twentieth."""
    if step < recipe.warmup:
        return recipe.rate * (step + 1) / recipe.warmup
    progress = (step - recipe.warmup) / max(1, recipe.steps - recipe.warmup)
    return recipe.rate * (0.05 + 0.95 * 0.5 * (1 + math.cos(math.pi * min(progress, 1.0))))


class Trainer:
    """One training run in a folder: `recipe.json`, `last.pt`, `log.jsonl`; continues where it was stopped."""

    def __init__(self, folder: Path, recipe: Recipe, batches: Batches, start: TMR | None = None) -> None:
        self.folder, self.recipe, self.batches = folder, recipe, batches
        torch.manual_seed(recipe.seed)
        self.rng = np.random.default_rng(recipe.seed)
        self.model = TMR(recipe.network)
        if start is not None:
            self.model.load_state_dict(start.state_dict())
        self.log_temperature = torch.nn.Parameter(
            torch.tensor(math.log(recipe.temperature)), requires_grad=recipe.learn_temperature
        )
        self.average = {k: v.detach().clone() for k, v in self.model.state_dict().items()}
        matrices = [p for p in self.model.parameters() if p.ndim > 1]
        vectors = [p for p in self.model.parameters() if p.ndim <= 1]
        self.optimiser = torch.optim.AdamW(
            [
                {"params": matrices, "weight_decay": recipe.decay},
                {"params": [*vectors, self.log_temperature], "weight_decay": 0.0},
            ],
            lr=recipe.rate,
            betas=(0.9, 0.98),
        )
        self.step, self.head_finetuned = 0, False
        folder.mkdir(parents=True, exist_ok=True)
        if (folder / "last.pt").exists():
            self._restore()
        (folder / "recipe.json").write_text(json.dumps(recipe.to_dict(), indent=1), encoding="utf-8")

    def run(
        self,
        *,
        evaluate: Callable[[TMR], dict[str, float]] | None = None,
        every: int = 200,
        minutes: float = math.inf,
        say: Callable[[str], None] = print,
    ) -> TMR:
        """Train to the recipe's end, or for `minutes`; returns the model with averaged weights."""
        started, seen = time.monotonic(), time.monotonic()
        while self.step < self.recipe.steps and time.monotonic() - started < 60 * minutes:
            terms = self._advance()
            if self.step % every == 0 or self.step == self.recipe.steps:
                figures = {} if evaluate is None else evaluate(self.averaged())
                row = {"step": self.step, "seconds": round(time.monotonic() - seen, 1), **terms, **figures}
                seen = time.monotonic()
                with (self.folder / "log.jsonl").open("a") as log:
                    log.write(json.dumps(row) + "\n")
                say("  ".join(f"{k} {v:.4g}" for k, v in row.items()))
                self._save()
        has_head = self.recipe.head_steps and self.model.text_encoder.sentence_head is not None
        if has_head and not self.head_finetuned and self.step == self.recipe.steps:
            self._finetune_head()
            if evaluate is not None:
                say("  ".join(f"{k} {v:.4g}" for k, v in evaluate(self.averaged()).items()))
        self._save()
        return self.averaged()

    def averaged(self) -> TMR:
        """The model with the running mean of its weights, ready for inference."""
        model = TMR(self.recipe.network)
        model.load_state_dict(self.average)
        return model.eval().requires_grad_(False)

    def _advance(self) -> dict[str, float]:
        recipe = self.recipe
        self.model.train()
        for group in self.optimiser.param_groups:
            group["lr"] = learning_rate(self.step, recipe)
        hard = self.step >= recipe.hard_from
        if hard and recipe.similar_share and (self.batches.embeddings is None or self.step % _EMBED_EVERY == 0):
            self.batches.embed_synthetic(self.averaged())
        batch = self.batches.draw(self.rng, hard=hard)
        with torch.autocast("cpu", dtype=torch.bfloat16, enabled=recipe.bf16):
            terms = step_losses(self.model, self.log_temperature, batch, recipe)
        loss = losses.total(terms, recipe.weights)
        if not torch.isfinite(loss):
            raise FloatingPointError(
                f"the loss is {loss.item()} at step {self.step}: { {k: v.item() for k, v in terms.items()} }"
            )
        self.optimiser.zero_grad()
        loss.backward()
        torch.nn.utils.clip_grad_norm_(self.model.parameters(), 1.0)
        self.optimiser.step()
        with torch.no_grad():
            self.log_temperature.clamp_(math.log(0.02), math.log(0.5))
            keep = min(recipe.averaging, (1 + self.step) / (10 + self.step))
            for name, value in self.model.state_dict().items():
                self.average[name].lerp_(value, 1 - keep)
        self.step += 1
        return {k: v.item() for k, v in terms.items()} | {"temperature": self.log_temperature.exp().item()}

    def _finetune_head(self) -> None:
        """Head fine-tuning, of the averaged weights."""
        model = self.averaged()
        finetune_head(model, self.batches, self.log_temperature.exp().item(), self.recipe)
        self.average = model.state_dict()
        self.head_finetuned = True

    def _save(self) -> None:
        partial = self.folder / "last.partial"
        torch.save(
            {
                "step": self.step,
                "taught": self.head_finetuned,
                "model": self.model.state_dict(),
                "average": self.average,
                "log_temperature": self.log_temperature.detach(),
                "optimiser": self.optimiser.state_dict(),
                "numpy_rng": json.dumps(self.rng.bit_generator.state),
                "torch_rng": torch.get_rng_state(),
                "places": None if self.batches.embeddings is None else torch.from_numpy(self.batches.embeddings),
            },
            partial,
        )
        os.replace(partial, self.folder / "last.pt")

    def _restore(self) -> None:
        begun = read_recipe(self.folder)
        if begun.network != self.recipe.network:
            raise MotionSeekError(f"{self.folder}: was begun with another network; train it in a folder of its own")
        saved = read_checkpoint(self.folder)
        self.step, self.head_finetuned = saved["step"], saved.get("taught", False)
        self.model.load_state_dict(saved["model"])
        self.average = saved["average"]
        with torch.no_grad():
            self.log_temperature.copy_(saved["log_temperature"])
        self.optimiser.load_state_dict(saved["optimiser"])
        self.rng.bit_generator.state = json.loads(saved["numpy_rng"])
        torch.set_rng_state(saved["torch_rng"])
        embeddings = saved.get("places")
        if embeddings is not None and len(embeddings) == len(self.batches.synthetic):  # else clips of another run
            self.batches.embeddings = embeddings.numpy()
