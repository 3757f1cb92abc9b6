"""Who cannot see colours, uses no mouse or enlarges text: the rules of WCAG 2.2 AA that axe can check, and pixels."""

from __future__ import annotations

import re

import pytest

from tests.search.page.browser import seen, until

axe = pytest.importorskip("axe_playwright_python.sync_playwright")
pytestmark = pytest.mark.slow

_RULES = {"runOnly": ["wcag2a", "wcag2aa", "wcag21a", "wcag21aa", "wcag22aa", "best-practice"]}
#: Luminance of WCAG, of the darkest and the lightest of the pixels of the canvas that lie in a box, over its paper.
_CONTRAST = """([left, top, width, height, paper]) => new Promise((done) => dispatchEvent(new Event('scroll')) &&
  requestAnimationFrame(() => {
  const image = document.createElement('canvas'); [image.width, image.height] = [width, height];
  const pen = image.getContext('2d');
  pen.fillStyle = paper; pen.fillRect(0, 0, width, height);
  pen.drawImage(document.getElementById('canvas'), left, top, width, height, 0, 0, width, height);
  const data = pen.getImageData(0, 0, width, height).data;
  const part = (value) => (value /= 255) <= 0.04045 ? value / 12.92 : ((value + 0.055) / 1.055) ** 2.4;
  const bright = (i) => 0.2126 * part(data[i]) + 0.7152 * part(data[i + 1]) + 0.0722 * part(data[i + 2]);
  const [ground, ratios] = [bright(0), []];
  for (let i = 0; i < data.length; i += 4) {
    const here = bright(i);
    ratios.push((Math.max(here, ground) + 0.05) / (Math.min(here, ground) + 0.05));
  }
  done(ratios.filter((ratio) => ratio > 3).length);
}))"""


@pytest.mark.parametrize("theme", ["light", "dark"])
@pytest.mark.parametrize(
    ("fragment", "ready"),
    [
        ("", ".card"),
        ("q=walks", ".card .score"),
        ("clip=1&q=walks&ask=waves&with=2", "#second-title a"),
        ("clip=999", "#viewer-error button"),
        ("like=1&q=slower", ".card .score"),
        ("view=compose", "#composer.empty"),
        ("view=map&q=walks", "#labels li"),
    ],
)
def test_no_view_breaks_a_rule(opened, fragment, ready, theme):
    page = opened(fragment, color_scheme=theme)
    page.wait_for_selector(ready)
    if fragment == "q=walks":
        page.keyboard.press("f")
    if fragment == "":
        page.keyboard.press("?")
    if "like" in fragment:
        for place in (0, 1):
            page.locator("#grid .pick").nth(place).check()
    if "clip=1" in fragment:
        until(page, "document.querySelectorAll('.track .line[d]').length === 2")
        page.locator("#feet").check()
    found = axe.Axe().run(page, options=_RULES).response["violations"]
    assert [(one["id"], [node["html"][:120] for node in one["nodes"]]) for one in found] == []


@pytest.mark.parametrize("theme", ["light", "dark"])
def test_a_figure_stands_out_from_its_ground(opened, theme):
    page = opened(color_scheme=theme)
    drawn, _ = seen(page, ".card .stage", 2000)
    box = page.locator(".card .stage").first.bounding_box()
    paper = page.evaluate("getComputedStyle(document.querySelector('.card .stage')).backgroundColor")
    clear = page.evaluate(_CONTRAST, [round(box[k]) for k in ("x", "y", "width", "height")] + [paper])
    assert clear > 0.5 * drawn, "half of the body has the 3:1 that WCAG asks of graphics"


def test_with_forced_colours_strength_and_handles_are_still_told_apart(opened):
    page = opened(forced_colors="active")
    hit = {"rank": 1, "path": "a.bvh", "score": 0.1, "strength": "weak", "start": 0, "end": 1, "duration": 2,
           "caption": "", "clip": 1}  # fmt: skip
    page.route(re.compile("api/search"), lambda route: route.fulfill(json={"query": "x", "hits": [hit]}))
    page.locator("#q").fill("walks")
    page.wait_for_selector(".strength")
    fill = "getComputedStyle(document.querySelector('.strength .{}')).fill"
    assert page.evaluate(fill.format("on")) != page.evaluate(fill.format("off"))
    page.locator("#grid .card").click()
    page.wait_for_selector("#viewer:not(.empty)")
    colour = "getComputedStyle(document.querySelector('{}'), '{}').backgroundColor"
    assert page.evaluate(colour.format(".over .handle", "::before")) != page.evaluate(colour.format("body", ""))


def test_single_key_shortcuts_can_be_switched_off(opened):
    page = opened()
    page.keyboard.press("?")
    page.locator("#single-keys").uncheck()
    page.locator("#help button").click()
    page.keyboard.press("m")
    page.keyboard.press("d")
    assert page.locator("#results").is_visible()
    assert page.evaluate("document.documentElement.dataset.theme ?? ''") == ""
    page.reload()
    page.wait_for_selector(".card")
    page.keyboard.press("?")
    assert not page.locator("#help").is_visible(), "it is kept"
