"""Retrieval on a split of a captioned data set: the first caption of every motion against every motion."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from itertools import islice
from typing import Any

import numpy as np
from numpy.typing import NDArray

from encoders.errors import BundleError
from encoders.protocol import Encoder
from indexer.datasets.captioned_dataset import CaptionedDataset
from indexer.datasets.timed_captions import CaptionedEntry, read_keys
from search.evaluate.retrieval.dissimilar_subset import dissimilar_subset
from search.evaluate.retrieval.protocols import RetrievalRow, evaluate_protocols

Vectors = NDArray[np.float32]

#: Clips whose features are held at once.
_CLIPS = 256


@dataclass(frozen=True)
class EvaluatedModel:
    """What is evaluated: a name, and two functions that give unit vectors (N, D) of clips' features and of captions."""

    name: str
    encode_clips: Callable[[list[Vectors]], Vectors]
    encode_captions: Callable[[list[str]], Vectors]

    @classmethod
    def of_encoder(cls, encoder: Encoder) -> EvaluatedModel:
        """An encoder as it is: captions without paraphrases; clips of any length as a whole, as published TMR."""
        return cls(encoder.name, lambda clips: _as_a_whole(encoder, clips), encoder.encode_texts)


@dataclass(frozen=True)
class SentenceSimilarity:
    """A model of sentence similarity: its name, and unit vectors (N, E) of sentences."""

    name: str
    embed: Callable[[list[str]], Vectors]


@dataclass(frozen=True)
class RetrievalReport:
    """All figures of a model on a split.

    Attributes
    ----------
    sentence_model : str
        Whose sentence similarities the threshold and the selected subset rest on; empty where there was none.
    subset : str
        Where the dissimilar subset comes from; empty where there is none.
    """

    model: str
    dataset: str
    split: str
    sentence_model: str
    subset: str
    rows: tuple[RetrievalRow, ...]

    def as_dict(self) -> dict[str, Any]:
        """For JSON."""
        return {
            "model": self.model,
            "dataset": self.dataset,
            "split": self.split,
            "sentence_similarity": self.sentence_model or None,
            "dissimilar_subset": self.subset or None,
            "protocols": [
                {"protocol": row.protocol, "footing": row.footing, "gallery": row.gallery, **row.figures}
                for row in self.rows
            ],
        }


def evaluate_dataset(
    dataset: CaptionedDataset,
    split: str,
    model: EvaluatedModel,
    sentences: SentenceSimilarity | None,
    *,
    progress: Callable[[int, int], None] | None = None,
) -> RetrievalReport:
    """All protocols on one split; without a sentence model, only those that need none.

    Parameters
    ----------
    progress : callable, optional
        Called with the number of clips encoded and that of all.

    Raises
    ------
    DatasetError
        If the split or a motion of it cannot be used; the subclasses name the cause.
    BundleError
        If the model gives vectors that are not finite.
    """
    entries = dataset.split(split)
    dataset.motions.check_rate(entries)
    captions = [entry.captions[0].text for entry in entries]
    distinct = list(dict.fromkeys(captions))
    row_of = {text: row for row, text in enumerate(distinct)}
    rows = np.array([row_of[text] for text in captions])
    gallery = np.concatenate(list(_encoded(dataset, entries, model, progress)))
    # Equal captions have equal similarities, to the last bit: each caption's row is computed once.
    similarity = (model.encode_captions(distinct) @ gallery.T)[rows]
    if not np.isfinite(similarity).all():
        raise BundleError(f"{model.name}: gives vectors that are not finite on {dataset.name}")
    embedded = None if sentences is None else sentences.embed(distinct)
    keys = [entry.key for entry in entries]
    subset, source = _subset(dataset, split, keys, captions, None if embedded is None else embedded[rows], sentences)
    figures = evaluate_protocols(
        similarity,
        captions,
        sentence_similarity=None if embedded is None else (embedded @ embedded.T)[np.ix_(rows, rows)],
        subset=subset,
        batched=np.argsort(keys, kind="stable").tolist(),
    )
    name = "" if sentences is None else sentences.name
    return RetrievalReport(model.name, dataset.name, split, name, source, tuple(figures))


def _encoded(
    dataset: CaptionedDataset,
    entries: Sequence[CaptionedEntry],
    model: EvaluatedModel,
    progress: Callable[[int, int], None] | None,
) -> Iterator[Vectors]:
    clips = (dataset.motions.clip(entry, entry.captions[0]) for entry in entries)
    done = 0
    while some := list(islice(clips, _CLIPS)):
        yield model.encode_clips(some)
        done += len(some)
        if progress is not None:
            progress(done, len(entries))


def _subset(
    dataset: CaptionedDataset,
    split: str,
    keys: Sequence[str],
    captions: Sequence[str],
    embedded: Vectors | None,
    sentences: SentenceSimilarity | None,
) -> tuple[NDArray[np.int64] | None, str]:
    """The dissimilar subset, and where it comes from."""
    published = f"nsim_{split}"
    if dataset.has_split(published):
        place = {key: i for i, key in enumerate(keys)}
        listed = read_keys(dataset.folder, published)
        found = np.array([place[key] for key in listed if key in place], np.int64)
        if len(found) > 1:
            return found, f"published list {published}"
    if embedded is None or sentences is None:
        return None, ""
    chosen = dissimilar_subset(embedded, captions)
    return (chosen, f"selected by {sentences.name}") if len(chosen) > 1 else (None, "")


def _as_a_whole(encoder: Encoder, clips: list[Vectors]) -> Vectors:
    """Unit vectors (N, D), where the encoder would take a longer clip apart, too."""
    vectors = encoder.encode_features([clip[: encoder.max_frames] for clip in clips])
    for row, clip in enumerate(clips):
        if len(clip) > encoder.max_frames:
            vectors[row] = encoder.encode_windows(clip, np.zeros(1, np.int64), len(clip))[0]
    return vectors
