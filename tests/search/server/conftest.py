"""A served library and its client."""

from __future__ import annotations

import shutil
from collections.abc import Callable, Iterator
from contextlib import ExitStack
from pathlib import Path
from typing import Any

import pytest

pytest.importorskip("fastapi")
pytest.importorskip("httpx")

from starlette.testclient import TestClient

from encoders.bundle.bundle import Bundle
from search.server.app import create_app
from search.server.snapshot_library import SnapshotLibrary

Asked = Callable[..., Any]


@pytest.fixture(scope="session")
def bundle(tiny_bundle: Path) -> Bundle:
    """The tiny model."""
    return Bundle.load(tiny_bundle, threads=1)


@pytest.fixture(scope="session")
def client(indexed: Path, bundle: Bundle) -> Iterator[TestClient]:
    """A client of a server of the indexed takes. The library is not to be changed."""
    app = create_app(SnapshotLibrary.open(indexed, bundle=bundle))
    with TestClient(app, base_url="http://127.0.0.1:8420") as found:
        yield found


@pytest.fixture
def served(indexed: Path, bundle: Bundle, tmp_path: Path) -> Iterator[Callable[..., TestClient]]:
    """Makes clients of further servers, each of a copy of the indexed takes in `tmp_path / "takes"`."""
    with ExitStack() as stack:

        def make(*, raise_server_exceptions: bool = True, **options: Any) -> TestClient:
            folder = tmp_path / "takes"
            if not folder.exists():
                shutil.copytree(indexed, folder)
            app = create_app(SnapshotLibrary.open(folder, bundle=bundle), **options)
            client = TestClient(app, base_url="http://127.0.0.1:8420", raise_server_exceptions=raise_server_exceptions)
            return stack.enter_context(client)

        yield make


@pytest.fixture(scope="session")
def ask(client: TestClient) -> Asked:
    """The JSON of a successful response."""

    def asked(url: str, **parameters: Any) -> Any:
        response = client.get(url, params=parameters)
        assert response.status_code == 200, response.text
        return response.json()

    return asked


@pytest.fixture(scope="session")
def number(ask: Asked) -> Callable[[str], int]:
    """A clip's number by its path."""
    by_path = {motion["path"]: motion["clip"] for motion in ask("/api/motions")["motions"]}
    return lambda path: int(by_path[path])
