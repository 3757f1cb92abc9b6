"""The domain gap between real and synthetic motion: retrieval of real takes among synthetic clips.

    python -m benchmarks.domains data/mocap captions.jsonl [--bundle FOLDER] [--count 1000]

Each take of the split `val` with a parsable caption gets three paraphrases from the corpus
(`encoders/corpus/composition/caption_augmentation.py`). Each paraphrase ranks its take among the synthetic clips that
it does not describe. A model that separates real from synthetic motion ranks the take low, however well it retrieves
real takes among real ones.
"""

from __future__ import annotations

import argparse
from pathlib import Path

import numpy as np

from encoders.bundle.bundle import Bundle
from encoders.corpus.composition.caption_augmentation import augment_captions
from encoders.corpus.composition.captioned_motion import real_clips
from encoders.corpus.composition.facts import entailment, facts
from encoders.corpus.composition.seeds import VALIDATION
from encoders.corpus.composition.synthetic_pairs import synthetic_clips
from encoders.features.registry import FEATURE_KINDS
from indexer.datasets.captioned_takes import captioned_takes


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=Path)
    parser.add_argument("captions", type=Path)
    parser.add_argument("--bundle", type=Path)
    parser.add_argument("--count", type=int, default=1000)
    args = parser.parse_args()

    bundle, kind, rng = Bundle.load(args.bundle), FEATURE_KINDS["body"], np.random.default_rng(0)
    takes = captioned_takes(args.folder, args.captions, "val")
    clips = [clip for take in takes for clip in real_clips(take, kind, varied=False)]
    augmented = [(x, more) for x, captions in clips if (more := augment_captions(captions, rng)) is not None]
    sentences = [caption for _, more in augmented for caption in more.captions]
    meanings = [meaning for _, more in augmented for meaning in more.meanings[-len(more.captions) :]]

    synthetic = list(synthetic_clips(VALIDATION, args.count, kind))
    true = entailment(meanings, [facts(clip.scene) for clip in synthetic])

    texts = bundle.encode_texts(sentences)
    real = bundle.encode_features([x[: bundle.max_frames] for x, _ in augmented])
    own = np.einsum("nd,nd->n", texts, np.repeat(real, len(sentences) // len(augmented), axis=0))
    others = texts @ bundle.encode_features([clip.features[: bundle.max_frames] for clip in synthetic]).T
    ranks = (np.where(true, -np.inf, others) > own[:, None]).sum(axis=1)
    print(f"{bundle.name}: {len(augmented)} real clips, {len(sentences)} sentences, {len(synthetic)} synthetic clips")
    print("  ".join(f"R@{k} {100 * np.mean(ranks < k):.1f} %" for k in (1, 5, 10)), f" cosine {own.mean():.2f}")


if __name__ == "__main__":
    main()
