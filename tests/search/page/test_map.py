"""The map in a browser."""

from __future__ import annotations

import re

import numpy as np
import pytest

from indexer.ingest import indexing
from tests.search.conftest import made_motion
from tests.search.page.browser import cards, state, until
from tests.search.page.conftest import serving

pytestmark = pytest.mark.slow


def test_the_map_shows_clips_under_the_pointer_and_selects_by_lasso(opened):
    page = opened("view=map")
    page.wait_for_selector("#labels li")
    page.locator("#points").focus()
    page.keyboard.press("ArrowRight")
    page.wait_for_selector("#peek:not([hidden])")
    box = page.locator("#points").bounding_box()
    right, bottom = box["width"] - 20, box["height"] - 20  # within the round corners, around all points
    page.mouse.move(box["x"] + 20, box["y"] + 20)
    page.mouse.down()
    for x, y in [(right, 20), (right, bottom), (20, bottom)]:
        page.mouse.move(box["x"] + x, box["y"] + y, steps=3)
    page.mouse.up()
    page.locator("#selected").click()
    until(page, "document.querySelectorAll('#grid .card').length === 5")
    assert state(page)["ids"] == "1-5"


def test_points_are_selected_by_rectangle_by_label_and_by_keys(opened):
    page = opened("view=map")
    page.wait_for_selector("#labels li")
    box = page.locator("#points").bounding_box()
    page.keyboard.down("Shift")
    page.mouse.move(box["x"] + 15, box["y"] + 15)
    page.mouse.down()
    page.mouse.move(box["x"] + box["width"] - 15, box["y"] + box["height"] - 15, steps=4)
    page.mouse.up()
    page.keyboard.up("Shift")
    assert page.locator("#selected").inner_text() == "Show 5 selected"
    label = page.locator("#labels button").first
    label.click()
    assert label.get_attribute("aria-pressed") == "true"
    assert page.locator("#selected").inner_text() == f"Show {label.locator('small').inner_text()} selected"
    label.click()
    assert not page.locator("#selected").is_visible()
    page.locator("#points").focus()
    page.keyboard.press("ArrowRight")
    page.keyboard.press("Space")
    assert page.locator("#selected").inner_text() == "Show 1 selected"
    page.keyboard.press("Space")
    assert not page.locator("#selected").is_visible()


@pytest.fixture(scope="module")
def many(tmp_path_factory, bundle):
    """The address of a server of ninety clips, ten of them longer than the others."""
    folder = tmp_path_factory.mktemp("many")
    for i in range(90):
        np.save(folder / f"{i:02}.npy", made_motion(2.0 if i < 10 else 1.0, i).joints)
    indexing.index(folder, bundle=bundle, jobs=1)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("search.stacks.background.stacks", lambda *_: [])  # each clip is a card, alike as they are
        with serving(folder, bundle) as address:
            yield address


def _select_all(page):
    box = page.locator("#points").bounding_box()
    page.keyboard.down("Shift")
    page.mouse.move(box["x"] + 4, box["y"] + 4)
    page.mouse.down()
    page.mouse.move(box["x"] + box["width"] - 4, box["y"] + box["height"] - 4, steps=4)
    page.mouse.up()
    page.keyboard.up("Shift")


def test_all_of_a_selection_is_shown_page_by_page(opened, many):
    page = opened("view=map", at=many)
    page.wait_for_selector("#labels li")
    _select_all(page)
    assert page.locator("#selected").inner_text() == "Show 90 selected"
    page.locator("#selected").click()
    page.wait_for_selector("#status:has-text('90 clips selected')")
    for count in (48, 72, 90):
        page.locator("#more").click()
        cards(page, count)
    assert not page.locator("#more").is_visible()
    assert state(page)["ids"] == "1-90"
    page.go_back()
    page.wait_for_selector("#map:not([hidden])")
    assert page.locator("#selected").inner_text() == "Show 90 selected"


def test_filters_narrow_the_map_and_a_selection(opened, many):
    page = opened("view=map&min=1.5", at=many)
    page.wait_for_selector("#map-status:has-text('10 of 90 clips pass the filters')")
    assert sum(int(count.inner_text()) for count in page.locator("#labels small").all()) == 10
    _select_all(page)
    assert page.locator("#selected").inner_text() == "Show 10 selected"
    page.locator("#selected").click()
    cards(page, 10)
    page.keyboard.press("f")
    page.locator("#filters [name=min]").fill("3")
    page.wait_for_selector("#status:has-text('0 of 10 selected clips pass the filters')")


def test_how_far_the_layout_is_is_told(opened):
    page = opened()
    waiting: list = []
    page.route(re.compile("api/map"), lambda route: waiting.append(route))
    page.keyboard.press("m")
    until(page, "document.getElementById('map-note').textContent === 'Loading the map…'")
    while not waiting:
        page.wait_for_timeout(20)
    waiting.pop().fulfill(status=202, json={"generation": 1, "count": 100000, "progress": 0.42})
    until(page, "document.getElementById('map-note').textContent === 'Laying out 100,000 clips… 42 %'")
    while not waiting:
        page.wait_for_timeout(20)
    waiting.pop().continue_()
    page.wait_for_selector("#labels li")
