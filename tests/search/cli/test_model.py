"""`motionseek model`: what it shows, and when it writes no card."""

from __future__ import annotations

from pathlib import Path

import pytest

from encoders.bundle.bundle import Bundle
from tests.search.conftest import Run


def test_info_shows_the_manifest(run: Run, tiny_bundle: Path) -> None:
    document = run("model", "info", "--json").document
    assert document["fingerprint"] == Bundle.load(tiny_bundle).fingerprint
    assert (document["name"], document["licence"], document["calibrated"]) == ("tiny", "MIT", False)


@pytest.mark.parametrize("alone", ["--real", "--captions"])
def test_real_takes_and_their_captions_are_given_together(run: Run, tmp_path: Path, alone: str) -> None:
    (tmp_path / "captions.jsonl").touch()
    ran = run("model", "card", tmp_path / "x.md", alone, tmp_path / ("" if alone == "--real" else "captions.jsonl"))
    assert (ran.code, ran.out) == (2, "")
    assert "given together" in ran.err
    assert not (tmp_path / "x.md").exists()


def test_no_card_is_overwritten(run: Run, tmp_path: Path) -> None:
    (tmp_path / "x.md").write_text("mine", encoding="utf-8")
    ran = run("model", "card", tmp_path / "x.md")
    assert (ran.code, ran.err.count("\n")) == (1, 1)
    assert "--force" in ran.err
    assert (tmp_path / "x.md").read_text(encoding="utf-8") == "mine"
