"""What a generator makes of human captions, as folders for `motionseek judge`, beside the takes they describe.

    python -m benchmarks.generation my_generator/ data/mocap captions.jsonl OUT [--count 96] [--samples 2]
    motionseek judge OUT/generated --references OUT/real

Spans of takes of the split `val`, each of 2 s or more with its first caption: OUT/real has the takes, OUT/generated as
many samples of each caption and of the same duration.
"""

from __future__ import annotations

import argparse
from pathlib import Path

import numpy as np

from encoders.bundle.bundle import Bundle
from encoders.bundle.generator import MotionGenerator
from indexer.datasets.captioned_takes import captioned_takes


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("bundle", type=Path)
    parser.add_argument("folder", type=Path)
    parser.add_argument("captions", type=Path)
    parser.add_argument("out", type=Path)
    parser.add_argument("--count", type=int, default=96)
    parser.add_argument("--samples", type=int, default=2)
    args = parser.parse_args()

    generator, rng = MotionGenerator(Bundle.load(args.bundle)), np.random.default_rng(0)
    made, real = args.out / "generated", args.out / "real"
    made.mkdir(parents=True)
    real.mkdir()
    spans = {
        (take.trial, span.start): (span.captions[0], take.motion.crop(span.start, span.end))
        for take in captioned_takes(args.folder, args.captions, "val")
        for span in take.spans
    }
    rows = ["path\ttext\treference"]
    fitting = [row for row in spans.values() if 2 <= row[1].duration <= generator.longest]
    for number, (caption, motion) in enumerate(fitting[: args.count]):
        np.save(real / f"{number}.npy", motion.joints)
        samples = generator.motions(generator.of_sentence(caption), motion.duration, args.samples, rng)
        for sample, joints in enumerate(one.joints for one in samples):
            np.save(made / f"{number}-{sample}.npy", joints)
            rows.append(f"{number}-{sample}.npy\t{caption}\t{number}")
    (made / "motions.tsv").write_text("\n".join(rows) + "\n", encoding="utf-8")
    print(f"{len(rows) - 1} motions for {min(len(fitting), args.count)} captions in {args.out}")


if __name__ == "__main__":
    main()
