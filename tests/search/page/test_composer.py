"""The editor of compositions, in a real browser: sentences are added, moved, stretched, swapped, played, exported."""

from __future__ import annotations

import io
import json
import zipfile
from pathlib import Path
from urllib.parse import quote

import pytest

from tests.search.page.browser import changes, number, seen, state, until

axe = pytest.importorskip("axe_playwright_python.sync_playwright")
pytestmark = pytest.mark.slow

SHOWN = "#composer:not([hidden])"
ROWS = [["walks", 0, 3], ["waves with the left hand", 0.5, 2.5], ["sits", 3, 5]]
LINE = "view=compose&line=" + quote(json.dumps(ROWS))
DONE = "document.getElementById('composer').getAttribute('aria-busy') === 'false'"


def composed(page) -> None:
    """Wait until the motion of what the time line says is there."""
    until(page, f"{DONE} && / clips$/.test(document.getElementById('composer-status').textContent)")


def rows(page) -> list[list]:
    """The sentences, as the address has them."""
    return json.loads(state(page)["line"])


def test_sentences_are_added_and_become_a_motion_that_plays(opened):
    page = opened("view=compose", wait=SHOWN)
    assert page.locator("#to-compose").get_attribute("aria-current") is not None
    page.locator("#new-sentence").fill("walks")
    page.keyboard.press("Enter")
    page.locator("#new-sentence").fill("waves with the left hand")
    page.locator("#add-over").click()
    composed(page)
    assert [(row[0], row[1], row[2]) for row in rows(page)] == [("walks", 0, 4), ("waves with the left hand", 0, 4)]
    assert page.locator(".block").count() == 2
    _, before = seen(page, "#composed")
    page.locator("#composed-play").click()
    changes(page, "#composed", before)
    assert page.locator("#composed-play").get_attribute("aria-label") == "Pause"


def test_a_block_is_dragged_and_stretched(opened):
    page = opened(LINE, wait=SHOWN)
    composed(page)
    block = page.get_by_role("slider", name="waves with the left hand", exact=True)
    box = block.bounding_box()
    second = box["width"] / 2
    page.mouse.move(box["x"] + box["width"] / 2, box["y"] + 20)
    page.mouse.down()
    page.mouse.move(box["x"] + box["width"] / 2 + second, box["y"] + 20, steps=4)
    page.mouse.up()
    until(page, "decodeURIComponent(location.hash).includes('hand\",1.5,3.5')")
    edge = page.get_by_role("slider", name="End of waves with the left hand").bounding_box()
    page.mouse.move(edge["x"] + 12, edge["y"] + 20)
    page.mouse.down()
    page.mouse.move(edge["x"] + 12 + second / 2, edge["y"] + 20, steps=4)
    page.mouse.up()
    until(page, "decodeURIComponent(location.hash).includes('hand\",1.5,4')")
    composed(page)


def test_keys_move_stretch_and_remove(opened):
    page = opened(LINE, wait=SHOWN)
    composed(page)
    block = page.get_by_role("slider", name="waves with the left hand", exact=True)
    block.focus()
    page.keyboard.press("ArrowRight")
    until(page, "document.activeElement.getAttribute('aria-valuenow') === '0.6'")
    assert page.locator("#sentence").input_value() == "waves with the left hand"
    page.keyboard.press("Tab")
    page.keyboard.press("Tab")
    page.keyboard.press("Shift+ArrowLeft")
    until(page, "document.activeElement.getAttribute('aria-valuenow') === '1.6'")
    block.focus()
    page.keyboard.press("Enter")
    assert page.evaluate("document.activeElement.id") == "sentence"
    block.focus()
    page.keyboard.press("Delete")
    until(page, "document.querySelectorAll('.block').length === 2")
    composed(page)
    assert [row[0] for row in rows(page)] == ["walks", "sits"]


def test_the_next_best_is_shown_and_the_others_stay(opened):
    page = opened(LINE, wait=SHOWN)
    composed(page)
    page.get_by_role("slider", name="sits", exact=True).focus()
    pressed = "#options [aria-pressed=true]"
    first, others = page.locator(pressed).get_attribute("title"), [row[4:] for row in rows(page)[:2]]
    before = rows(page)[2][4:]
    page.locator("#next-best").click()
    until(page, "(before) => !location.hash.includes(encodeURIComponent(before))", json.dumps(before)[1:-1])
    composed(page)
    until(page, f"document.querySelectorAll('{pressed}').length === 1")
    assert rows(page)[2][4:] != before, first
    assert [row[4:] for row in rows(page)[:2]] == others
    page.reload()
    page.wait_for_selector(pressed)
    assert [row[4:] for row in rows(page)[:2]] == others


def test_the_form_edits_a_sentence_and_what_is_wrong_is_said(opened):
    page = opened(LINE, wait=SHOWN)
    composed(page)
    page.get_by_role("slider", name="sits", exact=True).focus()
    page.locator("#sentence-start").fill("4")
    page.keyboard.press("Enter")
    page.wait_for_selector("#composer-error:not([hidden])")
    assert "nothing happens from 3 to 4 s" in page.locator("#composer-error").inner_text()
    page.locator("#sentence-start").fill("3")
    page.keyboard.press("Enter")
    composed(page)
    assert page.locator("#composer-error").is_hidden()
    page.locator("#part-0").check()
    until(page, "decodeURIComponent(location.hash).includes('legs')")
    composed(page)


def test_motion_and_report_are_exported(opened):
    page = opened(LINE, wait=SHOWN)
    composed(page)
    page.locator("#composed-format").select_option("npz")
    with page.expect_download() as waiting:
        page.locator("#composed-export").click()
    packed = zipfile.ZipFile(io.BytesIO(Path(waiting.value.path()).read_bytes()))
    assert packed.namelist() == ["composition.json", "composition.npz"]
    told = json.loads(packed.read("composition.json"))["intervals"]
    assert [[one["text"], one["clip"]] for one in told] == [[row[0], row[4]] for row in rows(page)]


def test_a_clip_is_opened_and_the_way_back_leads_here(opened):
    page = opened(LINE, wait=SHOWN)
    composed(page)
    line = rows(page)
    page.locator("#options a").first.click()
    page.wait_for_selector("#viewer:not([hidden], .empty)")
    page.keyboard.press("Escape")
    page.wait_for_selector(SHOWN)
    assert rows(page) == line
    assert number(page, "#line .head") == 0


@pytest.mark.parametrize("theme", ["light", "dark"])
@pytest.mark.parametrize("size", [(1280, 860), (390, 844)])
def test_it_fits_and_breaks_no_rule(opened, theme, size):
    page = opened(LINE, color_scheme=theme, size=size, wait=SHOWN)
    composed(page)
    assert page.evaluate("document.documentElement.scrollWidth") <= size[0]
    found = axe.Axe().run(
        page, options={"runOnly": ["wcag2a", "wcag2aa", "wcag21a", "wcag21aa", "wcag22aa", "best-practice"]}
    )
    told = [(one["id"], [node["html"][:120] for node in one["nodes"]]) for one in found.response["violations"]]
    assert told == []
