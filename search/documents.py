"""Answers as plain data with stable keys and rounded numbers: what the command line and the server write as JSON."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from search.query.languages import understood_language_of
from search.query.negation import parts_of
from search.query.question import Question
from search.ranking.description import Description

#: Times (T,) in seconds and the similarity (S, T) of each sentence.
Curve = tuple[NDArray[np.float64], NDArray[np.float32]]


def search_document(query: str, sentences: Sequence[str], hits: Sequence[dict[str, Any]]) -> dict[str, Any]:
    """The hits of a question; `language` is that of its sentences where they are understood as not English, else None.

    `without` is there where the sentences take something away, and has it.

    Parameters
    ----------
    query : str
        The question as it was asked.
    hits : sequence of dict
        See `search.hits.Hit.document`.
    """
    language = next(filter(None, map(understood_language_of, sentences)), None)
    without = [text for sentence in sentences for text in parts_of(sentence).unwanted]
    return {"query": query, "language": language, **({"without": without} if without else {}), "hits": list(hits)}


def moments_document(question: Question, hits: Sequence[dict[str, Any]], curve: Curve | None = None) -> dict[str, Any]:
    """The moments of a question, with the curve of the motion where they are of one.

    Parameters
    ----------
    hits : sequence of dict
        See `search.hits.Hit.document`.
    """
    content = search_document(str(question), question.sentences, hits)
    if question.how != "alone":
        content |= {"how": question.how, "sentences": list(question.sentences)}
    if curve is not None:
        content["curve"] = curve_document(question.sentences, curve)
    return content


def curve_document(sentences: Sequence[str], curve: Curve) -> dict[str, Any]:
    """Similarity over time, by sentence."""
    times, similarity = curve
    rounded = similarity.astype(float).round(4).tolist()
    return {"times": times.round(3).tolist(), "similarity": dict(zip(sentences, rounded, strict=True))}


def description_document(path: str, sentences: Sequence[Description]) -> dict[str, Any]:
    """The sentences that match a motion, with their scores and strengths.

    Where they are of one motion that was asked for, the command line and the server add `stale`, as a hit has it.
    """
    listed = [{"text": s.text, "score": round(s.score, 4), "strength": s.strength} for s in sentences]
    return {"path": path, "sentences": listed}
