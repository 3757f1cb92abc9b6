"""An open clip in a browser: playback, time line, cut and export."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest

from indexer.ingest import indexing
from tests.search.conftest import made_motion
from tests.search.page.browser import CARDS, drawn, number, opened_clip, seen, state, until
from tests.search.page.conftest import serving

pytestmark = pytest.mark.slow


_OPEN = "#viewer:not([hidden], .empty) #viewer-facts dt"


def test_the_body_is_drawn_though_the_answer_comes_after_the_clip_was_opened(opened):
    page = opened()
    seen(page, ".card .stage")
    late: list = []
    page.route(re.compile("api/search"), lambda route: late.append(route))
    page.locator("#q").fill("walks")
    while not late:
        page.wait_for_timeout(20)
    page.locator(CARDS).first.click()
    page.wait_for_selector(_OPEN)
    seen(page, "#big", 2000)
    late[0].continue_()
    until(page, "document.querySelectorAll('#grid .score').length === 5")  # the figures of before are disposed of
    page.keyboard.press("Escape")
    page.wait_for_selector("#results:not([hidden])")
    for place in range(3):
        seen(page, f"#grid li:nth-child({place + 1}) .stage", 1500)
    opened_clip(page, 1)
    seen(page, "#big", 2000)


def test_a_clip_that_cannot_be_opened_leaves_nothing_of_the_former_one(opened):
    page = opened("clip=1&q=walks")
    page.wait_for_selector(_OPEN)
    page.route(re.compile("api/motions/2"), lambda route: route.fulfill(status=503, json={"error": "busy"}))
    page.evaluate("location.hash = '#clip=2&q=walks'")
    page.wait_for_selector("#viewer-error:has-text('busy')")
    assert page.locator("#export").get_attribute("href") is None
    assert not page.locator("#export").is_visible()
    assert not page.locator("#timeline").is_visible()
    assert drawn(page, "#big")[0] == 0
    assert page.locator("#big.loading").count() == 0
    with page.expect_request(re.compile("api/motions/2")):
        page.keyboard.press("e")  # exports nothing: the next request is that of the button
        page.locator("#viewer-error button").click()
    page.unroute(re.compile("api/motions/2"))
    page.locator("#viewer-error button").click()
    page.wait_for_selector(_OPEN)
    assert "clip=2" in page.locator("#export").get_attribute("href")
    seen(page, "#big", 2000)


def test_a_question_for_steps_shows_that_it_works_and_its_steps(opened):
    page = opened()
    late: list = []
    page.route(re.compile(r"api/moments\?q"), lambda route: late.append(route))
    page.locator("#moments").check()
    page.locator("#q").fill("walks, then sits down")
    until(page, "document.getElementById('status').innerText.includes('exact moments')")
    assert page.locator("#progress").is_visible()
    late[0].continue_()
    page.wait_for_selector(".card .steps")
    assert not page.locator("#progress").is_visible()
    assert page.locator(".card .steps").first.inner_text().splitlines()[0].startswith("walks ")
    assert "2 steps" in page.locator("#status").inner_text()
    opened_clip(page)
    until(page, "document.querySelectorAll('.track .line[d]').length === 2")
    assert [name.inner_text() for name in page.locator(".track .name").all()][1].strip() == "sits down"
    assert page.locator(".track:nth-child(2) .moment").count() >= 1


def test_a_clip_plays_and_can_be_scrubbed(opened):
    page = opened()
    opened_clip(page)
    page.keyboard.press("Space")
    until(page, "document.querySelector('#timeline .head').ariaValueNow > 0.2")
    page.keyboard.press("Space")
    box = page.locator("#timeline .ruler").bounding_box()
    page.mouse.click(box["x"] + box["width"] / 2, box["y"] + 5)
    duration = float(page.locator("#timeline .head").get_attribute("aria-valuemax"))
    assert number(page, "#timeline .head") == pytest.approx(duration / 2, abs=0.05)


def test_a_moment_is_marked_and_takes_the_in_and_out_points(opened):
    page = opened("clip=1&q=a+person+walks&ask=waves")
    page.wait_for_selector(".track .moment")
    until(page, "document.querySelectorAll('.track .line[d]').length === 2")
    page.locator(".track .moment").first.click()
    start, end = number(page, "#timeline .in"), number(page, "#timeline .out")
    assert end > start
    page.locator(".track .remove").click()
    until(page, "document.querySelectorAll('.track').length === 1")
    assert "ask" not in state(page)


def test_in_and_out_points_are_dragged_and_kept_in_the_url(opened):
    page = opened("clip=1")
    page.wait_for_selector(_OPEN)
    box, handle = page.locator("#timeline .ruler").bounding_box(), page.locator("#timeline .in").bounding_box()
    page.mouse.move(handle["x"] + 5, handle["y"] + 10)
    page.mouse.down()
    page.mouse.move(box["x"] + box["width"] / 4, box["y"] + 10)
    page.mouse.up()
    duration = float(page.locator("#timeline .in").get_attribute("aria-valuemax"))
    assert float(state(page)["a"]) == pytest.approx(duration / 4, abs=0.05)


@pytest.mark.parametrize("ending", ["bvh", "npz", "npy"])
def test_the_cut_is_exported(opened, ending):
    page = opened("clip=1&a=0.5&b=1.5")
    page.wait_for_selector(_OPEN)
    page.locator("#export-format").select_option(ending)
    with page.expect_download() as download:
        page.locator("#export").click()
    assert download.value.suggested_filename.endswith(f".{ending}")
    assert Path(download.value.path()).stat().st_size > 500


def test_the_time_line_of_a_long_take_is_zoomed_and_follows_the_head(opened, tmp_path, bundle):
    np.save(tmp_path / "long.npy", made_motion(240.0, 1).joints)
    indexing.index(tmp_path, bundle=bundle, jobs=1)
    with serving(tmp_path, bundle) as address:
        page = opened("clip=1&q=walks", at=address)
        page.wait_for_selector(".track .moment")
        asked = page.evaluate("performance.getEntriesByType('resource').map(({ name }) => name)")
        assert any("moments" in url and "k=12&" in url for url in asked), "eight, and one a minute"
        width = "document.querySelector('#timeline .ruler').getBoundingClientRect().width"
        whole = page.evaluate(width)
        page.keyboard.press("+")
        page.locator("#zoom-in").click()
        assert page.evaluate(width) == pytest.approx(4 * whole, rel=0.01)
        box = page.locator("#timeline").bounding_box()
        page.mouse.click(box["x"] + 24 + whole / 2, page.locator("#timeline .ruler").bounding_box()["y"] + 5)
        assert number(page, "#timeline .head") == pytest.approx(30, abs=1)
        page.locator("#timeline .head").focus()
        page.keyboard.press("End")
        head = page.locator("#timeline .head").bounding_box()
        assert box["x"] <= head["x"] <= box["x"] + box["width"]
        page.keyboard.press("0")
        assert page.evaluate(width) == pytest.approx(whole)
        page.mouse.move(box["x"] + 24 + whole / 4, box["y"] + 10)
        page.keyboard.down("Control")
        page.mouse.wheel(0, -200)
        page.keyboard.up("Control")
        until(page, f"{width} > 2 * {whole}")
        left = page.evaluate("document.querySelector('#timeline .ruler').getBoundingClientRect().left")
        at = (box["x"] + 24 + whole / 4 - left) / page.evaluate(width)
        assert at == pytest.approx(1 / 4, abs=0.01)  # what was under the pointer still is


def test_frames_of_the_file_are_counted_and_stepped_and_all_is_in_view(opened):
    page = opened("clip=5&q=walks", size=(1280, 720))
    page.wait_for_selector(_OPEN)
    until(page, "document.querySelectorAll('.track').length === 1")
    info = page.request.get(re.sub("#.*", "api/motions/5", page.url)).json()
    rate, frames = info["source_fps"], info["source_frames"]
    assert f"/ {frames - 1}" in page.locator("#time").inner_text()
    for _ in range(3):
        page.keyboard.press(".")
    assert "frame 3 /" in page.locator("#time").inner_text()
    assert page.locator("#timecode").inner_text() == "00:00:00:03"
    assert number(page, "#timeline .head") == pytest.approx(3 / rate, abs=0.01)
    page.locator("#before").click()
    assert "frame 2 /" in page.locator("#time").inner_text()
    for part in ("#big", "#play", "#timeline .ruler", ".track", "#export"):
        box = page.locator(part).bounding_box()
        assert box["y"] + box["height"] <= 720, part
    page.set_viewport_size({"width": 390, "height": 844})
    for part in ("#big", "#play", "#timeline .ruler", ".track"):
        box = page.locator(part).bounding_box()
        assert box["y"] + box["height"] <= 844, part


def test_path_feet_and_poses_are_drawn(opened, tmp_path, bundle):
    joints = np.repeat(made_motion(1.0, 1).joints[:1], 120, axis=0)
    joints[:, :, 2] += np.interp(np.arange(120) / 20, [0, 2, 4, 6], [0, 0, 2, 2])[:, None]  # stands, slides, stands
    np.save(tmp_path / "slides.npy", joints)
    indexing.index(tmp_path, bundle=bundle, jobs=1)
    with serving(tmp_path, bundle) as address:
        page = opened("clip=1", at=address)
        _look_at_traces(page)


def _look_at_traces(page):
    page.wait_for_selector(_OPEN)
    plain = seen(page, "#big", 2000)[1]
    page.locator("#path").check()
    with_path = seen(page, "#big", 2000)[1]
    page.locator("#feet").check()
    with_feet = seen(page, "#big", 2000)[1]
    assert len({plain, with_path, with_feet}) == 3
    assert page.locator(".feet .left rect").count() == page.locator(".feet .right rect").count() == 2
    inked = """(() => { const strip = document.querySelector('.poses');
      const { data } = strip.getContext('2d').getImageData(0, 0, strip.width, strip.height);
      return data.filter((value, i) => i % 4 === 3 && value > 200).length })()"""
    assert page.evaluate(inked) > 1000
    page.locator("#path").uncheck()
    page.locator("#feet").uncheck()
    assert seen(page, "#big", 2000)[1] == plain


def test_a_second_clip_plays_in_step(opened):
    page = opened("q=walks&clip=5&a=1&b=3&with=4&c=2")
    page.wait_for_selector(_OPEN)
    page.wait_for_selector("#second-title a")
    seen(page, "#second", 2000)
    until(page, "document.querySelector('#compare-with').value.startsWith('4@')")
    before = seen(page, "#second", 2000)[1]
    page.keyboard.press(".")
    assert seen(page, "#second", 2000)[1] != before
    turned = seen(page, "#second", 2000)[1]
    box = page.locator("#big").bounding_box()
    page.mouse.move(box["x"] + 100, box["y"] + 100)
    page.mouse.down()
    page.mouse.move(box["x"] + 180, box["y"] + 100, steps=3)
    page.mouse.up()
    assert seen(page, "#second", 2000)[1] != turned, "both are turned together"
    page.locator("#compare-close").click()
    assert not page.locator("#second").is_visible()
    assert "with" not in state(page)
    page.locator("#compare").click()
    page.wait_for_selector("#second-title a")
    assert state(page)["with"] != "5"
