"""What the search box takes beside a sentence: a clip that hits shall be like, and filters."""

from __future__ import annotations

import re

import pytest

from tests.search.page.browser import CARDS, cards, opened_clip, state, until

pytestmark = pytest.mark.slow


def test_a_sentence_is_asked_beside_the_clip_that_hits_shall_be_like(opened):
    page = opened("clip=1&a=0.5&b=2&q=walks")
    page.wait_for_selector("#viewer:not([hidden], .empty) #viewer-facts dt")
    name = page.locator("#viewer-title").inner_text()
    page.get_by_role("link", name="More like this").click()
    until(page, "location.hash.startsWith('#like=1')")
    until(page, "name => document.getElementById('like-clip').textContent === `${name}, 0.5–2.0 s`", name)
    with page.expect_request(re.compile(r"api/search\?q=but\+slower&like=1&start=0.50&end=2.00")):
        page.locator("#q").fill("but slower")
    page.wait_for_selector("#status:has-text('but slower')")
    assert page.locator(CARDS).count() > 0
    opened_clip(page)
    assert page.locator(".track").count() == 0, "what is asked beside a clip is no motion to look for"
    page.keyboard.press("Escape")
    page.get_by_role("button", name="Ask without this clip").click()
    until(page, "location.hash === '#q=but+slower'")
    assert page.locator("#likeness").is_hidden()


def test_filters_are_typed_among_the_words(opened):
    page = opened()
    page.locator("#q").press_sequentially('walks format:bvh path:"no such folder"', delay=5)
    page.wait_for_selector("#notice:has-text('Nothing passes the filters')")
    assert state(page) == {"q": "walks", "format": "bvh", "path": "no such folder"}
    assert page.locator("#filter-count").inner_text() == "(2)"
    page.locator("#q").fill("walks format:bvh")
    until(page, "!location.hash.includes('path')")
    cards(page, 1)
    assert page.locator("#q").input_value() == "walks format:bvh"
    page.locator("#filters-button").click()
    page.locator("#filters [type=reset]").click()
    until(page, "location.hash === '#q=walks'")
    assert page.locator("#q").input_value() == "walks", "what is no longer a filter is no longer said"
