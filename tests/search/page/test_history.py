"""Back, forward and Esc: the place that the user left, and a history without detours."""

from __future__ import annotations

import numpy as np
import pytest

from indexer.ingest import indexing
from tests.search.conftest import made_motion
from tests.search.page.browser import CARDS, cards, opened_clip, state, until
from tests.search.page.conftest import serving

pytestmark = pytest.mark.slow

_FOCUSED = "[...document.querySelectorAll('#grid .card')].indexOf(document.activeElement)"


@pytest.fixture(scope="module")
def many(tmp_path_factory, bundle):
    """The address of a server of fifty clips."""
    folder = tmp_path_factory.mktemp("many")
    for i in range(50):
        np.save(folder / f"{i:02}.npy", made_motion(1.0, i).joints)
    indexing.index(folder, bundle=bundle, jobs=1)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("search.stacks.background.stacks", lambda *_: [])  # each clip is a card, alike as they are
        with serving(folder, bundle) as address:
            yield address


def _shows_results(page):
    page.wait_for_selector("#results:not([hidden])[aria-busy=false]")


@pytest.mark.parametrize("leave", ["Escape", "Back", "browser"])
def test_leaving_a_clip_leads_to_the_card_it_was_opened_from(opened, many, leave):
    page = opened("q=walks", at=many)
    page.locator("#more").click()
    cards(page, 48)
    page.locator(CARDS).nth(40).scroll_into_view_if_needed()
    before = page.evaluate("scrollY")
    assert before > 500
    length = page.evaluate("history.length")
    opened_clip(page, 40)
    assert page.evaluate("scrollY") == 0
    page.locator("#track").fill("waves")
    page.keyboard.press("Enter")
    until(page, "document.querySelectorAll('.track').length === 2")
    if leave == "Escape":
        page.locator("#viewer-title").focus()
        page.keyboard.press("Escape")
    elif leave == "Back":
        page.locator("#back").click()
    else:
        page.go_back()
    _shows_results(page)
    until(page, f"{_FOCUSED} === 40")
    assert page.locator(CARDS).count() == 48
    assert abs(page.evaluate("scrollY") - before) < 2
    assert page.evaluate("history.length") == length + 1, "the clip, which forward opens again, and nothing else"
    assert state(page) == {"q": "walks"}
    page.go_forward()
    page.wait_for_selector("#viewer:not([hidden], .empty)")


def test_going_back_to_an_older_question_shows_as_many_cards_as_were_there(opened, many):
    page = opened("q=walks", at=many)
    page.locator("#more").click()
    cards(page, 48)
    page.evaluate("scrollTo(0, 900)")
    page.locator("#home").click()
    page.wait_for_selector("#chips:not([hidden])")
    cards(page, 24)
    page.go_back()
    cards(page, 48)
    until(page, "Math.abs(scrollY - 900) < 2")


def test_a_clip_opened_by_a_link_is_left_for_its_question(opened, many):
    page = opened("clip=3&q=walks", at=many)
    page.wait_for_selector("#viewer:not(.empty)")
    length = page.evaluate("history.length")
    page.keyboard.press("Escape")
    _shows_results(page)
    assert state(page) == {"q": "walks"}
    assert page.evaluate("history.length") == length


def test_refining_a_question_adds_no_history(opened, many):
    page = opened("q=walks", at=many)
    length = page.evaluate("history.length")
    page.locator("#moments").check()
    until(page, "location.hash.includes('moments=1')")
    page.locator("#moments").uncheck()
    page.keyboard.press("f")
    page.locator("#filters [name=min]").fill("0.5")
    until(page, "location.hash.includes('min=0.5')")
    page.locator("#filters [type=reset]").click()
    until(page, "!location.hash.includes('min')")
    assert page.evaluate("history.length") == length


def test_the_skip_link_keeps_the_question(opened, many):
    page = opened("q=walks", at=many)
    page.keyboard.press("Tab")
    page.keyboard.press("Enter")
    assert page.evaluate("document.activeElement.id") == "main"
    assert state(page) == {"q": "walks"}
