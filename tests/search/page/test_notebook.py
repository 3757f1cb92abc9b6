"""Motions and hits as a notebook shows them, in a browser."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

from encoders.drawing.player import player
from search.hits import Hit, Hits
from tests.search.conftest import made_motion

pytestmark = pytest.mark.slow

_SUM = """(canvas) => {
  const { data } = canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height);
  return data.reduce((sum, value, i) => (sum * 31 + value + i) % 1000003, 0);
}"""
_CORNER = "(canvas) => [...canvas.getContext('2d').getImageData(12, 12, 1, 1).data]"

Shown = Callable[..., Any]


@pytest.fixture
def shown(chromium: Any, tmp_path: Path) -> Iterator[Shown]:
    """Shows HTML in a page that may reach nothing; in the end there may have been no error."""
    faults: list[str] = []
    contexts = []

    def show(html: str, style: str = "", **options: Any) -> Any:
        context = chromium.new_context(viewport={"width": 900, "height": 700}, **options)
        contexts.append(context)
        page = context.new_page()
        page.on("pageerror", lambda error: faults.append(str(error)))
        page.on("dialog", lambda dialog: faults.append(dialog.message))
        page.on("request", lambda asked: None if asked.url.startswith("file:") else faults.append(asked.url))
        (tmp_path / "x.html").write_text(f'<!doctype html><meta charset="utf-8"><body style="{style}">{html}', "utf-8")
        page.goto((tmp_path / "x.html").as_uri())
        page.wait_for_timeout(200)
        return page

    yield show
    for context in contexts:
        context.close()
    assert faults == []


def _moves(page: Any, place: int = 0, *, within: int = 10_000) -> bool:
    """Whether a canvas changes within a number of milliseconds; a busy machine draws its first frame late."""
    canvas = page.locator("canvas").nth(place)
    before = canvas.evaluate(_SUM)
    for _ in range(within // 200):
        page.wait_for_timeout(200)
        if canvas.evaluate(_SUM) != before:
            return True
    return False


def _rests(page: Any, place: int = 0) -> bool:
    """Whether a canvas comes to rest; a busy machine draws its last frame late."""
    return any(not _moves(page, place, within=400) for _ in range(10))


def test_a_motion_moves_and_stops_where_it_is_clicked(shown: Shown) -> None:
    page = shown(made_motion(4, 0)._repr_html_())
    assert _moves(page)
    page.click("canvas")
    assert _rests(page)
    assert page.get_attribute("canvas", "aria-label").startswith("Play: ")
    page.keyboard.press("Space")
    assert _moves(page)


def test_a_figure_turns_by_dragging_and_by_keys(shown: Shown) -> None:
    page = shown(made_motion(4, 0)._repr_html_(), reduced_motion="reduce")
    canvas = page.locator("canvas")
    sums = [canvas.evaluate(_SUM)]
    page.mouse.move(130, 130)
    page.mouse.down()
    page.mouse.move(190, 130)
    page.mouse.up()
    sums.append(canvas.evaluate(_SUM))
    canvas.focus()
    page.keyboard.press("ArrowLeft")
    sums.append(canvas.evaluate(_SUM))
    assert len(set(sums)) == 3
    assert _rests(page)  # a drag is no click


def test_who_wants_no_motion_gets_a_still_until_asking_for_it(shown: Shown) -> None:
    page = shown(made_motion(4, 0)._repr_html_(), reduced_motion="reduce")
    assert not _moves(page, within=400)
    page.click("canvas")
    assert _moves(page)


def test_several_on_one_page_leave_each_other_alone(shown: Shown) -> None:
    hits = Hits(
        Hit(i, f"take {i}.bvh", 0.5, "weak", 0, 2, 2, read=lambda i=i: made_motion(2, i))  # type: ignore[misc]
        for i in range(3)
    )
    page = shown(f"{made_motion(3, 7)._repr_html_()}<hr>{hits._repr_html_()}<hr>{hits._repr_html_()}")
    assert page.locator("canvas").count() == 7
    assert all(_moves(page, place) for place in (0, 1, 3))
    page.locator("canvas").nth(1).click()
    assert _rests(page, 1)
    assert _moves(page, 2)


def test_it_is_dark_where_its_surroundings_are(shown: Shown) -> None:
    html = made_motion(2, 0)._repr_html_()
    assert shown(html).locator("canvas").evaluate(_CORNER)[0] > 200
    assert shown(html, "background:#111;color:#eee").locator("canvas").evaluate(_CORNER)[0] < 60


def test_text_of_files_is_never_markup(shown: Shown) -> None:
    said = '</script></figcaption><img src=x onerror="alert(1)"><script>alert(2)</script>'
    motion = made_motion(1, 0)
    page = shown(player([(motion.joints, motion.fps, said)]))
    assert page.inner_text("figcaption") == said
    assert page.locator("img").count() == 0


def test_without_scripts_a_pose_is_seen(shown: Shown) -> None:
    page = shown(made_motion(2, 0)._repr_html_(), java_script_enabled=False)
    assert page.locator("svg path").count() == 26
