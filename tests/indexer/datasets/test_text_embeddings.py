"""Embeddings of sentences that lie beside a data set."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from encoders.errors import DatasetError
from indexer.datasets.text_embeddings import StoredSentences, StoredTokens
from tests.indexer.datasets.toy_dataset import write_embeddings

SENTENCES = ["walks", "jumps", "a man sits down"]
TOKENS = "token_embeddings/distilbert-base-uncased"
VECTORS = "sent_embeddings/sentence-transformers/all-mpnet-base-v2"


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    write_embeddings(tmp_path, SENTENCES)
    return tmp_path


def test_rows_of_sentences(folder: Path) -> None:
    tokens, sentences = StoredTokens.open(folder), StoredSentences.open(folder)
    assert tokens is not None
    assert sentences is not None
    assert (tokens.name, tokens.width) == ("distilbert-base-uncased", 8)
    assert sentences.name == "sentence-transformers/all-mpnet-base-v2"
    features, slices = np.load(folder / f"{TOKENS}.npy"), np.load(folder / f"{TOKENS}_slice.npy")
    np.testing.assert_array_equal(tokens.rows(["jumps"])[0], features[slice(*slices[1])])
    np.testing.assert_array_equal(sentences.rows(["jumps", "walks"]), np.load(folder / f"{VECTORS}.npy")[[1, 0]])
    assert tokens.has(SENTENCES)
    assert not sentences.has(["hops"])


def test_what_is_not_there_is_none(tmp_path: Path, folder: Path) -> None:
    assert StoredTokens.open(tmp_path / "nowhere") is None
    assert StoredTokens.open(folder, "bert-large") is None


@pytest.mark.parametrize(
    ("name", "content", "reason"),
    [
        (f"{TOKENS}_slice", np.array([[0, 9], [2, 4], [4, 6]]) * 100, "rows that are not there"),
        (f"{TOKENS}_slice", np.array([[0, 2], [4, 4], [4, 6]]), "rows that are not there"),
        (f"{TOKENS}_slice", np.array([[0, 2]]), "one of 1 rows"),
        (TOKENS, np.array([{}], dtype=object), "no embeddings that can be read"),
        (VECTORS, np.full((3, 16), 2.0), "not of unit length"),
        (VECTORS, np.full((3, 16), np.nan), "not of unit length"),
    ],
)
def test_embeddings_that_contradict_each_other_are_refused(
    folder: Path, name: str, content: np.ndarray, reason: str
) -> None:
    np.save(folder / f"{name}.npy", content)
    with pytest.raises(DatasetError, match=reason):
        (StoredSentences if name == VECTORS else StoredTokens).open(folder)


def test_of_several_unknown_models_one_must_be_named(folder: Path) -> None:
    for old, new in ((TOKENS, "a"), (f"{TOKENS}_slice", "a_slice")):
        (folder / f"{old}.npy").rename(folder / f"token_embeddings/{new}.npy")
    (folder / f"{TOKENS}_index.json").rename(folder / "token_embeddings/a_index.json")
    (folder / "token_embeddings/b_index.json").write_text(json.dumps({}), "utf-8")
    with pytest.raises(DatasetError, match="several models; name one: a, b"):
        StoredTokens.open(folder)
    assert StoredTokens.open(folder, "a") is not None
