"""However a sentence in words that nobody uses of motion is asked, its hits are called a degree less."""

from __future__ import annotations

import numpy as np
import pytest

pytest.importorskip("fastapi")
pytest.importorskip("httpx")

from starlette.testclient import TestClient

from encoders.bundle.bundle import Bundle
from search.query.known_words import lexicon
from search.server.app import create_app
from search.server.snapshot_library import SnapshotLibrary


@pytest.fixture
def library(indexed, tiny_bundle):
    """The indexed takes, under a model that is sure of every hit."""
    bundle = Bundle.load(tiny_bundle, threads=1)
    sure = np.array([99.0, 0.0, 0.0])
    bundle.__dict__["calibration"] = {
        "motions": np.eye(bundle.latent_size, dtype=np.float32),
        "words": lexicon(["a person walks"]),
        "sentence_coefficients": sure,
        "motion_coefficients": sure,
    }
    return SnapshotLibrary.open(indexed, bundle=bundle)


@pytest.mark.parametrize(("sentence", "strength"), [("a person walks", "strong"), ("invoice for March", "plausible")])
def test_the_server_and_the_library_say_the_same(library, sentence, strength):
    ways = [library.search(sentence, 3), library.moments(sentence, k=3), library.moments(sentence, "#1", k=3)]
    with TestClient(create_app(library), base_url="http://127.0.0.1:8420") as client:
        for url in ("/api/search?k=3", "/api/moments?k=3", "/api/moments?k=3&clip=1"):
            ways.append(client.get(f"{url}&q={sentence}").json()["hits"])
        alike = client.get("/api/similar?clip=1").json()["hits"]
    said = [hit["strength"] if isinstance(hit, dict) else hit.strength for hits in ways for hit in hits]
    assert set(said) == {strength}
    assert {hit["strength"] for hit in alike} == {"strong"}, "a motion is in no words"
