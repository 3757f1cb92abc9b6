"""Retrieval among synthetic clips: the whole gallery, batches of 32, held-out paraphrases and hard negatives."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np
from numpy.typing import NDArray

from encoders.corpus.composition.facts import facts
from encoders.corpus.composition.synthetic_pairs import SyntheticClip, relevance
from encoders.corpus.heldout.queries import paraphrase_queries
from encoders.metrics import in_batches, ranks, recalls, text_motion
from encoders.protocol import Encoder

_BATCH = 32


def evaluate_corpus(clips: Iterable[SyntheticClip], encoder: Encoder) -> dict[str, dict[str, float]]:
    """Retrieval figures, with the first caption of every clip as query.

    Returns
    -------
    dict
        "same sentence": clips with the same caption are right; "relevant clips": those of which the caption is known
        to be true; "held-out paraphrases": sentences in words that no caption has, about actions of the clips, for
        which every clip that shows the action is right; "batches of 32"; "hard negatives": percent of clips that score
        higher with their caption than with one that differs in order, side, direction or count. Figures that need
        more clips are left out.
    """
    clips = list(clips)
    gallery = encoder.encode_features([clip.features[: encoder.max_frames] for clip in clips])
    sentences = [clip.captions[0] for clip in clips]
    similarity = encoder.encode_texts(sentences) @ gallery.T
    same = np.array(sentences)[:, None] == np.array(sentences)[None, :]
    both = text_motion(similarity, same)
    figures = {
        "same sentence, text -> motion": both["text->motion"],
        "same sentence, motion -> text": both["motion->text"],
        "relevant clips, text -> motion": recalls(ranks(similarity, relevance(clips) | same)),
    }
    figures |= _heldout_paraphrases(clips, gallery, encoder)
    if len(clips) >= _BATCH:
        figures[f"batches of {_BATCH}, text -> motion"] = in_batches(similarity, _BATCH)["text->motion"]
    return figures | _hard_negatives(clips, np.diagonal(similarity), gallery, encoder)


def _heldout_paraphrases(
    clips: Sequence[SyntheticClip], gallery: NDArray[np.float32], encoder: Encoder
) -> dict[str, dict[str, float]]:
    """Recalls of the held-out sentences about actions that the clips show."""
    shown = [facts(clip.scene) for clip in clips]
    queries = [
        (text, action)
        for action, texts in paraphrase_queries().items()
        if any(action in f for f in shown)
        for text in texts
    ]
    if not queries:
        return {}
    right = np.array([[action in found for found in shown] for _, action in queries])
    similarity = encoder.encode_texts([text for text, _ in queries]) @ gallery.T
    return {"held-out paraphrases, text -> motion": recalls(ranks(similarity, right))}


def _hard_negatives(
    clips: Sequence[SyntheticClip], own: NDArray[np.float32], gallery: NDArray[np.float32], encoder: Encoder
) -> dict[str, dict[str, float]]:
    """Accuracy between a clip's caption, whose similarities (N,) are `own`, and its hard negative."""
    with_negative = [i for i, clip in enumerate(clips) if clip.hard_negatives and clip.hard_negatives[0]]
    if not with_negative:
        return {}
    negatives = encoder.encode_texts([clips[i].hard_negatives[0] for i in with_negative])
    right = own[with_negative] > np.einsum("nd,nd->n", negatives, gallery[with_negative])
    return {"hard negatives": {"accuracy": 100 * float(right.mean()), "pairs": float(len(with_negative))}}
