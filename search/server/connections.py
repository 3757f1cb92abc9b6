"""Connections: how long and how much a client may send before it has asked anything, and who gives way to others.

A connection costs a file descriptor, of which there are some thousand. Where very many are open, the one that has kept
the server waiting for longest is closed in favour of a new one: silent and half-sent ones shut nobody out.
"""

from __future__ import annotations

import asyncio
from http import HTTPStatus

from uvicorn.protocols.http.httptools_impl import HttpToolsProtocol

from search.server.responses import to_json

#: Connections that are open at the same time.
MOST = 400

#: Seconds for the head of a request from its first byte on, for a client to take what it is sent, and for which a
#: connection is kept after a response.
HEAD_SECONDS, TAKE_SECONDS, KEEP_SECONDS = 10.0, 60.0, 30.0

#: Bytes of an address, and of a whole head.
MAX_ADDRESS, MAX_HEAD = 16 << 10, 64 << 10


class BoundedProtocol(HttpToolsProtocol):
    """HTTP/1.1 with limits; what uvicorn refuses by itself is answered as any other error."""

    _late: asyncio.TimerHandle | None = None
    _refusal = (400, "this is no valid HTTP request")
    _waiting_since = 0.0
    _head_bytes = 0
    _in_head = True

    def connection_made(self, transport: asyncio.Transport) -> None:  # type: ignore[override]
        """Accept a connection, in place of another one where there are too many."""
        super().connection_made(transport)
        self._wait(HEAD_SECONDS)
        if len(self.connections) > MOST and not self._evict_another():
            self._refuse(503, "server busy; try again in a moment")

    def connection_lost(self, exc: Exception | None) -> None:
        """Forget the connection."""
        self._stop_waiting()
        super().connection_lost(exc)

    def data_received(self, data: bytes) -> None:
        """Take what a client sends."""
        if self.transport.is_closing():
            return
        if self._in_head:
            self._head_bytes += len(data)
        else:
            self._waiting_since = self.loop.time()
        super().data_received(data)
        if self._in_head and self._head_bytes > MAX_HEAD and not self.transport.is_closing():
            self._refuse(431, f"the head of the request is longer than {MAX_HEAD >> 10} kB")

    def on_message_begin(self) -> None:
        """Begin the head of a request."""
        super().on_message_begin()
        self._in_head = True
        if not self.flow.write_paused:
            self._wait(HEAD_SECONDS)

    def on_headers_complete(self) -> None:
        """End the head of a request; what is raised here ends in `send_400_response`."""
        if len(self.url) > MAX_ADDRESS:
            self._refusal = 414, f"the address is longer than {MAX_ADDRESS >> 10} kB"
        elif sum(len(name) + len(value) + 4 for name, value in self.headers) > MAX_HEAD:
            self._refusal = 431, f"the head of the request is longer than {MAX_HEAD >> 10} kB"
        if self._refusal[0] != 400:
            raise ValueError(self._refusal)
        self._in_head, self._head_bytes = False, 0
        if not self.flow.write_paused:  # asking for more does not take what was sent
            self._stop_waiting()
        super().on_headers_complete()

    def on_response_complete(self) -> None:
        """Wait for the next request."""
        super().on_response_complete()
        if not self.flow.write_paused:
            self._wait(KEEP_SECONDS)

    def pause_writing(self) -> None:
        """Wait for the client to take what it was sent."""
        super().pause_writing()
        self._wait(TAKE_SECONDS)

    def resume_writing(self) -> None:
        """Go on sending."""
        super().resume_writing()
        if self._is_idle:
            self._wait(KEEP_SECONDS)
        else:
            self._stop_waiting()

    def send_400_response(self, msg: str) -> None:
        """Refuse what is no request."""
        self._refuse(*self._refusal)

    @property
    def waits_since(self) -> float | None:
        """When the server began to wait for this client; None while the client waits for an answer."""
        if self._is_idle or self.cycle.more_body or self.flow.write_paused:
            return self._waiting_since
        return None

    @property
    def _is_idle(self) -> bool:
        return self.cycle is None or self.cycle.response_complete

    def _evict_another(self) -> bool:
        """Close the connection that the server has waited for longest; False where it waits for none."""
        waiting = [
            (since, id(other), other)
            for other in self.connections
            if isinstance(other, BoundedProtocol) and other is not self and (since := other.waits_since) is not None
        ]
        if waiting:
            min(waiting)[2].transport.abort()
        return bool(waiting)

    def _wait(self, seconds: float) -> None:
        self._stop_waiting()
        self._waiting_since = self.loop.time()
        self._late = self.loop.call_later(seconds, self._give_up)

    def _stop_waiting(self) -> None:
        if self._late is not None:
            self._late.cancel()
            self._late = None

    def _give_up(self) -> None:
        if self.flow.write_paused:
            self.transport.abort()
        elif self._is_idle and self._in_head and self._head_bytes:
            self._refuse(408, f"the request was not complete within {HEAD_SECONDS:g} s")
        elif self._is_idle:
            self.transport.close()

    def _refuse(self, code: int, message: str) -> None:
        body = to_json({"error": message})
        head = f"HTTP/1.1 {code} {HTTPStatus(code).phrase}\r\ncontent-type: application/json\r\nconnection: close\r\n"
        self.transport.write(f"{head}content-length: {len(body)}\r\ncache-control: no-store\r\n\r\n".encode() + body)
        self.transport.close()
