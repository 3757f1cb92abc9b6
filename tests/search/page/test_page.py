"""The page in a browser."""

from __future__ import annotations

import os
import re
from pathlib import Path
from urllib.parse import parse_qs, urlsplit

import numpy as np
import pytest

from indexer.ingest import indexing
from search.export import bvh_writer
from tests.search.conftest import made_motion
from tests.search.page.conftest import serving

# A browser without a graphics card on a busy machine misses a frame now and then: a test that fails is tried again.
pytestmark = [pytest.mark.slow, pytest.mark.flaky(reruns=2)]

_CARDS = "#grid .card"
_PIXELS = """([left, top, width, height]) => new Promise((done) => requestAnimationFrame(() => {
  const image = document.createElement('canvas'); image.width = width; image.height = height;
  image.getContext('2d').drawImage(document.getElementById('canvas'), left, top, width, height, 0, 0, width, height);
  const data = image.getContext('2d').getImageData(0, 0, width, height).data;
  let sum = 0, drawn = 0;
  for (let i = 3; i < data.length; i += 4) if (data[i] > 250) { drawn++; sum = (sum * 31 + i + data[i - 1]) % 1000003; }
  done([drawn, sum]);
}))"""


def _until(page, condition):
    """Wait for a condition. `wait_for_function` would need `eval`, which the page forbids."""
    for _ in range(900):
        if page.evaluate(condition):
            return
        page.wait_for_timeout(100)
    raise AssertionError(f"never came: {condition}")


def _state(page):
    """The address after `#`, each name once."""
    return {name: values[0] for name, values in parse_qs(urlsplit(page.url).fragment).items()}


def _drawn(page, selector):
    """How many pixels of a figure are drawn inside an element, and a sum that changes with them."""
    page.evaluate("dispatchEvent(new Event('scroll'))")
    box = page.locator(selector).first.bounding_box()
    return page.evaluate(_PIXELS, [box["x"], box["y"], box["width"], box["height"]])


def _seen(page, selector):
    """As `_drawn`, once there is something: between two frames the canvas reads as empty."""
    for _ in range(200):
        drawn = _drawn(page, selector)
        if all(drawn):
            return drawn
        page.wait_for_timeout(50)
    raise AssertionError(f"nothing is drawn in {selector}")


def _open_clip(page):
    page.locator(_CARDS).first.click()
    page.wait_for_selector("#viewer:not([hidden]) #viewer-facts dt")


def _number(page, slider):
    return float(page.locator(slider).get_attribute("aria-valuenow"))


def test_results_appear_after_typing_and_the_url_names_them(opened):
    page = opened()
    assert page.locator(_CARDS).count() == 5
    with page.expect_response(re.compile("api/search")) as answer:
        page.locator("#q").press_sequentially("a person walks", delay=20)
    assert parse_qs(urlsplit(answer.value.url).query)["q"] == ["a person walks"]
    page.wait_for_selector("#status:has-text('a person walks')")
    assert page.locator(_CARDS).count() == 5
    assert page.locator(".card .score").count() == 5
    assert _state(page) == {"q": "a person walks"}
    page.go_back()
    page.wait_for_selector("#chips:not([hidden])")
    assert page.locator("#q").input_value() == ""


def test_a_slow_response_to_an_older_query_is_dropped(opened):
    page = opened()
    late = []
    page.route(re.compile("q=old"), lambda route: late.append(route))
    page.locator("#q").fill("old")
    page.wait_for_timeout(600)
    page.locator("#q").fill("new")
    page.wait_for_selector("#status:has-text('new')")
    assert late
    assert "old" not in page.locator("#status").inner_text()


def test_figures_are_drawn_and_move(opened):
    page = opened(reduced_motion="no-preference")
    page.wait_for_selector("#grid li:first-child .stage:not(.loading)")
    page.wait_for_timeout(500)
    drawn, before = _drawn(page, ".card .stage")
    assert drawn > 500
    page.wait_for_timeout(700)
    assert _drawn(page, ".card .stage")[1] != before


def test_nothing_plays_by_itself_with_reduced_motion(opened):
    page = opened()
    page.wait_for_selector("#grid li:first-child .stage:not(.loading)")
    page.wait_for_timeout(500)
    before = _seen(page, ".card .stage")
    page.wait_for_timeout(500)
    assert _seen(page, ".card .stage") == before


def test_a_clip_plays_and_can_be_scrubbed(opened):
    page = opened()
    _open_clip(page)
    page.keyboard.press("Space")
    _until(page, "document.querySelector('#timeline .head').ariaValueNow > 0.2")
    page.keyboard.press("Space")
    box = page.locator(".ruler").bounding_box()
    page.mouse.click(box["x"] + box["width"] / 2, box["y"] + 5)
    duration = float(page.locator("#timeline .head").get_attribute("aria-valuemax"))
    assert _number(page, "#timeline .head") == pytest.approx(duration / 2, abs=0.05)


def test_a_moment_is_marked_and_takes_the_in_and_out_points(opened):
    page = opened("clip=1&q=a+person+walks&ask=waves")
    page.wait_for_selector(".track .moment")
    _until(page, "document.querySelectorAll('.track .line[d]').length === 2")
    page.locator(".track .moment").first.click()
    start, end = _number(page, "#timeline .in"), _number(page, "#timeline .out")
    assert end > start
    page.locator(".track .remove").click()
    _until(page, "document.querySelectorAll('.track').length === 1")
    assert "ask" not in _state(page)


def test_in_and_out_points_are_dragged_and_kept_in_the_url(opened):
    page = opened("clip=1")
    page.wait_for_selector("#viewer-facts dt")
    box, handle = page.locator(".ruler").bounding_box(), page.locator("#timeline .in").bounding_box()
    page.mouse.move(handle["x"] + 5, handle["y"] + 10)
    page.mouse.down()
    page.mouse.move(box["x"] + box["width"] / 4, box["y"] + 10)
    page.mouse.up()
    duration = float(page.locator("#timeline .in").get_attribute("aria-valuemax"))
    assert float(_state(page)["a"]) == pytest.approx(duration / 4, abs=0.05)


@pytest.mark.parametrize("ending", ["bvh", "npz", "npy"])
def test_the_cut_is_exported(opened, ending):
    page = opened("clip=1&a=0.5&b=1.5")
    page.wait_for_selector("#viewer-facts dt")
    page.locator("#export-format").select_option(ending)
    with page.expect_download() as download:
        page.locator("#export").click()
    assert download.value.suggested_filename.endswith(f".{ending}")
    assert Path(download.value.path()).stat().st_size > 500


def test_a_dropped_file_is_described_and_finds_similar_clips(opened, tmp_path):
    page = opened()
    with (tmp_path / "mine.bvh").open("wb") as file:
        bvh_writer.write(file, made_motion(3.0, 5))
    dropped = page.evaluate_handle(
        "text => { const data = new DataTransfer(); data.items.add(new File([text], 'mine.bvh')); return data }",
        (tmp_path / "mine.bvh").read_text(),
    )
    page.dispatch_event("body", "dragenter", {"dataTransfer": dropped})
    assert page.locator("#drop").is_visible()
    page.dispatch_event("body", "drop", {"dataTransfer": dropped})
    page.wait_for_selector("#described li")
    assert _state(page)["clip"].startswith("u")
    page.keyboard.press("s")
    page.wait_for_selector(_CARDS)
    _until(page, "document.querySelector('#status').innerText.includes('Similar to')")


def test_a_file_that_is_no_motion_shows_the_error(opened):
    page = opened()
    page.locator("#file").set_input_files({"name": "bad.bvh", "mimeType": "text/plain", "buffer": b"HIERARCHY\nROOT"})
    page.wait_for_selector("#status:has-text('bad.bvh:')")


def test_the_keyboard_alone_is_enough(opened):
    page = opened()
    page.keyboard.press("/")
    page.keyboard.type("walks")
    page.wait_for_selector("#status:has-text('walks')")
    page.keyboard.press("ArrowDown")
    page.keyboard.press("ArrowRight")
    second = page.locator(_CARDS).nth(1)
    assert second.evaluate("card => card === document.activeElement")
    page.keyboard.press("Enter")
    page.wait_for_selector("#viewer:not([hidden]) #viewer-facts dt")
    for _ in range(6):
        page.keyboard.press(".")
    page.keyboard.press("[")
    assert _number(page, "#timeline .in") == pytest.approx(_number(page, "#timeline .head"), abs=0.02)
    with page.expect_download():
        page.keyboard.press("e")
    page.keyboard.press("Escape")
    page.wait_for_selector("#results:not([hidden])")
    page.keyboard.press("?")
    assert page.locator("#help").is_visible()


def test_a_narrow_screen_needs_no_sideways_scrolling(opened):
    for fragment in ("q=walks", "clip=1&q=walks", "view=map"):
        page = opened(fragment, size=(360, 740))
        page.wait_for_timeout(500)
        assert page.evaluate("document.documentElement.scrollWidth <= innerWidth"), fragment


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
    page.wait_for_selector(_CARDS)


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
        _open_clip(page)
        page.wait_for_selector("#viewer-captions blockquote")
        assert page.locator("#viewer-captions").inner_text().strip() == attack
        assert page.locator("main img, main script, main b").count() == 0
        assert "owned" not in page.title()


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
    _until(page, "document.querySelectorAll('#grid .card').length === 5")
    assert len(_state(page)["ids"].split(",")) == 5


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


def test_similar_clips_have_pages_and_a_rig_filters_them(opened, tmp_path, bundle):
    for i in range(27):
        np.save(tmp_path / f"{i:02}.npy", made_motion(1.0, i).joints)
    with (tmp_path / "other.bvh").open("wb") as file:
        bvh_writer.write(file, made_motion(1.0, 5))
    indexing.index(tmp_path, bundle=bundle, jobs=1)
    with serving(tmp_path, bundle) as address:
        page = opened("like=1", at=address)
        assert page.locator(_CARDS).count() == 24
        page.locator("#more").click()
        _until(page, "document.querySelectorAll('#grid .card').length === 27")
        assert not page.locator("#more").is_visible()
        page.keyboard.press("f")
        _until(page, "document.querySelectorAll('#filters [name=rig] option').length === 3")
        page.locator("#filters [name=rig]").select_option(index=2)
        _until(page, "document.querySelectorAll('#grid .card').length === 1")
        assert "rig" in _state(page)


def test_the_time_line_of_a_long_take_is_zoomed_and_follows_the_head(opened, tmp_path, bundle):
    np.save(tmp_path / "long.npy", made_motion(240.0, 1).joints)
    indexing.index(tmp_path, bundle=bundle, jobs=1)
    with serving(tmp_path, bundle) as address:
        page = opened("clip=1&q=walks", at=address)
        page.wait_for_selector(".track .moment")
        asked = page.evaluate("performance.getEntriesByType('resource').map(({ name }) => name)")
        assert any("moments" in url and "k=12&" in url for url in asked), "eight, and one a minute"
        width = "document.querySelector('.ruler').getBoundingClientRect().width"
        whole = page.evaluate(width)
        page.keyboard.press("+")
        page.locator("#zoom-in").click()
        assert page.evaluate(width) == pytest.approx(4 * whole, rel=0.01)
        box = page.locator("#timeline").bounding_box()
        page.mouse.click(box["x"] + 16 + whole / 2, page.locator(".ruler").bounding_box()["y"] + 5)
        assert _number(page, "#timeline .head") == pytest.approx(30, abs=1)
        page.locator("#timeline .head").focus()
        page.keyboard.press("End")
        head = page.locator("#timeline .head").bounding_box()
        assert box["x"] <= head["x"] <= box["x"] + box["width"]
        page.keyboard.press("0")
        assert page.evaluate(width) == pytest.approx(whole)
        page.mouse.move(box["x"] + 16 + whole / 4, box["y"] + 10)
        page.keyboard.down("Control")
        page.mouse.wheel(0, -200)
        page.keyboard.up("Control")
        _until(page, f"{width} > 2 * {whole}")
        left = page.evaluate("document.querySelector('.ruler').getBoundingClientRect().left")
        at = (box["x"] + 16 + whole / 4 - left) / page.evaluate(width)
        assert at == pytest.approx(1 / 4, abs=0.01)  # what was under the pointer still is


def test_filters_narrow_the_results_and_are_kept_in_the_url(opened):
    page = opened("q=walks&min=7")
    assert page.locator(_CARDS).count() == 2
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
