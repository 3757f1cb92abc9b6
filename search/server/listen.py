"""Listening: a socket on a free port, the server on it, and its URL."""

from __future__ import annotations

import socket
from collections.abc import Callable
from contextlib import suppress

import uvicorn
from starlette.types import ASGIApp

from search.server.connections import KEEP_SECONDS, BoundedProtocol

PORT = 8420

#: Ports tried, the default one first.
PORTS_TRIED = 20
_GRACE = 3  # seconds for requests in flight at shutdown
#: Connections accepted before those accepted are looked at, each of which takes a file descriptor.
_BACKLOG = 256


class PortTaken(OSError):
    """No socket can be bound to the port."""


def listen(host: str, port: int | None) -> socket.socket:
    """A socket that listens on `port`, or with None on the default port or the next one that is free.

    Raises
    ------
    PortTaken
        If no socket can be bound; the message says why and what to do.
    """
    ports = range(PORT, PORT + PORTS_TRIED) if port is None else (port,)
    for number in ports:
        try:
            return _bound(host, number)
        except OSError as error:
            problem = error
    what = f"ports {ports[0]} to {ports[-1]}" if port is None else f"port {port}"
    reason = (problem.strerror or str(problem)).lower()
    raise PortTaken(f"cannot listen on {what} of {host} ({reason}); name a free one with --port")


def _bound(host: str, port: int) -> socket.socket:
    family, kind, protocol, _, address = socket.getaddrinfo(host, port, type=socket.SOCK_STREAM)[0]
    listening = socket.socket(family, kind, protocol)
    try:
        with suppress(AttributeError):
            # Windows lets two servers share a port unless this is set.
            listening.setsockopt(socket.SOL_SOCKET, socket.SO_EXCLUSIVEADDRUSE, 1)  # type: ignore[attr-defined,unused-ignore]
        if not hasattr(socket, "SO_EXCLUSIVEADDRUSE"):
            listening.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        listening.bind(address)
        listening.listen(_BACKLOG)
    except OSError:
        listening.close()
        raise
    return listening


def address(listening: socket.socket, host: str) -> str:
    """The URL for a browser on this computer."""
    name = "127.0.0.1" if host in ("0.0.0.0", "") else "[::1]" if host == "::" else f"[{host}]" if ":" in host else host
    return f"http://{name}:{listening.getsockname()[1]}/"


def serve(app: ASGIApp, listening: socket.socket, *, ready: Callable[[], None] = lambda: None) -> None:
    """Serve until interrupted; `ready` is called when the server accepts requests."""

    class Server(uvicorn.Server):
        async def startup(self, sockets: list[socket.socket] | None = None) -> None:
            await super().startup(sockets)
            ready()

    Server(configured(app)).run(sockets=[listening])


def configured(app: ASGIApp) -> uvicorn.Config:
    """How uvicorn serves the app."""
    return uvicorn.Config(
        app,
        log_level="warning",
        access_log=False,
        server_header=False,
        proxy_headers=False,
        http=BoundedProtocol,
        ws="none",
        timeout_keep_alive=round(KEEP_SECONDS),
        timeout_graceful_shutdown=_GRACE,
        backlog=_BACKLOG,
    )
