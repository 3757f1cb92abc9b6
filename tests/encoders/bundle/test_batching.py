"""Sequences of mixed lengths in batches."""

from __future__ import annotations

import numpy as np

from encoders.bundle.batching import length_buckets, pad


def test_buckets_hold_every_item_once_within_the_budget_with_little_padding():
    lengths = np.random.default_rng(0).integers(1, 200, 1000).tolist()
    batches = list(length_buckets(lengths, 2000))
    assert sorted(np.concatenate(batches)) == list(range(1000))
    sizes = [[lengths[i] for i in batch] for batch in batches]
    assert all(max(batch) * len(batch) <= 2000 for batch in sizes)
    assert all(max(batch) * len(batch) <= 1.15 * sum(batch) for batch in sizes)
    assert [batch.tolist() for batch in length_buckets([10], 5)] == [[0]]
    assert list(length_buckets([], 5)) == []


def test_padding_is_zeros_at_the_end():
    padded, lengths = pad([np.ones((2, 3), np.float32), np.ones((4, 3), np.float32)])
    assert padded.shape == (2, 4, 3)
    assert padded.sum(axis=(1, 2)).tolist() == [6, 12]
    assert lengths.tolist() == [2, 4]
