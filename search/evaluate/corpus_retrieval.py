"""Retrieval on made motions nobody trained on: whole gallery, batches of 32, and sentences with one thing changed."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from encoders.corpus.composition.facts import facts
from encoders.corpus.composition.synthetic_pairs import SyntheticClip, relevance
from encoders.corpus.heldout.queries import paraphrase_queries
from encoders.metrics import in_batches, ranks, recalls, text_motion
from encoders.protocol import Encoder

_BATCH = 32


def evaluate_corpus(clips: Iterable[SyntheticClip], bundle: Encoder) -> dict[str, dict[str, float]]:
    """Figures of the first caption of every clip against all clips.

    Returns
    -------
    dict
        "same sentence": clips with the same sentence count as right; "true of it": every clip of which the sentence
        is known to be true counts; "words never met": sentences in which no caption puts it, about actions that
        the clips show, true of every clip that shows the action; "batches of 32"; "swapped": percent of clips whose
        true caption scores above a false one that differs in order, side, direction or count. What there are too few
        clips for is left out.
    """
    clips = list(clips)
    gallery = bundle.encode_features([clip.features[: bundle.max_frames] for clip in clips])
    sentences = [clip.captions[0] for clip in clips]
    similarity = bundle.encode_texts(sentences) @ gallery.T
    same = np.array(sentences)[:, None] == np.array(sentences)[None, :]
    true = relevance(clips) | same
    both = text_motion(similarity, same)
    figures = {
        "same sentence, text -> motion": both["text->motion"],
        "same sentence, motion -> text": both["motion->text"],
        "true of it, text -> motion": recalls(ranks(similarity, true)),
    }
    shown = [facts(clip.scene) for clip in clips]
    asked = [
        (text, action)
        for action, texts in paraphrase_queries().items()
        if any(action in f for f in shown)
        for text in texts
    ]
    if asked:
        right = np.array([[action in found for found in shown] for _, action in asked])
        never_met = bundle.encode_texts([text for text, _ in asked]) @ gallery.T
        figures["words never met, text -> motion"] = recalls(ranks(never_met, right))
    if len(clips) >= _BATCH:
        figures[f"batches of {_BATCH}, text -> motion"] = in_batches(similarity, _BATCH)["text->motion"]
    changed = [i for i, clip in enumerate(clips) if clip.hard_negatives and clip.hard_negatives[0]]
    if changed:
        false = np.einsum(
            "nd,nd->n", bundle.encode_texts([clips[i].hard_negatives[0] for i in changed]), gallery[changed]
        )
        told = np.diagonal(similarity)[changed] > false
        figures["swapped"] = {"told apart": 100 * float(told.mean()), "pairs": float(len(changed))}
    return figures
