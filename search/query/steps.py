"""Several things asked of one take: one after the other, or at the same time."""

from __future__ import annotations

import re

import numpy as np
from numpy.typing import NDArray

#: What each second between two steps costs, in cosine, and what a gap costs at most: steps follow one another closely,
#: but a person may sit for long before standing up.
GAP_COST, LARGEST_GAP_COST = 0.08, 0.25

_ORDER = re.compile(
    r"\s*[,;.]?\s*\b(?:and\s+)?(?:then|after\s+that|afterwards?|next|finally|followed\s+by)\b\s*,?\s*(?:and\s+)?"
    r"|\s*[,;]?\s*\bbefore\s+(?=\w+ing\b)"
    r"|\s*;\s*",
    re.IGNORECASE,
)
_AFTER = re.compile(r"^\s*after\s+(?P<first>\w+ing\b[^,]*),\s*(?P<second>.+)$", re.IGNORECASE)
#: Words in -s that are no verbs: "slowly, as on ice", "walks, arms out".
_NO_VERBS = (
    "as|is|was|his|its|this|always|sometimes|perhaps|across|towards|[a-z]+wards|[a-z]+ways|hands|arms|legs|feet|knees|"
    "elbows|shoulders|hips|fists|eyes|times"
)
_LISTED = re.compile(rf"\s*,\s*(?:and\s+)?(?!(?:{_NO_VERBS})\b)(?=(?:\w+s|\w+ing)\b)", re.IGNORECASE)
_SUBJECT = re.compile(
    r"^\s*(?P<subject>(?:(?:a|an|the|one|this)\s+)?(?:\w+\s+)?(?:person|man|woman|figure|someone|somebody|human|guy|girl|boy|"
    r"character|actor|individual|he|she|they))\b\s+",
    re.IGNORECASE,
)
#: What links a subject to a step that begins so.
_LINKS = ((re.compile(r"\w+ing\b", re.IGNORECASE), "is "), (re.compile(r"(?:an?|the)\b", re.IGNORECASE), "does "))


def split(sentence: str) -> list[str]:
    """A sentence's steps in the order they happen: "walks, then sits" -> ["walks", "sits"]; one step where it has none.

    Words of order divide it ("then", "after that", "followed by", "before ...ing", "after ...ing,", a semicolon), and
    once one is there, commas before a verb do too. The subject of the first step is given to those without one.
    """
    after = _AFTER.match(sentence)
    parts = [after["first"], *_ORDER.split(after["second"])] if after else _ORDER.split(sentence)
    if len(parts) > 1:
        parts = [step for part in parts for step in _LISTED.split(part)]
    steps = [part.strip(" \t\n,;.") for part in parts]
    steps = [step for step in steps if any(character.isalnum() for character in step)]
    subject = next((found["subject"] for found in map(_SUBJECT.match, steps) if found), "")
    return [_with_subject(step, subject) for step in steps] or [sentence]


def _with_subject(step: str, subject: str) -> str:
    if not subject or _SUBJECT.match(step):
        return step
    link = next((link for pattern, link in _LINKS if pattern.match(step)), "")
    return f"{subject} {link}{step}"


def in_order(
    starts: NDArray[np.float64], ends: NDArray[np.float64], scores: NDArray[np.floating]
) -> tuple[NDArray[np.int64], float] | None:
    """The best chain of windows, one a step, each beginning when the one before has ended or later.

    Dynamic programming over windows sorted by end: the best chain up to each window is its own score and the best of
    all chains that end before it begins, less the cost of the gap between.

    Parameters
    ----------
    starts, ends : float64 arrays (N,)
        Candidate windows in seconds.
    scores : array (S, N)
        The score of each window for each step.

    Returns
    -------
    indices : int64 array (S,)
        The window of each step.
    value : float
        The chain's summed scores less its gaps; None instead of both where no chain fits.
    """
    order = np.argsort(ends, kind="stable")
    starts, ends = starts[order], ends[order]
    scores = np.asarray(scores, np.float64)[:, order]
    before = np.searchsorted(ends, starts + 1e-6, side="right") - 1  # the last window that ends before each begins
    value, links = scores[0], []
    for step in scores[1:]:
        near, near_link = _best_before(value + GAP_COST * ends, before)
        far, far_link = _best_before(value - LARGEST_GAP_COST, before)
        near -= GAP_COST * starts
        links.append(np.where(near >= far, near_link, far_link))
        value = step + np.maximum(near, far)
    at = int(np.argmax(value))
    if not np.isfinite(value[at]):
        return None
    total, chain = float(value[at]), [at]
    for link in reversed(links):
        chain.append(int(link[chain[-1]]))
    return order[np.array(chain[::-1])].astype(np.int64), total


def _best_before(
    value: NDArray[np.float64], before: NDArray[np.int64]
) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """The highest of the values up to each index in `before`, and its place; minus infinity before the first."""
    best = np.maximum.accumulate(value)
    leader = np.maximum.accumulate(np.where(value >= best, np.arange(len(value)), 0))
    return np.where(before >= 0, best[before], -np.inf), np.where(before >= 0, leader[before], -1)
