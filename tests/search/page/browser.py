"""What the tests of the page share: waiting for conditions, and looking at what is drawn."""

from __future__ import annotations

import time
from typing import Any
from urllib.parse import parse_qs, urlsplit

CARDS = "#grid .card"
#: Seconds that a condition may take to come; a busy machine is slow, and no test waits longer than it has to.
PATIENCE = 90
#: Reads what the stage has drawn in the same frame, before the browser shows it: afterwards the canvas reads as empty.
_PIXELS = """([left, top, width, height]) => new Promise((done) => dispatchEvent(new Event('scroll')) &&
  requestAnimationFrame(() => {
  const image = document.createElement('canvas'); image.width = width; image.height = height;
  image.getContext('2d').drawImage(document.getElementById('canvas'), left, top, width, height, 0, 0, width, height);
  const data = image.getContext('2d').getImageData(0, 0, width, height).data;
  let sum = 0, drawn = 0;
  for (let i = 3; i < data.length; i += 4) if (data[i] > 250) { drawn++; sum = (sum * 31 + i + data[i - 1]) % 1000003; }
  done([drawn, sum]);
}))"""


def until(page: Any, condition: str, argument: Any = None) -> None:
    """Wait for a condition. `wait_for_function` would need `eval`, which the page forbids."""
    end = time.monotonic() + PATIENCE
    while time.monotonic() < end:
        if page.evaluate(condition, argument):
            return
        page.wait_for_timeout(50)
    raise AssertionError(f"never came: {condition}")


def cards(page: Any, count: int) -> None:
    """Wait until that many cards are there."""
    until(page, f"document.querySelectorAll('{CARDS}').length === {count}")


def state(page: Any) -> dict[str, str]:
    """The address after `#`, each name once."""
    return {name: values[0] for name, values in parse_qs(urlsplit(page.url).fragment).items()}


def drawn(page: Any, selector: str) -> tuple[int, int]:
    """How many pixels of a figure are drawn inside an element, and a sum that changes with them."""
    box = page.locator(selector).first.bounding_box()
    if box is None:  # not there yet, or gone again
        return 0, 0
    count, total = page.evaluate(_PIXELS, [box["x"], box["y"], box["width"], box["height"]])
    return count, total


def seen(page: Any, selector: str, least: int = 500) -> tuple[int, int]:
    """As `drawn`, once that many pixels are."""
    end = time.monotonic() + PATIENCE
    while time.monotonic() < end:
        found = drawn(page, selector)
        if found[0] > least:
            return found
        page.wait_for_timeout(50)
    raise AssertionError(f"nothing is drawn in {selector}: {found[0]} pixels")


def frames(page: Any, count: int) -> None:
    """Let the browser show that many frames."""
    page.evaluate(
        "(n) => new Promise((done) => { const f = () => n-- ? requestAnimationFrame(f) : done(); f() })", count
    )


def changes(page: Any, selector: str, before: int) -> None:
    """Wait until what is drawn in an element differs from a sum of before."""
    end = time.monotonic() + PATIENCE
    while time.monotonic() < end:
        if seen(page, selector)[1] != before:
            return
    raise AssertionError(f"{selector} stands still")


def opened_clip(page: Any, place: int = 0) -> None:
    """Click a card and wait for its clip."""
    page.locator(CARDS).nth(place).click()
    page.wait_for_selector("#viewer:not([hidden], .empty) #viewer-facts dt")


def number(page: Any, slider: str) -> float:
    """Where a slider of the time line is, in seconds."""
    return float(page.locator(slider).get_attribute("aria-valuenow"))


def dropped(page: Any, files: dict[str, bytes | str], *, hover: bool = True) -> None:
    """Drop files on the page."""
    data = page.evaluate_handle(
        """(files) => { const data = new DataTransfer();
        for (const [name, text] of files) data.items.add(new File([Uint8Array.from(text)], name));
        return data }""",
        [[name, list(one.encode() if isinstance(one, str) else one)] for name, one in files.items()],
    )
    page.dispatch_event("body", "dragenter", {"dataTransfer": data})
    assert page.locator("#drop").is_visible()
    page.dispatch_event("body", "drop", {"dataTransfer": data})
