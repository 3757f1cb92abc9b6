"""Signing in: a link from another site to a server that asks for a token."""

from __future__ import annotations

import pytest

from tests.search.page.browser import CARDS
from tests.search.page.conftest import serving

pytestmark = pytest.mark.slow

_TOKEN = "a-token-that-nobody-guesses"


def test_a_link_on_another_site_opens_what_it_names_once_the_token_is_given(opened, indexed, bundle, tmp_path):
    with serving(indexed, bundle, token=_TOKEN) as address:
        page = opened(at=address, wait="#sign-in")
        link = f"{address}#q=walks"
        page.route(
            "http://elsewhere.example/",
            lambda route: route.fulfill(content_type="text/html", body=f"<a href='{link}'>look</a>"),
        )

        def follow():
            page.goto("http://elsewhere.example/")
            page.locator("a").click()

        follow()
        page.locator("#token").fill("wrong")
        page.keyboard.press("Enter")
        page.wait_for_selector("#said:has-text('not the token')")
        page.locator("#token").fill(_TOKEN)
        page.keyboard.press("Enter")
        page.wait_for_selector(CARDS)
        assert page.url == link
        follow()
        page.wait_for_selector(CARDS)
