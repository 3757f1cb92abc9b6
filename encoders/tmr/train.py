"""Train TMR on captioned motion: all its losses, no wrong negatives, resumable.

Beyond the published recipe, each switched by a field of `Recipe`: a learned temperature, hard negatives (captions
with the order, side, direction or count changed), sentences about anything but motion as negatives, weight
averaging, random crops, and a share of real clips in every batch.
"""

from __future__ import annotations

import json
import math
import os
import time
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import torch
import torch.nn.functional as F
from numpy.typing import NDArray
from torch import Tensor

from encoders.corpus.facts import stated_by
from encoders.kinds import FEATURE_KINDS
from encoders.tmr import losses
from encoders.tmr.data import PairStore, sides_conflict
from encoders.tmr.network import TMR, Config, Encoder, Gaussian, Tower
from encoders.tmr.tokens import TokenTable, pad


def _default_network() -> Config:
    """The sizes of the default model: about a quarter of published TMR's, four frames a token."""
    size = FEATURE_KINDS["body"].size
    return Config(
        motion=Tower(features=size, width=256, layers=3, feedforward=768, frames_per_token=4),
        text=Tower(features=384, width=256, layers=2, feedforward=768),
        decoder=Tower(features=size, width=192, layers=1, feedforward=384, frames_per_token=4, dropout=0.0),
        latent=256,
    )


@dataclass(frozen=True)
class Recipe:
    """Everything that decides a training run.

    Attributes
    ----------
    steps, batch, rate, warmup, decay : optimisation (AdamW, linear warm-up, cosine to a twentieth)
    real_share : share of each batch taken from real clips
    temperature : of the contrastive term; learned from this start where `learn_temperature`
    filter : "facts" leaves out pairs known to be no negatives, "none" leaves out nothing
    similarity : sentences nearer than this on the (1 + cosine) / 2 scale are no negatives where a real clip is involved
    contrast : "infonce", "margin" (a ranking loss with a random negative) or "none"
    hard_negatives, unrelated : captions a batch that are negatives for their own clip, or for every clip
    telling : weight, within the contrastive term, of choosing between a sentence and its changed twin
    crop : share of single-action clips of which a random part is shown
    noise, bias : standard deviations of frame noise and of a constant offset a clip, in standardised units
    words_lost : chance of each word piece to be left out of a sentence
    averaging : decay of the running mean of weights that is kept
    sampled : the contrastive term sees sampled latents, as published, instead of means
    decoded : motions a batch that are reconstructed
    """

    network: Config = field(default_factory=_default_network)
    weights: losses.Weights = field(default_factory=lambda: losses.Weights(contrastive=0.5))
    steps: int = 2400
    batch: int = 192
    rate: float = 1e-3
    warmup: int = 60
    decay: float = 0.02
    real_share: float = 0.2
    temperature: float = 0.07
    learn_temperature: bool = True
    filter: str = "facts"
    similarity: float = 0.8
    contrast: str = "infonce"
    hard_negatives: int = 48
    telling: float = 0.5
    unrelated: int = 8
    crop: float = 0.3
    noise: float = 0.03
    bias: float = 0.1
    words_lost: float = 0.05
    averaging: float = 0.995
    sampled: bool = False
    decoded: int = 64
    max_frames: int = 128
    seed: int = 0
    bf16: bool = False

    def to_dict(self) -> dict[str, Any]:
        """Plain numbers, as JSON takes them."""
        return asdict(self)

    @classmethod
    def from_dict(cls, values: dict[str, Any]) -> Recipe:
        """Inverse of `to_dict`."""
        values = dict(values)
        values["network"] = Config.from_dict(values["network"])
        values["weights"] = losses.Weights(**values["weights"])
        return cls(**values)


@dataclass(frozen=True)
class Normaliser:
    """Mean and standard deviation of every feature (F,)."""

    mean: NDArray[np.float32]
    std: NDArray[np.float32]

    @classmethod
    def of(cls, features: NDArray[np.floating]) -> Normaliser:
        """From features (N, F), of which at most 200,000 rows are looked at."""
        rows = features[:: max(1, len(features) // 200_000)].astype(np.float32)
        return cls(rows.mean(0), np.maximum(rows.std(0), 0.02))


@dataclass(frozen=True)
class Batch:
    """One step's rows of mixed lengths; texts beyond the motions' count are negatives only.

    Attributes
    ----------
    motions : rows (T, F), standardised
    texts : rows (L, width)
    ignore : boolean (texts, motions), True where a pair counts neither way
    swapped : (S,) for the S texts right after the motions' own: the motion of which each is nearly, yet not, true
    """

    motions: list[NDArray[np.float32]]
    texts: list[NDArray[np.float16]]
    ignore: Tensor
    swapped: Tensor


class Batches:
    """Draws batches from made and real pairs."""

    def __init__(
        self,
        made: PairStore,
        real: PairStore | None,
        unrelated: Sequence[str],
        tokens: TokenTable,
        texts: dict[str, int],
        normaliser: Normaliser,
        recipe: Recipe,
    ) -> None:
        self.made, self.real, self.recipe, self.tokens, self.normaliser = made, real, recipe, tokens, normaliser
        self.rows = {id(store): np.array([texts[t] for t in store.texts]) for store in (made, real) if store}
        self.all_texts = list(texts)
        self.unrelated = np.array([texts[t] for t in unrelated])

    def draw(self, rng: np.random.Generator) -> Batch:
        """One batch."""
        recipe = self.recipe
        n_real = round(recipe.batch * recipe.real_share) if self.real else 0
        picks = [(self.made, int(i)) for i in rng.integers(len(self.made), size=recipe.batch - n_real)]
        if self.real:
            picks += [(self.real, int(i)) for i in rng.integers(len(self.real), size=n_real)]
        chosen = [int(rng.integers(len(store.captions[i]))) for store, i in picks]
        own = [int(self.rows[id(store)][store.captions[i][c]]) for (store, i), c in zip(picks, chosen, strict=True)]
        swapped = [
            (row, int(self.rows[id(store)][rng.choice(store.swapped[i])]))
            for row, (store, i) in enumerate(picks)
            if store.swapped[i]
        ][: recipe.hard_negatives]
        away = rng.choice(self.unrelated, size=recipe.unrelated) if recipe.unrelated else np.zeros(0, np.int64)
        motions = [self._motion(store, i, rng) for store, i in picks]
        texts = self._words([*own, *(t for _, t in swapped), *away.tolist()], rng)
        ignore = np.zeros((len(own) + len(swapped) + len(away), len(own)), bool)
        if recipe.filter == "facts":
            ignore[: len(own)] = self._no_negatives(picks, chosen, own)
        for extra, (row, _) in enumerate(swapped):
            ignore[len(own) + extra] = True
            ignore[len(own) + extra, row] = False
        return Batch(motions, texts, torch.from_numpy(ignore), torch.tensor([row for row, _ in swapped]).long())

    def _motion(self, store: PairStore, index: int, rng: np.random.Generator) -> NDArray[np.float32]:
        recipe = self.recipe
        x = (store.motion(index).astype(np.float32) - self.normaliser.mean) / self.normaliser.std
        limit = recipe.max_frames
        facts = store.facts[index]
        if rng.random() < recipe.crop and facts is not None and not any("<" in store.vocabulary[f] for f in facts):
            limit = min(limit, max(12, int(len(x) * rng.uniform(0.5, 1))))
        if len(x) > limit:
            start = int(rng.integers(len(x) - limit + 1))
            x = x[start : start + limit]
        size = x.shape[1]
        offset = recipe.bias * rng.standard_normal(size, dtype=np.float32)
        return x + offset + recipe.noise * rng.standard_normal(x.shape, dtype=np.float32)

    def _words(self, indices: list[int], rng: np.random.Generator) -> list[NDArray[np.float16]]:
        """Token features of sentences, some of whose word pieces are lost; the first token always stays."""
        rows = self.tokens.rows(indices)
        kept = [rng.random(len(row)) >= self.recipe.words_lost for row in rows]
        return [row[keep | (np.arange(len(row)) == 0)] for row, keep in zip(rows, kept, strict=True)]

    def _no_negatives(self, picks: list[tuple[PairStore, int]], chosen: list[int], own: list[int]) -> NDArray[np.bool_]:
        """(texts, motions): the sentence is, or may well be, true of a motion it was not written for."""
        made = np.array([store.facts[i] is not None for store, i in picks])
        ignore = np.zeros((len(picks), len(picks)), bool)
        rows = np.flatnonzero(made)
        if len(rows):
            store = self.made
            meanings = [store.meanings[picks[r][1]][chosen[r]] for r in rows]  # type: ignore[index]
            facts = [store.facts[picks[r][1]] or [] for r in rows]
            ignore[np.ix_(rows, rows)] = stated_by(meanings, facts, len(store.vocabulary))
        involved = ~(made[:, None] & made[None, :])
        sentences = self.tokens.sentences[own]
        near = sentences @ sentences.T > 2 * self.recipe.similarity - 1
        ignore |= near & involved & ~sides_conflict([self.all_texts[t] for t in own])
        same = np.array(own)[:, None] == np.array(own)[None, :]
        return ignore | same


def contrast(text: Tensor, motion: Tensor, ignore: Tensor, temperature: Tensor, kind: str) -> Tensor:
    """The contrastive term; text (B + extra, D) and motion (B, D), row i of one belonging to row i of the other.

    "infonce" is (5.1) of Petrovich's thesis with further negatives on the text side; "margin" is the ranking loss
    of the retrieval model before it (Guo et al. 2022): one random negative, Euclidean, margin 10 on unscaled latents.
    """
    count = len(motion)
    if kind == "margin":
        own = (text[:count] - motion).norm(dim=1)
        other = (text[:count] - motion.roll(1, 0)).norm(dim=1)
        return (own**2).mean() + (F.relu(10 - other) ** 2).mean()
    logits = F.normalize(text, dim=-1) @ F.normalize(motion, dim=-1).T / temperature
    own_pairs = torch.eye(len(text), count, dtype=torch.bool)
    logits = logits.masked_fill(ignore & ~own_pairs, -torch.inf)
    target = torch.arange(count)
    return (F.cross_entropy(logits[:count], target) + F.cross_entropy(logits.T, target)) / 2


def telling_apart(text: Tensor, motion: Tensor, swapped: Tensor, temperature: Tensor) -> Tensor:
    """Cross-entropy of choosing, for a motion, its own sentence over the one with a single thing changed."""
    count = len(motion)
    motion = F.normalize(motion[swapped], dim=-1)
    own = (F.normalize(text[swapped], dim=-1) * motion).sum(-1)
    other = (F.normalize(text[count : count + len(swapped)], dim=-1) * motion).sum(-1)
    return F.softplus((other - own) / temperature).mean()


def encode(encoder: Encoder, rows: Sequence[NDArray[np.floating]], groups: int = 3) -> Gaussian:
    """Rows of mixed lengths through an encoder, in groups of like length so that little is padding."""
    order = np.argsort([len(row) for row in rows], kind="stable")
    parts = [encoder(*pad([rows[i] for i in part])) for part in np.array_split(order, groups) if len(part)]
    back = torch.from_numpy(np.argsort(order))
    return Gaussian(*(torch.cat(side)[back] for side in zip(*parts, strict=True)))


def step_losses(model: TMR, log_temperature: Tensor, batch: Batch, recipe: Recipe) -> dict[str, Tensor]:
    """Every term of TMR's objective on one batch, named as the fields of `losses.Weights`."""
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
        terms["contrastive"] = contrast(*sides, batch.ignore, log_temperature.exp(), recipe.contrast)
        if recipe.telling and len(batch.swapped):
            terms["contrastive"] = terms["contrastive"] + recipe.telling * telling_apart(
                *sides, batch.swapped, log_temperature.exp()
            )
    if model.motion_decoder is not None:
        every = max(1, count // recipe.decoded)
        target, mask = pad(batch.motions[::every])
        decoded = [model.motion_decoder(z[::every], mask) for z in (sampled_text, sampled_motion)]
        terms["reconstruction"] = losses.reconstruction(target, *decoded)
        terms["kl"] = losses.kl_terms(text, motion)
        terms["latent"] = losses.nearness(sampled_text, sampled_motion)
    return terms


def learning_rate(step: int, recipe: Recipe) -> float:
    """Linear warm-up, then a cosine down to a twentieth."""
    if step < recipe.warmup:
        return recipe.rate * (step + 1) / recipe.warmup
    progress = (step - recipe.warmup) / max(1, recipe.steps - recipe.warmup)
    return recipe.rate * (0.05 + 0.95 * 0.5 * (1 + math.cos(math.pi * min(progress, 1.0))))


class Trainer:
    """One training run in a folder: `recipe.json`, `last.pt`, `log.jsonl`; continues where it was stopped."""

    def __init__(self, folder: Path, recipe: Recipe, batches: Batches) -> None:
        self.folder, self.recipe, self.batches = folder, recipe, batches
        torch.manual_seed(recipe.seed)
        self.rng = np.random.default_rng(recipe.seed)
        self.model = TMR(recipe.network)
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
        self.step = 0
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
        batch = self.batches.draw(self.rng)
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

    def _save(self) -> None:
        partial = self.folder / "last.partial"
        torch.save(
            {
                "step": self.step,
                "model": self.model.state_dict(),
                "average": self.average,
                "log_temperature": self.log_temperature.detach(),
                "optimiser": self.optimiser.state_dict(),
                "numpy_rng": json.dumps(self.rng.bit_generator.state),
                "torch_rng": torch.get_rng_state(),
            },
            partial,
        )
        os.replace(partial, self.folder / "last.pt")

    def _restore(self) -> None:
        begun = Recipe.from_dict(json.loads((self.folder / "recipe.json").read_text(encoding="utf-8")))
        if begun.network != self.recipe.network:
            raise ValueError(f"{self.folder}: was begun with another network; train it in a folder of its own")
        saved = torch.load(self.folder / "last.pt", weights_only=True)
        self.step = saved["step"]
        self.model.load_state_dict(saved["model"])
        self.average = saved["average"]
        with torch.no_grad():
            self.log_temperature.copy_(saved["log_temperature"])
        self.optimiser.load_state_dict(saved["optimiser"])
        self.rng.bit_generator.state = json.loads(saved["numpy_rng"])
        torch.set_rng_state(saved["torch_rng"])
