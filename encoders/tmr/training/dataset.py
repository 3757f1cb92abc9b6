"""The data of a training run: synthetic clips in shards, real clips and out-of-domain sentences."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import replace
from itertools import chain
from multiprocessing import get_context
from pathlib import Path

import numpy as np

from encoders.corpus.composition.caption_augmentation import augment_captions
from encoders.corpus.composition.captioned_motion import CaptionedTake, real_clips
from encoders.corpus.composition.compositional_augmentation import augmented_clips, captioned_segments
from encoders.corpus.composition.facts import facts
from encoders.corpus.composition.idle_motion import idle_clips
from encoders.corpus.composition.seeds import TRAINING
from encoders.corpus.composition.synthetic_pairs import synthetic_clips
from encoders.corpus.language.held_out_sentences import HeldOutSentences
from encoders.corpus.scene import Scene
from encoders.features.registry import FEATURE_KINDS, FeatureKind
from encoders.motion import Motion
from encoders.tmr.training.pairs import Pair, PairStore

SHARD = 2500


def synthetic_store(
    path: Path,
    seed: int,
    count: int,
    kind: str,
    sentences: Sequence[str],
    held_out: HeldOutSentences,
    gaits: float = 0.0,
) -> PairStore:
    """`count` synthetic clips, from `path` if it is there, else saved there; `gaits`: share of locomotion alone."""
    if not path.exists():
        clips = synthetic_clips(
            seed, count, FEATURE_KINDS[kind], sentences=sentences, gait_share=gaits, held_out=held_out
        )
        PairStore(Pair(m.features, m.captions, m.meanings, facts(m.scene), m.hard_negatives) for m in clips).save(path)
    return PairStore.load(path)


def synthetic_stores(
    folder: Path,
    count: int,
    kind: str,
    sentences: Sequence[str],
    held_out: HeldOutSentences,
    *,
    gaits: float = 0.0,
    seed: int = TRAINING,
    jobs: int | None = None,
    say: Callable[[str], None] = print,
) -> PairStore:
    """`count` synthetic clips in shards, synthesised in parallel; shards that are there are used again."""
    shards = -(-count // SHARD)
    jobs = jobs or os.cpu_count() or 1
    folder.mkdir(parents=True, exist_ok=True)
    paths = [_shard_file(folder, seed + i) for i in range(shards)]
    missing = [(path, seed + i) for i, path in enumerate(paths) if not path.exists()]
    if missing:
        with ProcessPoolExecutor(jobs, mp_context=get_context("spawn")) as pool:
            rest = kind, tuple(sentences), held_out, gaits
            tasks = [pool.submit(_synthesise_shard, path, s, *rest) for path, s in missing]
            for done, task in enumerate(tasks, 1):
                task.result()
                say(f"synthesised {done * SHARD} of {len(missing) * SHARD} clips")
    return PairStore.joined([PairStore.load(path) for path in paths])


def _shard_file(folder: Path, seed: int) -> Path:
    former = folder / f"made-{seed:07d}.npz"  # the name in version 0.1
    return former if former.exists() else folder / f"synthetic-{seed:07d}.npz"


def _synthesise_shard(
    path: Path, seed: int, kind: str, sentences: Sequence[str], held_out: HeldOutSentences, gaits: float
) -> None:
    synthetic_store(path, seed, SHARD, kind, sentences, held_out, gaits)


def real_store(
    takes: Iterable[CaptionedTake],
    kind: FeatureKind,
    *,
    varied: bool,
    held_out: HeldOutSentences,
    augmented: int = 0,
    idle: Sequence[Motion] = (),
) -> PairStore:
    """Pairs of captioned takes, and `augmented` more by compositional augmentation.

    Where there is motion of people who wait, `idle`, two thirds as many more are made with it.
    """
    takes = list(takes)
    own = ((Pair(x, captions), None) for take in takes for x, captions in real_clips(take, kind, varied=varied))
    new = (
        (Pair(kind.compute(x.motion), x.captions, hard_negatives=x.hard_negatives), x.scene)
        for x in chain(
            augmented_clips(takes, augmented, np.random.default_rng(TRAINING)),
            idle_clips(idle, list(captioned_segments(takes)), augmented * 2 // 3, np.random.default_rng(TRAINING)),
        )
    )
    rng = np.random.default_rng(TRAINING)
    allowed = ((kept, scene) for pair, scene in chain(own, new) if (kept := _without(pair, held_out)).captions)
    return PairStore(_without(_augmented(pair, scene, rng), held_out) if varied else pair for pair, scene in allowed)


def _augmented(pair: Pair, scene: Scene | None, rng: np.random.Generator) -> Pair:
    """The pair with paraphrases and the facts of its captions, where one can be parsed."""
    augmented = augment_captions(pair.captions, rng, scene=scene)
    if augmented is None:
        return pair
    negatives = (*(pair.hard_negatives or ("",) * len(pair.captions)), *augmented.hard_negatives)
    return Pair(pair.features, (*pair.captions, *augmented.captions), augmented.meanings, augmented.facts, negatives)


def _without(pair: Pair, held_out: HeldOutSentences) -> Pair:
    """The pair without the captions that are held out, and without their hard negatives."""
    kept = [i for i, caption in enumerate(pair.captions) if not held_out(caption)]
    negatives = ["" if held_out(negative) else negative for negative in pair.hard_negatives]
    meanings = None if pair.meanings is None else tuple(pair.meanings[i] for i in kept)
    return replace(
        pair,
        captions=tuple(pair.captions[i] for i in kept),
        meanings=meanings,
        hard_negatives=tuple(negatives[i] for i in kept) if negatives else (),
    )
