"""Connections that are silent, half-sent, malformed or too many, to a server that really listens."""

from __future__ import annotations

import contextlib
import json
import socket
import threading
import time
from collections.abc import Iterator
from contextlib import ExitStack

import pytest

pytest.importorskip("fastapi")

import uvicorn

from encoders.bundle.bundle import Bundle
from search.server import connections
from search.server.app import create_app
from search.server.listen import configured, listen
from search.server.snapshot_library import SnapshotLibrary

HEAD = b"GET /api/search?q=walks HTTP/1.1\r\nHost: 127.0.0.1\r\n"
UPLOAD = b"POST /api/describe?name=x.bvh HTTP/1.1\r\nHost: 127.0.0.1\r\nContent-Length: 1000\r\n\r\nHIER"


@pytest.fixture(scope="module")
def port(indexed, tiny_bundle) -> Iterator[int]:
    """The port of a server in a thread."""
    app = create_app(SnapshotLibrary.open(indexed, bundle=Bundle.load(tiny_bundle, threads=1)))
    listening = listen("127.0.0.1", 0)
    server = uvicorn.Server(configured(app))
    thread = threading.Thread(target=server.run, kwargs={"sockets": [listening]})
    thread.start()
    number = listening.getsockname()[1]
    assert ask(number, HEAD + b"\r\n")[0] == 200
    yield number
    server.should_exit = True
    thread.join()


def connect(port, sent=b""):
    found = socket.create_connection(("127.0.0.1", port), timeout=20)
    found.sendall(sent)
    return found


def answer(connection):
    """Status and document of one response."""
    data = b""
    while b"\r\n\r\n" not in data or b"content-length" not in data:
        piece = connection.recv(1 << 16)
        if not piece:
            return None
        data += piece
    head, _, body = data.partition(b"\r\n\r\n")
    length = next(int(line[15:]) for line in head.lower().splitlines() if line.startswith(b"content-length:"))
    while len(body) < length:
        body += connection.recv(1 << 16)
    return int(head.split()[1]), json.loads(body)


def ask(port, sent):
    with connect(port, sent) as connection:
        return answer(connection)


@pytest.mark.parametrize(
    ("sent", "code", "said"),
    [
        (b"hello\r\n\r\n", 400, "no valid HTTP"),
        (b"\x16\x03\x01\x02\x00\x01\x00\x01\xfc\x03\x03" + bytes(200), 400, "no valid HTTP"),
        (b"MAKE / HTTP/1.1\r\nHost: 127.0.0.1\r\n\r\n", 400, "no valid HTTP"),
        (b"GET / HTTP/9.9\r\nHost: 127.0.0.1\r\n\r\n", 400, "no valid HTTP"),
        (b"GET /\xff HTTP/1.1\r\nHost: 127.0.0.1\r\n\r\n", 400, "no valid HTTP"),
        (HEAD + b"Content-Length: many\r\n\r\n", 400, "no valid HTTP"),
        (HEAD + b"No colon\r\n\r\n", 400, "no valid HTTP"),
        (b"GET /api/search?q=" + b"a" * 20_000 + b" HTTP/1.1\r\nHost: 127.0.0.1\r\n\r\n", 414, "16 kB"),
        (HEAD + b"X: " + b"a" * 70_000 + b"\r\n\r\n", 431, "64 kB"),
        (HEAD + b"X: " + b"a" * 90_000, 431, "64 kB"),
        (HEAD + b"X: a\r\n" * 20_000 + b"\r\n", 431, "64 kB"),
        (b"GET /api/search?q=walks HTTP/1.1\r\n\r\n", 421, "host"),
        (b"GET /api/nothing HTTP/1.1\r\nHost: 127.0.0.1\r\n\r\n", 404, ""),
        (b"PROPFIND /api/search?q=walks HTTP/1.1\r\nHost: 127.0.0.1\r\n\r\n", 405, ""),
        (b"DELETE / HTTP/1.1\r\nHost: 127.0.0.1\r\n\r\n", 405, ""),
        (UPLOAD.replace(b"1000", b"1000000000"), 413, "larger"),
        (HEAD.replace(b"walks", b"a" * 600) + b"\r\n", 422, "at most 500"),
    ],
)
def test_errors_keep_their_form_whatever_is_sent(port, sent, code, said):
    found, document = ask(port, sent)
    assert found == code
    assert list(document) == ["error"]
    assert said in document["error"]


@pytest.mark.parametrize("count", [500, pytest.param(1000, marks=pytest.mark.slow)])
@pytest.mark.parametrize("sent", [b"", HEAD, UPLOAD], ids=["silent", "half a head", "half an upload"])
def test_connections_that_ask_nothing_shut_nobody_out(port, count, sent):
    with ExitStack() as stack:
        for _ in range(count):
            stack.enter_context(connect(port, sent))
        began = time.monotonic()
        for _ in range(3):
            assert ask(port, HEAD + b"\r\n")[0] == 200
        assert time.monotonic() - began < 5


def test_an_upload_is_read_while_others_are_half_sent(port):
    with ExitStack() as stack:
        for _ in range(50):
            stack.enter_context(connect(port, UPLOAD))
        time.sleep(0.2)
        code, document = ask(port, UPLOAD + bytes(996))
        assert (code, "x.bvh" in document["error"]) == (422, True)


def test_who_is_late_is_told_and_who_is_silent_is_left(port, monkeypatch):
    monkeypatch.setattr(connections, "HEAD_SECONDS", 0.3)
    with connect(port) as silent, connect(port, HEAD) as slow:
        with contextlib.suppress(ConnectionError):
            for _ in range(4):
                time.sleep(0.1)
                slow.sendall(b"X: y\r\n")  # not even by sending on and on
        assert answer(slow) == (408, {"error": "the request was not complete within 0.3 s"})
        assert silent.recv(1) == b""


def test_a_connection_is_kept_for_the_next_request_and_not_for_ever(port, monkeypatch):
    monkeypatch.setattr(connections, "KEEP_SECONDS", 0.3)
    with connect(port, HEAD + b"\r\n") as connection:
        assert answer(connection)[0] == 200
        connection.sendall(HEAD + b"\r\n")
        assert answer(connection)[0] == 200
        assert connection.recv(1) == b""


def test_who_does_not_take_the_answers_is_left(port, monkeypatch):
    monkeypatch.setattr(connections, "TAKE_SECONDS", 0.3)
    asked = b"GET /openapi.json HTTP/1.1\r\nHost: 127.0.0.1\r\n\r\n"
    with connect(port, asked * 1000) as connection:

        def ask_on() -> None:
            for _ in range(600):  # the answers fill what the system holds for a client, however slowly they are made
                time.sleep(0.05)
                connection.sendall(asked)

        with pytest.raises(ConnectionError):
            ask_on()
