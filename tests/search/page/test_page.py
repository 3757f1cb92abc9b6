"""The page in a browser."""

from __future__ import annotations

import os
import re
from pathlib import Path

import numpy as np
import pytest

from indexer.ingest import indexing
from search.export import bvh_writer
from tests.search.conftest import made_motion
from tests.search.page import browser
from tests.search.page.browser import CARDS, cards, changes, number, opened_clip, seen, state, until
from tests.search.page.conftest import serving

pytestmark = pytest.mark.slow


def test_results_appear_after_typing_and_the_url_names_them(opened):
    page = opened()
    assert page.locator(CARDS).count() == 5
    page.locator("#q").press_sequentially("a person walks", delay=20)
    page.wait_for_selector("#status:has-text('a person walks')")
    assert page.locator(CARDS).count() == 5
    assert page.locator(".card .score").count() == 5
    assert state(page) == {"q": "a person walks"}
    page.go_back()
    page.wait_for_selector("#chips:not([hidden])")
    assert page.locator("#q").input_value() == ""


def test_what_a_question_takes_away_is_said_above_its_hits(opened):
    page = opened("q=kicks%20-left")
    page.wait_for_selector("#status:has-text('“kicks -left”, without “left”')")
    page.evaluate("() => location.hash = 'q=kicks left'")
    page.wait_for_selector("#status:has-text('“kicks left”')")
    assert "without" not in page.locator("#status").inner_text()


def test_clips_and_hits_are_sorted(opened):
    def durations():
        return [float(text.split(" s")[0]) for text in page.locator(".card .facts").all_inner_texts()]

    page = opened()
    for address in ("", "q=a person walks&strength=weak"):
        page.evaluate("to => location.hash = to", address)
        cards(page, 5)
        for order, reverse in (("longest", True), ("shortest", False)):
            page.locator("#sort").select_option(order)
            until(page, f"location.hash.includes('sort={order}')")
            until(page, "document.getElementById('results').ariaBusy === 'false'")
            cards(page, 5)
            assert durations() == sorted(durations(), reverse=reverse)


def test_the_least_strength_is_asked_for(opened):
    page = opened("q=a person walks")
    asked: list[str] = []
    page.on("request", lambda request: asked.append(request.url) if "/api/search" in request.url else None)
    page.locator("#filters-button").click()
    page.locator("[name=strength]").select_option("strong")
    until(page, "location.hash.includes('strength=strong')")
    page.wait_for_selector("#filter-count:has-text('(1)')")
    until(page, "document.getElementById('results').ariaBusy === 'false'")
    assert any("min_strength=strong" in url for url in asked)
    page.locator("#filters [type=reset]").click()
    until(page, "!location.hash.includes('strength')")


def test_a_slow_response_to_an_older_query_is_dropped(opened):
    page = opened()
    page.route(re.compile("q=old"), lambda route: late.append(route))
    late: list = []
    page.locator("#q").fill("old")
    while not late:
        page.wait_for_timeout(20)
    page.locator("#q").fill("new")
    page.wait_for_selector("#status:has-text('new')")
    late[0].fulfill(json={"query": "old", "hits": []})
    browser.frames(page, 5)
    assert "old" not in page.locator("#status").inner_text()


def test_figures_are_drawn_and_move(opened):
    page = opened(reduced_motion="no-preference")
    _, before = seen(page, ".card .stage")
    changes(page, ".card .stage", before)


def test_nothing_plays_by_itself_with_reduced_motion(opened):
    page = opened()
    before = seen(page, ".card .stage")
    browser.frames(page, 20)
    assert browser.drawn(page, ".card .stage") == before


def test_the_keyboard_alone_is_enough(opened):
    page = opened()
    page.keyboard.press("/")
    page.keyboard.type("walks")
    page.wait_for_selector("#status:has-text('walks')")
    page.keyboard.press("ArrowDown")
    page.keyboard.press("ArrowRight")
    second = page.locator(CARDS).nth(1)
    assert second.evaluate("card => card === document.activeElement")
    page.keyboard.press("Enter")
    page.wait_for_selector("#viewer:not([hidden]) #viewer-facts dt")
    for _ in range(6):
        page.keyboard.press(".")
    page.keyboard.press("[")
    assert number(page, "#timeline .in") == pytest.approx(number(page, "#timeline .head"), abs=0.02)
    with page.expect_download():
        page.keyboard.press("e")
    page.keyboard.press("Escape")
    page.wait_for_selector("#results:not([hidden])")
    page.keyboard.press("?")
    assert page.locator("#help").is_visible()


@pytest.mark.parametrize(
    ("fragment", "ready"),
    [("q=walks", ".card .score"), ("clip=1&q=walks", ".track .moment"), ("view=map", "#labels li")],
)
def test_a_narrow_screen_needs_no_sideways_scrolling(opened, fragment, ready):
    page = opened(fragment, size=(360, 740))
    page.wait_for_selector(ready)
    assert page.evaluate("document.documentElement.scrollWidth <= innerWidth")


def test_on_a_narrow_screen_what_is_said_has_a_line_of_its_own(opened):
    page = opened("q=walks", size=(390, 844))
    said, sort = page.locator("#status").bounding_box(), page.locator("#sort").bounding_box()
    assert said["width"] > 300
    assert said["y"] + said["height"] <= sort["y"]


def test_an_empty_library_says_what_to_do(opened, tmp_path, bundle):
    indexing.index(tmp_path, bundle=bundle, jobs=1)
    with serving(tmp_path, bundle) as address:
        page = opened(at=address)
        assert "motionseek index" in page.locator("#notice").inner_text()


def test_hits_that_are_all_weak_are_no_good_match(opened):
    page = opened()
    weak = {"rank": 1, "path": "a.bvh", "score": 0.1, "strength": "weak", "start": 0, "end": 1, "duration": 2,
            "caption": "", "clip": 1}  # fmt: skip
    page.route(re.compile("api/search"), lambda route: route.fulfill(json={"query": "x", "hits": [weak]}))
    page.locator("#q").fill("purple")
    page.wait_for_selector("#notice:has-text('No good match')")
    assert page.locator(".strength").inner_text() == "weak"


def test_an_error_is_shown_and_can_be_retried(opened):
    page = opened()
    page.route(re.compile("api/search"), lambda route: route.fulfill(status=503, json={"error": "busy"}))
    page.locator("#q").fill("walks")
    page.wait_for_selector("#notice:has-text('busy')")
    page.unroute(re.compile("api/search"))
    page.locator("#notice button").click()
    page.wait_for_selector(CARDS)


@pytest.fixture
def unstacked(monkeypatch):
    """Each clip is a card, alike as they are."""
    monkeypatch.setattr("search.stacks.background.stacks", lambda *_: [])


def test_more_that_cannot_be_had_says_so_and_is_offered_again(opened, tmp_path, bundle, unstacked):
    for i in range(30):
        np.save(tmp_path / f"{i:02}.npy", made_motion(1.0, i).joints)
    indexing.index(tmp_path, bundle=bundle, jobs=1)
    with serving(tmp_path, bundle) as address:
        page = opened(at=address)
        cards(page, 24)
        page.route(re.compile("api/motions"), lambda route: route.abort())
        page.locator("#more").click()
        page.wait_for_selector("#more-error:has-text('does not respond')")
        page.unroute(re.compile("api/motions"))
        page.locator("#more").click()
        cards(page, 30)
        assert page.locator("#more-error").inner_text() == ""


def test_script_in_captions_and_names_stays_text(opened, tmp_path, bundle):
    attack = "<img src=x onerror=document.title='owned'><script>document.title='owned'</script>"
    name = "<b onclick=alert(1)>take&amp;.npy"
    np.save(tmp_path / name, made_motion(3.0, 1).joints)
    (tmp_path / name.replace(".npy", ".txt")).write_text(attack, encoding="utf-8")
    indexing.index(tmp_path, bundle=bundle, jobs=1)
    with serving(tmp_path, bundle) as address:
        page = opened("q=walks", at=address)
        page.wait_for_selector(".card .file")
        assert page.locator(".card .file").inner_text() == name
        opened_clip(page)
        page.wait_for_selector("#viewer-captions blockquote")
        assert page.locator("#viewer-captions").inner_text().strip() == attack
        assert page.locator("main img, main script, main b").count() == 0
        assert "owned" not in page.title()


def test_similar_clips_have_pages_and_a_rig_filters_them(opened, tmp_path, bundle, unstacked):
    for i in range(27):
        np.save(tmp_path / f"{i:02}.npy", made_motion(1.0, i).joints)
    with (tmp_path / "other.bvh").open("wb") as file:
        bvh_writer.write(file, made_motion(1.0, 5))
    indexing.index(tmp_path, bundle=bundle, jobs=1)
    with serving(tmp_path, bundle) as address:
        page = opened("like=1", at=address)
        assert page.locator(CARDS).count() == 24
        page.locator("#more").click()
        until(page, "document.querySelectorAll('#grid .card').length === 27")
        assert not page.locator("#more").is_visible()
        page.keyboard.press("f")
        until(page, "document.querySelectorAll('#filters [name=rig] option').length === 3")
        page.locator("#filters [name=rig]").select_option(index=2)
        until(page, "document.querySelectorAll('#grid .card').length === 1")
        assert "rig" in state(page)


def test_filters_narrow_the_results_and_are_kept_in_the_url(opened):
    page = opened("q=walks&min=7")
    assert page.locator(CARDS).count() == 2
    assert page.locator("#filter-count").inner_text() == "(1)"


def test_light_and_dark_follow_the_system_and_the_button(opened):
    page = opened(color_scheme="dark")
    paper = "getComputedStyle(document.body).backgroundColor"
    dark = page.evaluate(paper)
    page.keyboard.press("d")
    assert page.evaluate(paper) != dark


@pytest.mark.skipif("MOTIONSEEK_PICTURE" not in os.environ, reason="MOTIONSEEK_PICTURE names no file to write")
def test_picture_for_the_readme(opened, chromium):
    """Writes the picture to $MOTIONSEEK_PICTURE, of the server at $MOTIONSEEK_ADDRESS where one is named."""
    at = {"at": os.environ["MOTIONSEEK_ADDRESS"]} if "MOTIONSEEK_ADDRESS" in os.environ else {}
    page = opened(os.environ.get("MOTIONSEEK_VIEW", "q=a+person+kicks+a+ball"), size=(1360, 850), **at)
    page.wait_for_selector("#grid li:nth-child(12) .stage:not(.loading)", state="attached")
    page.wait_for_timeout(1500)
    target = Path(os.environ["MOTIONSEEK_PICTURE"])
    page.screenshot(path=target)
    assert target.stat().st_size < 400_000
