"""Recalls of one model on the validation takes for several ways to encode and score a query.

    python -m benchmarks.asking data/mocap captions.jsonl [--bundle FOLDER]

The gallery is all captioned spans of the split `val`. Each of their captions is a query to the spans, and each span a
query to the captions. One model, one seed: differences of a point or two mean nothing.
"""

from __future__ import annotations

import argparse
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from encoders.bundle.bundle import Bundle
from encoders.corpus.composition.captioned_motion import real_clips
from encoders.corpus.composition.seeds import VALIDATION
from encoders.corpus.composition.synthetic_pairs import synthetic_clips
from encoders.corpus.language.caption_generation import describe
from encoders.corpus.language.parsing import parse
from encoders.features.registry import FEATURE_KINDS
from encoders.metrics import ranks
from indexer.datasets.captioned_takes import captioned_takes
from search.query.encoding import encode_queries
from search.ranking.hubness import hubness_penalty

Array = NDArray[np.float32]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=Path)
    parser.add_argument("captions", type=Path)
    parser.add_argument("--bundle", type=Path)
    arguments = parser.parse_args()
    bundle = Bundle.load(arguments.bundle)
    kind = FEATURE_KINDS[bundle.feature_kind]
    takes = captioned_takes(arguments.folder, arguments.captions, "val")
    spans = [span for take in takes for span in real_clips(take, kind, varied=False)]
    gallery = bundle.encode_features([features[: bundle.max_frames] for features, _ in spans])
    sentences = sorted({caption for _, captions in spans for caption in captions})
    right = np.array([[sentence in captions for _, captions in spans] for sentence in sentences])
    plain, paraphrased = bundle.encode_texts(sentences), encode_queries(bundle, sentences)
    generated = np.stack([_generated(bundle, s, q) for s, q in zip(sentences, paraphrased, strict=True)])
    bank = bundle.encode_texts([clip.captions[0] for clip in synthetic_clips(VALIDATION, 500, kind)])
    hubness = np.sort(bank @ gallery.T, axis=0)[-10:].mean(axis=0)
    cosines = plain @ gallery.T
    print(f"{len(sentences)} sentences, {len(spans)} spans, {bundle.name} {bundle.fingerprint[:12]}\n")
    print("| | R@1 | R@5 | R@10 | mean reciprocal rank |\n|---|---|---|---|---|")
    _row("sentence -> motion: the sentence alone", cosines, right)
    _row("with its paraphrases (kept)", paraphrased @ gallery.T, right)
    _row(
        "and with generated captions of the scene it is parsed as",
        _unit(paraphrased + 0.5 * generated) @ gallery.T,
        right,
    )
    _row("less a hubness penalty of the motion", paraphrased @ gallery.T - 0.25 * hubness, right)
    _row("motion -> sentence: the cosine", cosines.T, right.T)
    penalised = cosines.T - hubness_penalty(bundle, plain)
    _row("less the hubness penalty of the sentence (kept)", penalised, right.T)


def _generated(bundle: Bundle, sentence: str, vector: Array) -> Array:
    """Mean vector of six captions generated for the scene of a sentence; `vector` where it cannot be parsed."""
    scene = parse(sentence)
    if scene is None:
        return vector
    rng = np.random.default_rng(0)
    return _unit(bundle.encode_texts([describe(scene, rng).text for _ in range(6)]).mean(axis=0))


def _unit(vectors: Array) -> Array:
    unit: Array = vectors / np.linalg.norm(vectors, axis=-1, keepdims=True)
    return unit


def _row(name: str, scores: Array, right: NDArray[np.bool_]) -> None:
    rank = ranks(scores, right)
    found = " | ".join(f"{100 * np.mean(rank < k):.1f}" for k in (1, 5, 10))
    print(f"| {name} | {found} | {np.mean(1 / (rank + 1)):.3f} |")


if __name__ == "__main__":
    main()
