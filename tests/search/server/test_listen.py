"""`motionseek serve` as a process: its port, its address, its end."""

from __future__ import annotations

import json
import os
import signal
import socket
import subprocess
import sys
import time
import urllib.request
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

from search.server import listen as running
from search.server.listen import PortTaken, address, listen

_PROGRAM = (
    "import sys, encoders.bundle.bundle; encoders.bundle.bundle.DEFAULT = __import__('pathlib').Path(sys.argv.pop(1)); "
)
Started = Callable[..., Iterator[tuple[subprocess.Popen[str], str]]]


@pytest.fixture
def started(indexed: Path, tiny_bundle: Path) -> Callable[..., object]:
    """Runs the command until the end of the block; gives the process and its first line."""

    @contextmanager
    def start(*arguments: str) -> Iterator[tuple[subprocess.Popen[str], str]]:
        program = _PROGRAM + "from search.cli.main import main; main(['serve', *sys.argv[1:]])"
        process = subprocess.Popen(
            [sys.executable, "-c", program, str(tiny_bundle), str(indexed), *arguments],
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
            env={**os.environ, "OMP_NUM_THREADS": "1", "PYTHONUNBUFFERED": "1"},
        )
        try:
            assert process.stdout is not None
            yield process, process.stdout.readline()
        finally:
            process.kill()
            process.communicate()

    return start


def _free_port() -> int:
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return int(probe.getsockname()[1])


@pytest.mark.slow
@pytest.mark.skipif(sys.platform == "win32", reason="Windows sends no SIGINT to one process")
def test_the_server_prints_its_url_and_stops_at_ctrl_c(started):
    port = _free_port()
    with started("--port", str(port)) as (process, line):
        assert f"http://127.0.0.1:{port}/" in line
        assert line.startswith("5 clips")
        with urllib.request.urlopen(f"http://127.0.0.1:{port}/api/search?q=walks", timeout=10) as response:
            assert len(json.load(response)["hits"]) == 5
        process.send_signal(signal.SIGINT)
        _, said = process.communicate(timeout=10)
        assert (process.returncode, said) == (0, "stopped\n")


@pytest.mark.slow
def test_a_slow_upload_does_not_block_others(started):
    port = _free_port()
    with started("--port", str(port)) as _, socket.create_connection(("127.0.0.1", port)) as slow:
        slow.sendall(b"POST /api/describe?name=x.bvh HTTP/1.1\r\nHost: 127.0.0.1\r\nContent-Length: 1000\r\n\r\nHIER")
        began = time.monotonic()
        with urllib.request.urlopen(f"http://127.0.0.1:{port}/api/search?q=walks", timeout=10) as response:
            assert response.status == 200
        assert time.monotonic() - began < 5


def test_a_port_in_use_is_an_error(run, indexed):
    with socket.socket() as other:
        other.bind(("127.0.0.1", 0))
        other.listen()
        port = other.getsockname()[1]
        ran = run("serve", indexed, "--port", port)
    assert ran.code == 1
    assert f"cannot listen on port {port}" in ran.err
    assert "--port" in ran.err
    assert ran.err.count("\n") == 1


def test_without_a_port_the_next_free_one_is_taken(monkeypatch):
    monkeypatch.setattr(running, "PORT", _free_port())
    with listen("127.0.0.1", None) as first, listen("127.0.0.1", None) as second:
        assert first.getsockname()[1] == running.PORT
        assert second.getsockname()[1] > running.PORT


def test_the_error_names_all_ports_that_were_tried(monkeypatch):
    monkeypatch.setattr(running, "PORTS_TRIED", 1)
    monkeypatch.setattr(running, "PORT", _free_port())
    with listen("127.0.0.1", None), pytest.raises(PortTaken, match=f"ports {running.PORT} to {running.PORT}"):
        listen("127.0.0.1", None)


def test_an_address_of_another_computer_is_an_error(run, indexed):
    ran = run("serve", indexed, "--host", "192.0.2.1", "--token", "x" * 16, "--port", 8420)
    assert (ran.code, "192.0.2.1" in ran.err) == (1, True)


@pytest.mark.parametrize("host", ["0.0.0.0", "::", "192.168.0.7", "studio.example"])
def test_other_computers_need_a_token(run, indexed, host):
    ran = run("serve", indexed, "--host", host)
    assert (ran.code, "--token" in ran.err) == (2, True)


def test_the_printed_link_signs_in(started):
    port = _free_port()
    with started("--port", str(port), "--token", "q3J+8kd/Zm1&PqTy%#aBc9w==") as (_, line):
        asking = urllib.request.Request(line.split(" at ")[1].split()[0])
        opener = urllib.request.build_opener(urllib.request.HTTPCookieProcessor())
        with opener.open(asking, timeout=10), opener.open(f"http://127.0.0.1:{port}/api/stats", timeout=10) as answer:
            assert json.load(answer)["clips"] == 5


@pytest.mark.parametrize("token", ["sixteen letters and spaces", "schlüsselwörter-1234"])
def test_a_token_that_fits_no_header_is_refused(run, indexed, token):
    ran = run("serve", indexed, "--token", token)
    assert (ran.code, "ASCII" in ran.err) == (2, True)


def test_a_short_token_is_refused(run, indexed):
    ran = run("serve", indexed, "--token", "secret")
    assert (ran.code, "16" in ran.err) == (2, True)


def test_a_folder_without_a_library_is_an_error(run, tmp_path):
    ran = run("serve", tmp_path)
    assert (ran.code, "motionseek index" in ran.err) == (1, True)


@pytest.mark.parametrize(
    ("host", "url"),
    [("127.0.0.1", "http://127.0.0.1:"), ("localhost", "http://localhost:"), ("0.0.0.0", "http://127.0.0.1:")],
)
def test_the_address_a_browser_opens(host, url):
    with listen(host, None) as listening:
        assert address(listening, host) == f"{url}{listening.getsockname()[1]}/"
