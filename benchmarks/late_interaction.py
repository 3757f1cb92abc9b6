"""Ranking the first hits again by token vectors, with the shipped model: R@k for sentences of several steps.

    python -m benchmarks.late_interaction [--clips 600]

Synthetic clips that no model was trained on, as a library. Queries are the captions that state steps in order. The
parts of a motion are its windows of 1.6 s, the words of a sentence its steps: the simplest token vectors there are,
without training any. Compared are the ranks of a clip by the library's own score and after its first hits were ranked
again by MaxSim, alone and in the mean with that score.
"""

from __future__ import annotations

import argparse
import tempfile
import time
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

import motionseek
from encoders.bundle.bundle import Bundle
from encoders.bundle.windows import window_starts
from encoders.corpus.composition.scene_clips import make_clip
from encoders.corpus.composition.seeds import TEST
from encoders.corpus.language.caption_generation import describe
from encoders.corpus.language.random_scenes import random_scene
from encoders.motion import Motion
from search.query.steps import split
from search.ranking.clip_scores import rank_clips
from search.ranking.late_interaction import FIRST_HITS, rerank_by_tokens


class WindowTokens(Bundle):
    """The shipped model with windows as parts and steps as words."""

    def motion_tokens(self, features: Sequence[NDArray[np.float32]]) -> list[NDArray[np.float32]]:
        size = round(1.6 * self.fps)
        grids = [window_starts(len(rows), size, size // 4) for rows in features]
        pieces = [rows[start : start + size] for rows, starts in zip(features, grids, strict=True) for start in starts]
        ends = np.cumsum([len(starts) for starts in grids])[:-1]
        return np.split(self.encode_features(pieces), ends)

    def text_tokens(self, sentences: Sequence[str]) -> list[NDArray[np.float32]]:
        return [self.encode_texts(split(sentence)) for sentence in sentences]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--clips", type=int, default=600)
    count = parser.parse_args().clips
    rng = np.random.default_rng(TEST)
    scenes = [random_scene(rng) for _ in range(count)]
    captions = [describe(scene, rng).text for scene in scenes]
    motions = [Motion(make_clip(scene, rng).joints) for scene in scenes]
    model = WindowTokens.load()
    ranks: dict[str, list[int]] = {"cosine": [], "MaxSim": [], "their mean": []}
    seconds = []
    with (
        tempfile.TemporaryDirectory() as folder,
        motionseek.open(folder, create=True, bundle=model) as library,
    ):
        ids = library.add_many(motionseek.NewClip(f"{i}", motion) for i, motion in enumerate(motions))
        for own, sentence in zip(ids, captions, strict=True):
            if len(split(sentence)) == 1:
                continue
            vector = model.encode_texts([sentence])[0]
            found = [score for score, _ in zip(rank_clips(library, vector), range(FIRST_HITS), strict=False)]
            began = time.perf_counter()
            again = list(rerank_by_tokens(model, library, sentence, iter(found)))
            seconds.append(time.perf_counter() - began)
            cosines = {score.clip_id: score.score for score in found}
            mean = sorted(again, key=lambda score: -(score.score + cosines[score.clip_id]))
            for name, order in zip(ranks, (found, again, mean), strict=True):
                places = [score.clip_id for score in order]
                ranks[name].append(places.index(own) + 1 if own in places else count)
    print(f"{len(seconds)} sentences of several steps, {count} clips, {np.median(seconds):.2f} s to rank again")
    for name, row in ranks.items():
        recalls = "  ".join(f"R@{k} {100 * np.mean(np.array(row) <= k):5.1f}" for k in (1, 3, 5, 10))
        print(f"{name:12} {recalls}  MedR {np.median(row):g}")


if __name__ == "__main__":
    main()
