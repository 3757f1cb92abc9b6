"""The tray, stars and tags, facets, stacks and recent questions, in a real browser."""

from __future__ import annotations

import io
import shutil
import zipfile
from pathlib import Path

import numpy as np
import pytest

from indexer.ingest import indexing
from search.library import Library
from tests.search.conftest import made_motion
from tests.search.page.browser import cards, state, until
from tests.search.page.conftest import serving

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def folder(takes, tmp_path_factory, bundle):
    """The takes with two copies of one, of which one is mirrored."""
    folder = Path(shutil.copytree(takes, tmp_path_factory.mktemp("shelf") / takes.name))
    np.save(folder / "deep er" / "copy.npy", made_motion(8.0, 2).joints)
    np.save(folder / "deep er" / "mirrored.npy", made_motion(8.0, 2).mirror().joints)
    indexing.index(folder, bundle=bundle, jobs=1)
    with Library.open(folder, bundle=bundle) as library:
        library.duplicates()
    return folder


@pytest.fixture(scope="module")
def editing(folder, bundle):
    """The address of a server that may write marks."""
    with serving(folder, bundle, edit=True) as address:
        yield address


def open_filters(page):
    page.locator("#filters-button").click()
    page.wait_for_selector("#facets fieldset")


def test_clips_are_selected_starred_tagged_and_downloaded_as_one_archive(opened, editing, folder, bundle):
    page = opened(at=editing)
    assert page.locator("#tray").is_hidden()
    for place in (0, 1):
        page.locator("#grid .pick").nth(place).check()
    until(page, "document.getElementById('tray-count').textContent === '2 selected'")
    page.wait_for_selector("#tray-marks:not([hidden])")
    tray = page.locator("#tray").bounding_box()
    assert tray["y"] + tray["height"] == page.evaluate("innerHeight")
    page.locator("#tray-star").click()
    until(page, "document.getElementById('tray-status').textContent === 'Starred 2'")
    page.locator("#tray-tag").fill("fight")
    page.keyboard.press("Enter")
    until(page, "document.getElementById('tray-status').textContent === 'Tagged 2'")
    until(page, "document.querySelectorAll('#grid .labels .tag').length === 2")
    until(page, "document.querySelectorAll('#grid .star[aria-pressed=true]').length === 2")
    with Library.open(folder, bundle=bundle) as library:
        assert library.mark_counts() == {"starred": 2, "tags": {"fight": 2}, "collections": {}}

    with page.expect_download() as waiting:
        page.locator("#tray-download").click()
    packed = zipfile.ZipFile(io.BytesIO(Path(waiting.value.path()).read_bytes()))
    assert waiting.value.suggested_filename == "motions.zip"
    assert len(packed.namelist()) == 2
    assert packed.testzip() is None

    page.reload()
    page.wait_for_selector("#tray:not([hidden])")
    page.locator("#tray-show").click()
    until(page, "location.hash.startsWith('#ids=')")
    cards(page, 2)
    page.locator("#tray-clear").click()
    assert page.locator("#tray").is_hidden()


def test_paths_are_copied(opened, editing):
    page = opened(at=editing, permissions=["clipboard-read", "clipboard-write"])
    page.locator("#grid .pick").nth(0).check()
    page.locator("#tray-copy").click()
    until(page, "document.getElementById('tray-status').textContent === 'Copied the path'")
    path = page.locator("#grid .file").first.text_content()
    assert page.evaluate("navigator.clipboard.readText()") == path


def test_a_server_that_may_not_write_says_how_to_star(opened, folder, bundle, tmp_path):
    with serving(Path(shutil.copytree(folder, tmp_path / "takes")), bundle) as address:
        page = opened(at=address)
        page.locator("#grid .star").first.dispatch_event("click")
        until(page, "document.getElementById('tray-status').textContent.includes('--edit')")
        assert page.locator("#tray-marks").is_hidden()


def test_a_file_can_be_dragged_out(opened, editing):
    page = opened(at=editing)
    data = page.evaluate_handle("new DataTransfer()")
    page.locator("#grid .save").first.dispatch_event("dragstart", {"dataTransfer": data})
    kind, name, url = data.evaluate("(data) => data.getData('DownloadURL')").split(":", 2)
    assert kind == "application/octet-stream"
    assert name.endswith(".bvh")
    assert page.request.get(url).body().startswith(b"HIERARCHY")


def test_facets_count_and_filter(opened, editing):
    page = opened(at=editing)
    cards(page, 5)
    open_filters(page)
    formats = page.locator("#facets fieldset", has_text="Format")
    assert formats.locator("button").all_inner_texts() == ["npy\n6", "bvh\n1"]
    formats.locator("button", has_text="bvh").click()
    cards(page, 1)
    assert state(page)["format"] == "bvh"
    until(page, "document.querySelector('#facets [aria-pressed=true] span')?.textContent === 'bvh'")
    formats.locator("button", has_text="bvh").click()
    page.locator("#facets button", has_text="deep er").click()
    until(page, "location.hash.includes('path=deep')")
    until(page, "document.querySelector('#facets [aria-pressed=true] span')?.textContent === 'deep er'")
    assert page.locator("#facets fieldset", has_text="Length").locator("button").all_inner_texts() == ["5 to 10 s\n3"]
    cards(page, 2)


def test_copies_are_one_card_that_opens(opened, editing):
    page = opened("q=a person walks", at=editing)
    until(page, "document.querySelectorAll('#grid .copies').length === 1")
    cards(page, 5)
    stack = page.locator("#grid .copies")
    assert stack.inner_text() == "2 more of this performance"
    stack.click()
    cards(page, 7)
    assert page.locator("#grid .labels", has_text="mirrored").count() >= 1
    assert page.evaluate("document.activeElement.classList.contains('card')")


def test_mirrored_copies_stay_apart_where_a_side_is_asked_for(opened, editing):
    page = opened("q=waves the left hand", at=editing)
    until(page, "document.querySelectorAll('#grid .copies').length === 1")
    cards(page, 6)
    assert page.locator("#grid .copies").inner_text() == "1 more of this performance"


def test_a_hit_says_that_it_was_found_by_its_name(opened, editing):
    page = opened("q=take 3", at=editing)
    page.wait_for_selector("#grid li:first-child .labels .matched")
    assert page.locator("#grid .file").first.inner_text() == "take 3.npy"
    assert page.locator("#grid .matched").first.inner_text() == "name"


def test_recent_questions_are_offered(opened, editing):
    page = opened(at=editing)
    page.locator("#q").fill("kicks a ball")
    until(page, "localStorage.getItem('recent-questions') === '[\"kicks a ball\"]'")
    page.locator("#home").click()
    page.locator("#recent-chips a", has_text="kicks a ball").click()
    until(page, "document.getElementById('q').value === 'kicks a ball'")
    assert page.locator("#recent option").count() == 1
    page.locator("#home").click()
    page.locator("#recent-chips button").click()
    assert page.locator("#recent-chips").is_hidden()
