"""What a new user does with the demo, by what can be seen: five clips are found, starred, compared and downloaded."""

from __future__ import annotations

import io
import shutil
import zipfile
from pathlib import Path

import pytest

from encoders.bundle.bundle import Bundle
from indexer.ingest import indexing
from search.cli.commands.demo import DATA
from search.library import Library
from tests.search.page.browser import seen, state, until
from tests.search.page.conftest import serving

pytestmark = pytest.mark.slow

#: What is typed, and how many of the hits are taken.
_WANTED = {"a person kicks a ball": 2, "climbs up a ladder": 1, "running and then jumping": 1, "sits down": 1}


@pytest.fixture(scope="module")
def demo(tmp_path_factory):
    """The folder of the demo, indexed, and the address of what the demo says to start."""
    folder = Path(shutil.copytree(DATA, tmp_path_factory.mktemp("demo") / "demo"))
    bundle = Bundle.load(threads=1)
    indexing.index(folder, bundle=bundle, jobs=1)
    with serving(folder, bundle, edit=True) as address:
        yield folder, address


def test_five_clips_are_found_starred_compared_and_downloaded(opened, demo):
    folder, address = demo
    page = opened(at=address)
    for text, count in _WANTED.items():
        box = page.get_by_label("Describe a motion")
        box.click()
        page.keyboard.press("Control+a")
        page.keyboard.type(text)
        until(page, "text => document.getElementById('status').textContent.includes(text)", text)
        until(page, "document.getElementById('results').ariaBusy === 'false'")
        for place in range(count):
            page.get_by_role("checkbox", name="Select").nth(place).click()
    tray = page.get_by_role("region", name="Tray")
    until(page, "document.getElementById('tray-count').textContent === '5 selected'")

    tray.get_by_role("button", name="Star").click()
    until(page, "document.getElementById('tray-status').textContent === 'Starred 5'")

    tray.get_by_role("button", name="Compare").click()
    offered = page.locator("#compare-with [label=Selected] option")
    until(page, "document.querySelectorAll('#compare-with [label=Selected] option').length === 4")
    for choice in [option.get_attribute("value") for option in offered.all()]:
        page.get_by_label("Compare with").select_option(choice)
        until(page, "choice => location.hash.includes(`with=${choice.split('@')[0]}&`)", choice)
        until(page, "!['', 'Loading…'].includes(document.getElementById('second-title').textContent)")
        seen(page, "#second", 2000)

    with page.expect_download() as waiting:
        tray.get_by_role("link", name="Download").click()
    packed = zipfile.ZipFile(io.BytesIO(Path(waiting.value.path()).read_bytes()))
    assert len([name for name in packed.namelist() if name.endswith(".bvh")]) == 5
    with Library.open(folder) as library:
        assert library.mark_counts()["starred"] == 5


def test_an_open_clip_is_starred_and_selected(opened, demo):
    _, address = demo
    page = opened("clip=3", at=address)
    page.wait_for_selector("#viewer:not([hidden], .empty) #viewer-facts dt")
    head = page.locator("#viewer-tools")
    before = head.get_by_role("button").get_attribute("aria-pressed")
    head.get_by_role("button").click()
    until(page, "before => document.querySelector('#viewer-tools .star').ariaPressed !== before", before)
    head.get_by_role("checkbox").check()
    until(page, "document.getElementById('tray-count').textContent === '1 selected'")
    assert page.locator("#tray-compare").is_hidden(), "there is nothing to compare it with"


def test_weak_matches_are_shown_where_more_are_wanted(opened, demo):
    _, address = demo
    page = opened("q=a person kicks a ball", at=address)
    few = page.locator("#grid .card").count()
    page.get_by_role("button", name="Show weak matches, too").click()
    until(page, "few => document.querySelectorAll('#grid .card').length > few", few)
    assert state(page)["strength"] == "weak"
    assert page.get_by_role("button", name="Show weak matches, too").count() == 0
