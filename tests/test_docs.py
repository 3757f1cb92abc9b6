"""The documents: every code block runs, and what they point at exists."""

from __future__ import annotations

import json
import re
from collections import defaultdict
from functools import cache
from pathlib import Path

import pytest

from tests.conftest import ROOT
from tests.documents import LANGUAGES, PAGES, blocks, run_page

DOCS = [page for page in PAGES if page.parent.name == "docs"]
PRESENT = [page for page in PAGES if page.stem != "CHANGELOG"]
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
    outside = re.sub(r"```.*?```", "", text, flags=re.DOTALL)
    assert re.findall(r"\n\n    (?![*\s]).*", outside) == [], "an indented block has no language"


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


@pytest.mark.parametrize("page", PRESENT, ids=lambda page: page.stem)
def test_names_that_are_written_as_code_exist(page: Path) -> None:
    """Identifiers with an underscore or inner capitals, and what stands after the dot of a module's name."""
    text = page.read_text(encoding="utf-8")
    code = "\n".join(re.findall(r"`([^`\n]+)`", text) + [b.text for b in blocks(page) if b.language == "text"])
    identifiers = set(re.findall(r"\b[a-z]+_\w+|\b[A-Z][a-z]+[A-Z]\w*", code))
    assert identifiers - words_of_sources() == set()
    qualified = [names for names in re.findall(r"\b([a-z_]\w+)\.(\w+)\(", code) if names[0] in words_of_modules()]
    assert [f"{module}.{name}" for module, name in qualified if name not in words_of_modules()[module]] == []


@cache
def words_of_modules() -> dict[str, set[str]]:
    """The words in modules of each name."""
    words = defaultdict(set)
    for path in python_files():
        words[path.stem].update(re.findall(r"\w+", path.read_text("utf-8")))
    return dict(words)


def test_the_design_lists_every_room() -> None:
    text = (ROOT / "docs" / "design.md").read_text(encoding="utf-8")
    paths = [path for package in ("encoders", "indexer", "search") for path in (ROOT / package).glob("[!_]*")]
    rooms = [path for path in paths if path.suffix == ".py" or (path / "__init__.py").exists()]
    assert [room for room in (str(path.relative_to(ROOT)) for path in rooms) if f"`{room}`" not in text] == []


@cache
def python_files() -> list[Path]:
    return [path for room in ("encoders", "indexer", "search", "benchmarks") for path in (ROOT / room).rglob("*.py")]


@cache
def words_of_sources() -> set[str]:
    others = [*(ROOT / "tests").rglob("conftest.py"), *(ROOT / "encoders").rglob("*.json"), ROOT / "motionseek.py"]
    files = [*(ROOT / "search" / "page").glob("*.js"), *others]
    stems = {path.stem for folder in ("tests", "search/demo_data") for path in (ROOT / folder).rglob("*.*")}
    words = {word for path in files for word in re.findall(r"\w+", path.read_text("utf-8"))}
    return words.union(stems, words_of_modules(), *words_of_modules().values())
