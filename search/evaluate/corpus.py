"""Retrieval on made motions nobody trained on: whole gallery, batches of 32, and sentences with one thing changed."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from encoders.bundle import Bundle
from encoders.corpus.made import Made, true_of
from encoders.metrics import in_batches, ranks, recalls, text_motion


def evaluate_corpus(clips: Iterable[Made], bundle: Bundle) -> dict[str, dict[str, float]]:
    """Figures of the first caption of every clip against all clips.

    Returns
    -------
    dict
        "same sentence": clips with the same sentence count as right; "true of it": every clip of which the sentence
        is known to be true counts; "batches of 32"; "swapped": percent of clips whose true caption scores above a
        false one that differs in order, side, direction or count.
    """
    clips = list(clips)
    gallery = bundle.encode_features([clip.features[: bundle.max_frames] for clip in clips])
    sentences = [clip.captions[0] for clip in clips]
    similarity = bundle.encode_texts(sentences) @ gallery.T
    same = np.array(sentences)[:, None] == np.array(sentences)[None, :]
    true = true_of(clips) | same
    rows = [i for i, clip in enumerate(clips) if clip.swapped]
    false = np.einsum("nd,nd->n", bundle.encode_texts([clips[i].swapped[0] for i in rows]), gallery[rows])
    both = text_motion(similarity, same)
    return {
        "same sentence, text -> motion": both["text->motion"],
        "same sentence, motion -> text": both["motion->text"],
        "true of it, text -> motion": recalls(ranks(similarity, true)),
        "batches of 32, text -> motion": in_batches(similarity)["text->motion"],
        "swapped": {
            "told apart": 100 * float(np.mean(np.diagonal(similarity)[rows] > false)),
            "pairs": float(len(rows)),
        },
    }
