"""A training run by TMR's recipe: epochs over captioned clips, in a directory of the published layout.

    config.json                                     the recipe, as the published code writes it
    stats/{mean,std}.pt                             statistics of the features
    last_weights/{motion_encoder,text_encoder,motion_decoder}.pt
    last.pt                                         the state to resume from
    log.jsonl                                       losses of every epoch, and figures on the validation split

Every random decision follows from the seed and the epoch, and a state holds those of torch, so that a run that was
stopped and resumed ends with the same weights as one that was not.
"""

from __future__ import annotations

import json
import math
import os
import time
from collections import defaultdict
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import torch

from encoders.errors import MotionSeekError
from encoders.features.registry import FeatureKind
from encoders.metrics import text_motion
from encoders.tmr.conversion.from_published import MODULES
from encoders.tmr.conversion.run_encoder import RunEncoder
from encoders.tmr.model.network import TMR
from encoders.tmr.model.padding import pad
from encoders.tmr.training import losses
from encoders.tmr.training.captioned_clips import Array, CaptionedClips, TextFeatures
from encoders.tmr.training.false_negatives import similar_sentences
from encoders.tmr.training.objective import published_terms
from encoders.tmr.training.tmr_recipe import EPSILON, TMRRecipe

#: Seconds between two states of one epoch.
_SAVE_EVERY = 600.0
#: What of a recipe may change when a run is resumed.
_MAY_CHANGE = ("epochs",)


class TMRTraining:
    """One run in a folder; continues where it was stopped."""

    def __init__(
        self,
        folder: Path,
        recipe: TMRRecipe,
        kind: FeatureKind,
        clips: CaptionedClips,
        texts: TextFeatures,
        stats: tuple[Array, Array],
        device: str = "cpu",
    ) -> None:
        """Begin a run in a folder, or go on with the one there.

        Raises
        ------
        MotionSeekError
            If the folder holds a run with another recipe or other data.
        """
        self.folder, self.recipe, self.clips, self.texts = folder, recipe, clips, texts
        self.mean, self.std = stats
        self.device = torch.device(device)
        torch.manual_seed(recipe.seed)
        self.model = TMR(recipe.network(kind.size, texts.width)).to(self.device)
        self.optimiser = torch.optim.AdamW(self.model.parameters(), lr=recipe.rate, weight_decay=recipe.decay)
        self.epoch, self.step = 0, 0
        self._sums: dict[str, float] = defaultdict(float)
        folder.mkdir(parents=True, exist_ok=True)
        self._identity = self._describe(kind)
        if (folder / "last.pt").is_file():
            self._restore()
        config = recipe.published_config(kind, texts.width, texts.language_model)
        _write_text(folder / "config.json", json.dumps(config, indent=4))
        for name, values in (("mean", self.mean), ("std", self.std)):
            _write_tensor(folder / "stats" / f"{name}.pt", torch.from_numpy(values))

    def run(
        self,
        validation: CaptionedClips | None = None,
        *,
        minutes: float = math.inf,
        say: Callable[[str], None] = print,
    ) -> RunEncoder:
        """Train to the recipe's last epoch, or for `minutes`, validated after every epoch on the first captions."""
        end = time.monotonic() + 60 * minutes
        while self.epoch < self.recipe.epochs and time.monotonic() < end:
            begun = time.monotonic()
            if not self._train_epoch(end):
                break
            terms = {name: total / self.step for name, total in self._sums.items()}
            self.epoch, self.step = self.epoch + 1, 0
            self._sums.clear()
            figures = {} if validation is None else self._validate(validation)
            row = {"epoch": self.epoch, "seconds": round(time.monotonic() - begun, 1), **terms, **figures}
            with (self.folder / "log.jsonl").open("a", encoding="utf-8") as log:
                log.write(json.dumps(row) + "\n")
            say("  ".join(f"{name} {value:.4g}" for name, value in row.items()))
            self._save()
        self._save()
        return self.encoder()

    def encoder(self) -> RunEncoder:
        """The model as it is, to embed with."""
        return RunEncoder(self.folder.resolve().name, self.model.eval(), self.mean, self.std)

    def losses_of(self, picks: list[tuple[int, int]]) -> dict[str, torch.Tensor]:
        """The terms of the loss on (motion, caption) pairs, named as the fields of `losses.LossWeights`."""
        captions = [self.clips.captions[i][c] for i, c in picks]
        motions = [(self.clips.clip(i, c) - self.mean) / (self.std + EPSILON) for i, c in picks]
        similar = similar_sentences(self.texts.sentences(captions), self.recipe.threshold or math.inf)
        padded = (pad(rows) for rows in (motions, self.texts.tokens(captions)))
        on_device = [(x.to(self.device), mask.to(self.device)) for x, mask in padded]
        return published_terms(
            self.model,
            on_device[0],
            on_device[1],
            temperature=self.recipe.temperature,
            ignore=torch.from_numpy(similar).to(self.device),
        )

    def _train_epoch(self, end: float) -> bool:
        """Train on what is left of the epoch; False where the time is over before it."""
        saved = time.monotonic()
        for number, picks in enumerate(self._batches()):
            if number < self.step:
                continue
            if time.monotonic() >= end:
                return False
            self._advance(picks)
            if time.monotonic() - saved > _SAVE_EVERY:
                self._save()
                saved = time.monotonic()
        return True

    def _batches(self) -> Iterator[list[tuple[int, int]]]:
        """The batches of the epoch: every motion once, in random order, with a random one of its captions."""
        rng = np.random.default_rng([self.recipe.seed, self.epoch])
        order, draws = rng.permutation(len(self.clips)), rng.random(len(self.clips))
        picks = [(int(i), int(draws[i] * len(self.clips.captions[i]))) for i in order]
        return (picks[start : start + self.recipe.batch] for start in range(0, len(picks), self.recipe.batch))

    def _advance(self, picks: list[tuple[int, int]]) -> None:
        if self.step == 0:
            torch.manual_seed(self.recipe.seed + self.epoch + 1)
        self.model.train()
        terms = self.losses_of(picks)
        loss = losses.total(terms, self.recipe.weights)
        if not torch.isfinite(loss):
            raise FloatingPointError(f"the loss is {loss.item()} in epoch {self.epoch + 1}, step {self.step + 1}")
        self.optimiser.zero_grad()
        loss.backward()
        self.optimiser.step()
        self.step += 1
        for name, term in {**terms, "loss": loss}.items():
            self._sums[name] += term.item()

    def _validate(self, clips: CaptionedClips) -> dict[str, float]:
        """Retrieval among the validation split, strict, with latents that are means."""
        encoder = self.encoder()
        motions = encoder.encode_features([clips.clip(i, 0) for i in range(len(clips))])
        captions = [captions[0] for captions in clips.captions]
        distinct = list(dict.fromkeys(captions))
        sentences = encoder.encode_token_features(self.texts.tokens(distinct))
        similarity = (sentences @ motions.T)[[distinct.index(caption) for caption in captions]]
        return {
            f"{way} {name}": figures[name]
            for way, figures in text_motion(similarity).items()
            for name in ("R@1", "R@10", "MedR")
        }

    def _describe(self, kind: FeatureKind) -> str:
        """What must be the same when a run is resumed."""
        recipe = {name: value for name, value in self.recipe.to_dict().items() if name not in _MAY_CHANGE}
        models = (self.texts.language_model, self.texts.sentence_model)
        return json.dumps([recipe, kind.name, len(self.clips), models, str(self.device.type)])

    def _save(self) -> None:
        for name in MODULES:
            _write_tensor(self.folder / "last_weights" / f"{name}.pt", getattr(self.model, name).state_dict())
        on_cuda = self.device.type == "cuda"
        state = {
            "identity": self._identity,
            "epoch": self.epoch,
            "step": self.step,
            "sums": dict(self._sums),
            "model": self.model.state_dict(),
            "optimiser": self.optimiser.state_dict(),
            "torch_rng": torch.get_rng_state(),
            "cuda_rng": torch.cuda.get_rng_state(self.device) if on_cuda else torch.empty(0, dtype=torch.uint8),
        }
        _write_tensor(self.folder / "last.pt", state)

    def _restore(self) -> None:
        saved = torch.load(self.folder / "last.pt", map_location="cpu", weights_only=True)
        if saved.get("identity") != self._identity:
            raise MotionSeekError(
                f"{self.folder}: holds a run with another recipe, data set or device; train in a folder of its own"
            )
        self.epoch, self.step = saved["epoch"], saved["step"]
        self._sums.update(saved["sums"])
        self.model.load_state_dict(saved["model"])
        self.optimiser.load_state_dict(saved["optimiser"])
        torch.set_rng_state(saved["torch_rng"])
        if len(saved["cuda_rng"]):
            torch.cuda.set_rng_state(saved["cuda_rng"], self.device)


def best_device() -> str:
    """A GPU where torch has one."""
    return "cuda" if torch.cuda.is_available() else "cpu"


def _write_text(path: Path, text: str) -> None:
    partial = path.with_name(f"{path.name}.partial")
    partial.write_text(text, encoding="utf-8")
    os.replace(partial, path)


def _write_tensor(path: Path, value: Any) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    partial = path.with_name(f"{path.name}.partial")
    torch.save(value, partial)
    os.replace(partial, path)
