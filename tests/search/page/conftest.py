"""The page in a real browser, served as `motionseek serve` serves it. Without Chromium these tests skip."""

from __future__ import annotations

import os
import shutil
import socket
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest

pytest.importorskip("fastapi")
pytest.importorskip("playwright.sync_api")

import uvicorn
from playwright.sync_api import sync_playwright

from encoders.bundle.bundle import Bundle
from search.server.app import create_app
from search.server.snapshot_library import SnapshotLibrary

#: Quiet, off the network, and WebGL without a graphics card.
_FLAGS = (
    "--no-sandbox --disable-quic --no-first-run --disable-background-networking --disable-component-update "
    "--disable-sync --use-gl=angle --use-angle=swiftshader --enable-unsafe-swiftshader"
).split()


_SHOWN = "#results:not([hidden])[aria-busy=false], #viewer:not([hidden]), #map:not([hidden]), #composer:not([hidden])"


# For this module alone: while it is open, its event loop runs, and no other test could start one.
@pytest.fixture(scope="module")
def chromium() -> Iterator[Any]:
    """The browser."""
    program = next(filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))), None)
    if program is None:
        pytest.skip("no Chromium is installed")
    with sync_playwright() as driver:
        browser = driver.chromium.launch(executable_path=program, headless=True, args=_FLAGS)
        yield browser
        browser.close()


@contextmanager
def serving(folder: Path, bundle: Bundle, **options: Any) -> Iterator[str]:
    """Serve a library from a thread; gives its address."""
    listening = socket.socket()
    listening.bind(("127.0.0.1", 0))
    app = create_app(SnapshotLibrary.open(folder, bundle=bundle), **options)
    server = uvicorn.Server(uvicorn.Config(app, log_level="warning"))
    thread = threading.Thread(target=server.run, kwargs={"sockets": [listening]})
    thread.start()
    try:
        yield f"http://127.0.0.1:{listening.getsockname()[1]}/"
    finally:
        server.should_exit = True
        thread.join()
        listening.close()


@pytest.fixture(scope="session")
def bundle(tiny_bundle: Path) -> Bundle:
    """The tiny model."""
    return Bundle.load(tiny_bundle, threads=1)


@pytest.fixture(scope="session")
def address(indexed: Path, bundle: Bundle) -> Iterator[str]:
    """Where the indexed takes are served."""
    with serving(indexed, bundle) as found:
        yield found


Opened = Callable[..., Any]


@pytest.fixture
def opened(chromium: Any, address: str) -> Iterator[Opened]:
    """Opens the page at what follows its `#`; in the end it may have had no error and asked no other server."""
    faults: list[str] = []
    contexts = []

    def open_page(
        fragment: str = "",
        *,
        at: str = address,
        size: tuple[int, int] = (1280, 860),
        wait: str = _SHOWN,
        **options: Any,
    ) -> Any:
        context = chromium.new_context(
            viewport={"width": size[0], "height": size[1]}, **{"reduced_motion": "reduce", **options}
        )
        context.set_default_timeout(int(os.environ.get("MOTIONSEEK_TEST_PATIENCE", "90")) * 1000)
        contexts.append(context)
        page = context.new_page()
        page.on("pageerror", lambda error: faults.append(str(error)))
        page.on("console", lambda said: faults.append(said.text) if "Content Security Policy" in said.text else None)
        page.on(
            "request",
            lambda asked: (
                None if asked.url.startswith((at, "blob:", "http://elsewhere.example/")) else faults.append(asked.url)
            ),
        )
        page.goto(f"{at}#{fragment}")
        page.wait_for_selector(wait)
        return page

    yield open_page
    for context in contexts:
        context.close()
    assert faults == []
