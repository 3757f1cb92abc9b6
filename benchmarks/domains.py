"""Whether real motion lies where made motion does that shows the same: real takes asked for among made clips.

    python -m benchmarks.domains data/mocap captions.jsonl [--bundle FOLDER] [--count 1000]

The takes of the split `val` of which a caption is understood (`encoders/corpus/composition/real_captions.py`) are
told in three sentences of the corpus. Each sentence ranks its take among made clips of which it is not true. A model
that has learned to tell real from made motion finds them late, however well it finds real ones among real ones.
"""

from __future__ import annotations

import argparse
from pathlib import Path

import numpy as np

from encoders.bundle.bundle import Bundle
from encoders.corpus.composition.facts import facts, hold
from encoders.corpus.composition.real import real_clips
from encoders.corpus.composition.real_captions import retell
from encoders.corpus.composition.seeds import VALIDATION
from encoders.corpus.composition.synthetic import synthetic_clips
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
    told = [(x, retold) for x, captions in clips if (retold := retell(captions, rng)) is not None]
    sentences = [said for _, retold in told for said in retold.captions]
    stated = [meaning for _, retold in told for meaning in retold.meanings[-len(retold.captions) :]]

    made = list(synthetic_clips(VALIDATION, args.count, kind))
    true = hold(stated, [facts(clip.scene) for clip in made])

    texts = bundle.encode_texts(sentences)
    real = bundle.encode_features([x[: bundle.max_frames] for x, _ in told])
    own = np.einsum("nd,nd->n", texts, np.repeat(real, len(sentences) // len(told), axis=0))
    others = texts @ bundle.encode_features([clip.features[: bundle.max_frames] for clip in made]).T
    ranks = (np.where(true, -np.inf, others) > own[:, None]).sum(axis=1)
    print(f"{bundle.name}: {len(told)} real clips, {len(sentences)} sentences, {len(made)} made clips")
    print("  ".join(f"R@{k} {100 * np.mean(ranks < k):.1f} %" for k in (1, 5, 10)), f" cosine {own.mean():.2f}")


if __name__ == "__main__":
    main()
