"""The documents: every code block runs, and what they point at exists."""

from __future__ import annotations

import json
import re
from pathlib import Path

import pytest

from tests.conftest import ROOT
from tests.documents import LANGUAGES, PAGES, blocks, run_page

DOCS = [page for page in PAGES if page.parent.name == "docs"]
SOURCES = r"(?:encoders|indexer|search|tests|benchmarks|docs)/[\w./*-]*\w|motionseek\w*\.py"

each_page = pytest.mark.parametrize("page", PAGES, ids=lambda page: page.stem)


@pytest.mark.slow
@pytest.mark.parametrize("page", DOCS, ids=lambda page: page.stem)
def test_every_code_block_runs(page: Path, documented: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    run_page(page, documented, monkeypatch)


@each_page
def test_every_code_block_says_its_language(page: Path) -> None:
    text = page.read_text(encoding="utf-8")
    assert text.count("```") == 2 * len(blocks(page))
    assert {block.language for block in blocks(page)} <= LANGUAGES
    assert re.findall(r"\n\n    (?![*\s]).*", text) == [], "an indented block has no language"


@each_page
def test_json_can_be_read(page: Path) -> None:
    for block in blocks(page):
        if block.language == "json":
            json.loads(block.text)


@each_page
def test_links_lead_to_files(page: Path) -> None:
    targets = re.findall(r"\]\((?!\w+:)([^)#]+)", page.read_text(encoding="utf-8"))
    assert [target for target in targets if not (page.parent / target).exists()] == []


@each_page
def test_sources_that_are_named_exist(page: Path) -> None:
    named = re.findall(rf"`({SOURCES})", page.read_text(encoding="utf-8"))
    assert [path for path in named if not list(ROOT.glob(path))] == []
