"""Ways to ask the same model, compared on the validation takes: what is kept, and what was tried and is not.

    python benchmarks/asking.py data/mocap captions.jsonl [--bundle FOLDER]

The gallery are all captioned spans of the split `val`; every sentence is asked of them, and every span of all the
sentences. One model, one seed: differences of a point or two are none.
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
    """Print the table."""
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
    plain, phrased = bundle.encode_texts(sentences), encode_queries(bundle, sentences)
    said = _unit(phrased + 0.5 * np.stack([_described(bundle, s, q) for s, q in zip(sentences, phrased, strict=True)]))
    bank = bundle.encode_texts([clip.captions[0] for clip in synthetic_clips(VALIDATION, 500, kind)])
    crowded = np.sort(bank @ gallery.T, axis=0)[-10:].mean(axis=0)
    cosines = plain @ gallery.T
    print(f"{len(sentences)} sentences, {len(spans)} spans, {bundle.name} {bundle.fingerprint[:12]}\n")
    print("| | R@1 | R@5 | R@10 | mean reciprocal rank |\n|---|---|---|---|---|")
    _row("sentence -> motion: the sentence alone", cosines, right)
    _row("with its phrasings (kept)", phrased @ gallery.T, right)
    _row("and with captions of the scene it is read as", said @ gallery.T, right)
    _row("less what the motion scores with a bank of sentences", phrased @ gallery.T - 0.25 * crowded, right)
    _row("motion -> sentence: the cosine", cosines.T, right.T)
    penalised = cosines.T - hubness_penalty(bundle, plain)
    _row("less a share of what the sentence scores with unrelated motions (kept)", penalised, right.T)


def _described(bundle: Bundle, sentence: str, vector: Array) -> Array:
    """Mean vector of six captions of what a sentence is read as; its own vector where it cannot be read."""
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
