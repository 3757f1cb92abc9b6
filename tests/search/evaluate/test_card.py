"""The model card: one page with a table of every protocol, worded as docs/model.md is."""

from __future__ import annotations

import json
import re
from pathlib import Path

import numpy as np
import pytest

from encoders.bundle.bundle import Bundle
from search.evaluate.card import model_card
from tests.conftest import ROOT
from tests.search.conftest import made_motion

LABELS = {"walk": "a person walks", "jump": "a person jumps"}


@pytest.fixture(scope="module")
def card(tiny_bundle: Path, tmp_path_factory: pytest.TempPathFactory) -> str:
    folder = tmp_path_factory.mktemp("archive")
    np.save(folder / "a.npy", made_motion(4.0, 0).joints)
    np.save(folder / "b.npy", made_motion(4.0, 1).joints)
    rows = [
        "path\ttrial\tkind\tsplit\tuse\tfps_in_file\tfps_true\tdescription",
        "a.npy\t1\ttake\tval\tval\t20\t\twalks",
        "b.npy\t2\ttake\tval\tval\t20\t\tjumps",
    ]
    (folder / "manifest.tsv").write_text("\n".join(rows), encoding="utf-8")
    line = {"trial": "1", "start_frame": 0, "end_frame": -1, "fps": 20, "split": "val", "captions": ["a man strolls"]}
    (folder / "captions.jsonl").write_text(json.dumps(line), encoding="utf-8")
    (folder / "labels.tsv").write_text("path\tlabel\na.npy\twalk\nb.npy\tjump\n", encoding="utf-8")
    queries = "".join(f"{label}\t{text}\n" for label, text in LABELS.items())
    (folder / "queries.tsv").write_text(f"label\tquery\n{queries}", encoding="utf-8")
    bundle = Bundle.load(tiny_bundle)
    background = np.eye(1, bundle.latent_size, dtype=np.float32)
    bundle.calibration = {"motions": background, "sentence_coefficients": np.array([-5.0, 10.0, 0.0])}
    return model_card(bundle, real=folder, captions=folder / "captions.jsonl", labelled=folder, count=64)


def wording(page: str) -> list[str]:
    """A card's headings, sentences up to their figures, and names of figures."""
    lines = [line.split("|")[1] if line.startswith("|") else line for line in page.splitlines()]
    return [re.split(r"\d|:", line.replace("**", "").strip())[0] for line in lines]


def test_it_is_worded_as_the_committed_one(card: str) -> None:
    """A label that changes in the code changes in docs/model.md too."""
    committed = wording((ROOT / "docs" / "model.md").read_text(encoding="utf-8"))
    assert [line for line in wording(card) if line not in committed and line not in LABELS] == []


def test_the_committed_one_describes_the_shipped_bundle() -> None:
    committed = (ROOT / "docs" / "model.md").read_text(encoding="utf-8")
    bundle = Bundle.load()
    assert f"| fingerprint | `{bundle.fingerprint[:16]}` |" in committed
    assert [value for value in bundle.manifest["training"].values() if str(value) not in committed] == []


def test_it_names_the_bundle_it_measured(card: str, tiny_bundle: Path) -> None:
    bundle = Bundle.load(tiny_bundle)
    assert f"| name | {bundle.name} |" in card
    assert f"| fingerprint | `{bundle.fingerprint[:16]}` |" in card


def test_it_holds_the_figures_of_every_protocol(card: str) -> None:
    assert "## 64 synthetic clips held out of training" in card
    assert "## 2 real takes of the validation split" in card
    assert "| walk | 1 | " in card
    assert re.search(r"Out-of-domain sentences \(\d+\) called strong: \d+ %", card)
