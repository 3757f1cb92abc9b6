"""Files that are dropped on the page or chosen in its dialog."""

from __future__ import annotations

import io

import pytest

from search.cli.commands.demo import DATA
from search.export import bvh_writer
from tests.search.conftest import made_motion
from tests.search.page.browser import cards, dropped, state, until

pytestmark = pytest.mark.slow


def _bvh(seed: int = 5) -> bytes:
    file = io.BytesIO()
    bvh_writer.write(file, made_motion(3.0, seed))
    return file.getvalue()


def test_a_dropped_file_is_described_and_finds_similar_clips(opened):
    page = opened()
    dropped(page, {"mine.bvh": _bvh()})
    page.wait_for_selector("#described li")
    assert state(page)["clip"].startswith("u")
    page.keyboard.press("s")
    page.wait_for_selector("#status:has-text('Similar to')")
    cards(page, 5)


def test_several_files_are_all_opened_and_what_fails_is_named(opened):
    page = opened("q=walks")
    dropped(
        page, {"one.bvh": _bvh(1), "two.bvh": _bvh(2), "bad.bvh": "HIERARCHY\nROOT", "old.c3d": b"\x02P" + b"\0" * 600}
    )
    page.wait_for_selector("#status:has-text('2 motions of your files')")
    cards(page, 2)
    assert [file.inner_text() for file in page.locator(".card .file").all()] == ["one.bvh", "two.bvh"]
    told = page.locator("#told-text").inner_text()
    assert "bad.bvh:" in told
    assert "C3D cannot be read" in told
    page.locator("#told-close").click()
    assert not page.locator("#told").is_visible()


def test_a_motion_takes_the_skeleton_that_is_dropped_with_it(opened):
    page = opened()
    names = ("session_01.asf", "session_01.amc")
    dropped(page, {name: (DATA / name).read_bytes() for name in names})
    page.wait_for_selector("#viewer:not([hidden], .empty) #viewer-facts dt")
    assert page.locator("#viewer-title").inner_text() == "session_01"
    dropped(page, {"session_01.asf": (DATA / "session_01.asf").read_bytes()})
    page.wait_for_selector("#told-text:has-text('skeleton without motion')")


_DROP_FOLDER = """([first, second]) => {
  const file = (name, bytes) => (
    { name, isFile: true, file: (done) => done(new File([Uint8Array.from(bytes)], name)) });
  const folder = (name, inside) => ({ name, isDirectory: true, createReader: () => (
    { left: [inside, []], readEntries(done) { done(this.left.shift()) } }) });
  const day = folder("day 2", [file("b.bvh", second)]);
  const shoot = folder("shoot", [file("a.bvh", first), file(".hidden.bvh", []), day]);
  const event = new Event("drop", { bubbles: true, cancelable: true });
  event.dataTransfer = { types: ["Files"], files: [], items: [{ webkitGetAsEntry: () => shoot }] };
  document.body.dispatchEvent(event);
}"""


def test_a_folder_is_dropped_with_all_that_is_in_it(opened):
    page = opened()
    page.evaluate(_DROP_FOLDER, [list(_bvh(1)), list(_bvh(2))])
    cards(page, 2)
    assert [file.inner_text() for file in page.locator(".card .file").all()] == ["shoot/a.bvh", "shoot/day 2/b.bvh"]


def test_only_formats_that_are_read_are_promised(opened):
    page = opened()
    data = page.evaluate_handle(
        "() => { const data = new DataTransfer(); data.items.add(new File([], 'x')); return data }"
    )
    page.dispatch_event("body", "dragenter", {"dataTransfer": data})
    until(page, "document.querySelector('#endings').innerText.includes('.bvh')")
    endings = page.locator("#endings").inner_text().split()
    assert ".amc" in endings
    assert not set(endings) & {".c3d", ".asf", ".zip", "…"}


def test_a_file_that_is_no_motion_shows_the_error(opened):
    page = opened()
    page.locator("#file").set_input_files({"name": "bad.bvh", "mimeType": "text/plain", "buffer": b"HIERARCHY\nROOT"})
    page.wait_for_selector("#told-text:has-text('bad.bvh:')")
