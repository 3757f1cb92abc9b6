"""The page in headless Chromium: from the last key to the first hits, moves on a map of many points, bytes on the wire.

    motionseek serve FOLDER --port 8420 &
    python -m benchmarks.page http://127.0.0.1:8420/ --points 100000

Server, browser and this share the cores; the browser draws without a graphics card. Beside each time is that of a plain
way in the same page: a request for a sentence as new as the typed one, and a look at every point for the nearest.
"""

from __future__ import annotations

import argparse
import json
import shutil
import statistics
import time
from typing import Any

import numpy as np
from playwright.sync_api import sync_playwright

_FLAGS = "--no-sandbox --use-gl=angle --use-angle=swiftshader --enable-unsafe-swiftshader".split()
_VERBS = "walks runs jumps kicks waves sits turns crawls dances limps throws bows".split()
_HOW = ("slowly", "with the left hand", "backwards", "like a tired old man")

#: Types a sentence but its last letter, then that letter: milliseconds until cards of it are there.
_LAST_KEY = """(text) => new Promise((done) => {
  const box = document.getElementById('q'), grid = document.getElementById('grid');
  const type = (value) => { box.value = value; box.dispatchEvent(new Event('input', { bubbles: true })); };
  type(text.slice(0, -1));
  setTimeout(() => {
    const began = performance.now();
    const seen = new MutationObserver(() => {
      if (!document.getElementById('status').textContent.includes(text) || !grid.querySelector('.score')) return;
      seen.disconnect();
      done(performance.now() - began);
    });
    seen.observe(document.getElementById('results'), { subtree: true, childList: true, characterData: true });
    type(text);
  }, 60);
})"""
_REQUEST = """async (text) => {
  const began = performance.now();
  await (await fetch(`api/search?k=24&q=${encodeURIComponent(text)}`)).json();
  return performance.now() - began;
}"""
#: Moves the pointer across the map: the longest and the usual milliseconds of one move.
_MOVES = """() => {
  const canvas = document.getElementById('points'), box = canvas.getBoundingClientRect(), took = [];
  for (let i = 0; i < 400; i++) {
    const [x, y] = [box.left + box.width * (0.1 + 0.002 * i), box.top + box.height * (0.5 + 0.4 * Math.sin(i / 9))];
    const began = performance.now();
    canvas.dispatchEvent(new PointerEvent('pointermove', { clientX: x, clientY: y, bubbles: true }));
    took.push(performance.now() - began);
  }
  return took;
}"""
_PLAIN = """(count) => {
  const x = Float32Array.from({ length: count }, () => Math.random()), y = x.slice().reverse(), took = [];
  for (let i = 0; i < 20; i++) {
    const began = performance.now();
    let [best, least] = [-1, Infinity];
    for (let k = 0; k < count; k++) {
      const away = Math.hypot(x[k] - i / 20, y[k] - 0.5);
      if (away < least) [best, least] = [k, away];
    }
    took.push(performance.now() - began + 0 * best);
  }
  return took;
}"""


def main() -> None:
    """Print the measurements."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("address")
    parser.add_argument("--points", type=int, default=100_000)
    given = parser.parse_args()
    with sync_playwright() as driver:
        browser = driver.chromium.launch(executable_path=shutil.which("chromium"), headless=True, args=_FLAGS)
        context = browser.new_context(viewport={"width": 1280, "height": 860}, reduced_motion="reduce")
        print_wire(context.new_page(), given.address)
        print_typing(context.new_page(), given.address)
        print_moves(context.new_page(), given.address, given.points)
        browser.close()


def print_wire(page: Any, address: str) -> None:
    """Bytes of the page, of what a first visit loads."""
    page.goto(address)
    page.wait_for_selector("#grid .card")
    sizes = page.evaluate(
        "performance.getEntriesByType('resource').concat(performance.getEntriesByType('navigation'))"
        ".filter(({ name }) => !name.includes('/api/')).map(({ encodedBodySize }) => encodedBodySize)"
    )
    print(f"page on the wire: {sum(sizes) / 1000:.0f} kB in {len(sizes)} files")
    page.close()


def print_typing(page: Any, address: str) -> None:
    """From the last key of new sentences to their first hits."""
    page.goto(address)
    page.wait_for_selector("#grid .card")
    mark = f"{time.time():.0f}"[-5:]
    typed, plain = [], []
    for i, verb in enumerate(_VERBS):
        typed.append(page.evaluate(_LAST_KEY, f"a person {verb} {_HOW[i % 4]} {mark}"))
        plain.append(page.evaluate(_REQUEST, f"someone {verb} {_HOW[i % 4]} {mark}"))
    usual, alone = statistics.median(typed), statistics.median(plain)
    print(f"last key to first hits: median {usual:.0f} ms, longest {max(typed):.0f} ms of {len(typed)} new sentences; "
          f"a request alone {alone:.0f} ms, ratio {usual / alone:.1f}")  # fmt: skip
    page.close()


def print_moves(page: Any, address: str, count: int) -> None:
    """Moves of the pointer on a map of random points."""
    points = np.random.default_rng(0).random((count, 2)).round(4)
    answer = {
        "generation": 0,
        "clips": list(range(1, count + 1)),
        "x": points[:, 0].tolist(),
        "y": points[:, 1].tolist(),
        "labels": [f"kind {i}" for i in range(12)],
        "label": [i % 12 for i in range(count)],
    }
    page.route("**/api/map", lambda route: route.fulfill(body=json.dumps(answer), content_type="application/json"))
    page.goto(f"{address}#view=map")
    page.wait_for_selector("#labels li")
    took, plain = page.evaluate(_MOVES), statistics.median(page.evaluate(_PLAIN, count))
    usual = statistics.median(took)
    print(f"a move over {count} points: median {usual:.2f} ms, p95 {np.percentile(took, 95):.2f} ms, longest "
          f"{max(took):.2f} ms; a look at every point {plain:.1f} ms")  # fmt: skip
    page.close()


if __name__ == "__main__":
    main()
