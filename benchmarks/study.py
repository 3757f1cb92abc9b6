"""The paper's study on our corpus: what each part of TMR's objective is worth, small runs with one budget.

    python benchmarks/study.py runs/default docs/study.md --steps 200 --batch 128 --clips 5000 [--only NAME ...]

`runs/default` is a folder of `motionseek model train`, whose synthetic clips are used. Every variant sees the same
clips, the same batches and the same number of steps; validation is on held-out synthetic clips (gallery 1,000).
Variants already in RUN/study are not run again.
"""

from __future__ import annotations

import argparse
import json
from dataclasses import replace
from pathlib import Path

import torch

from encoders.corpus.language.unrelated import unrelated_sentences
from encoders.tmr.model.network import TransformerConfig
from encoders.tmr.text.language_model import LanguageModel
from encoders.tmr.training import losses
from encoders.tmr.training.pairs import PairStore
from encoders.tmr.training.pipeline import prepare, train
from encoders.tmr.training.recipe import Recipe, default_network

_ENCODERS = default_network()
_DECODER = TransformerConfig(
    features=_ENCODERS.motion.features, width=192, layers=1, feedforward=384, frames_per_token=4, dropout=0.0
)
PLAIN = Recipe(
    network=replace(_ENCODERS, decoder=_DECODER),
    weights=losses.LossWeights(),
    temperature=0.1,
    learn_temperature=False,
    hard_negatives=0,
    hard_negative_weight=0.0,
    unrelated=0,
    sampled=True,
    typical=False,
    similar_share=0.0,
    token_dropout=0.0,
    yaw=0.0,
    tilt=0.0,
    real_share=0.0,
    crop=0.0,
    noise=0.0,
    bias=0.0,
)
VARIANTS = {
    "TMR": PLAIN,
    "TMR without reconstruction": replace(PLAIN, network=replace(PLAIN.network, decoder=None), sampled=False),
    "margin loss instead of InfoNCE": replace(PLAIN, contrast="margin", weights=losses.LossWeights(contrastive=0.01)),
    "TMR without the false-negative mask": replace(PLAIN, filter="none"),
    "TEMOS (no contrastive loss)": replace(PLAIN, contrast="none"),
    "the default recipe": replace(Recipe(), real_share=0.0),
    "default, hard negatives from the first step": replace(Recipe(), real_share=0.0, hard_from=0, similar_share=0.0),
}
COLUMNS = ("strict_R@1", "strict_MedR", "synthetic_R@1", "synthetic_R@10", "hard_negatives")


def main() -> None:
    """Run what is missing, write the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("run", type=Path)
    parser.add_argument("out", type=Path)
    parser.add_argument("--steps", type=int, default=200)
    parser.add_argument("--batch", type=int, default=128)
    parser.add_argument("--clips", type=int, default=5000)
    parser.add_argument("--only", nargs="*", default=list(VARIANTS))
    arguments = parser.parse_args()
    torch.set_num_threads(1)
    shards = [PairStore.load(path) for path in sorted(arguments.run.glob("synthetic-*.npz"))]
    synthetic = PairStore.joined(shards[: max(1, arguments.clips // len(shards[0]))])
    validation = PairStore.load(arguments.run / "validation.npz")
    language = LanguageModel.load()
    folder = arguments.run / "study"
    for name in arguments.only:
        recipe = replace(VARIANTS[name], steps=arguments.steps, batch=arguments.batch, warmup=arguments.steps // 10)
        place = folder / name.replace(" ", "-").replace(",", "")
        if (place / "figures.json").exists():
            continue
        batches, validate, normaliser = prepare(
            recipe, synthetic, None, validation, None, unrelated_sentences(600), language, folder
        )
        model = train(place, recipe, batches, validate, normaliser, every=arguments.steps)
        (place / "figures.json").write_text(json.dumps(validate(model)))
    rows = []
    for name in VARIANTS:
        figures = folder / name.replace(" ", "-").replace(",", "") / "figures.json"
        if figures.exists():
            values = json.loads(figures.read_text())
            rows.append(f"| {name} | " + " | ".join(f"{values[c]:.1f}" for c in COLUMNS) + " |")
    arguments.out.write_text(
        "# What each part of the objective is worth\n\n"
        f"Made by `benchmarks/study.py`: {arguments.steps} steps of {arguments.batch} clips each, {len(synthetic)} "
        f"synthetic clips, validated on {len(validation)} others; one seed, so small differences are none. Text to "
        "motion, whole gallery; `strict` counts only the clip itself, `true` every clip of which the "
        "sentence is true.\n\n"
        "| | strict R@1 | strict median rank | true R@1 | true R@10 | hard negatives |\n|---|---|---|---|---|---|\n"
        + "\n".join(rows)
        + "\n",
        encoding="utf-8",
    )


if __name__ == "__main__":
    main()
