"""Who may ask: the checks that every request passes before any route sees it, and the headers every answer carries."""

from __future__ import annotations

import hashlib
import hmac
import ipaddress
import re
from collections.abc import Iterable
from urllib.parse import parse_qs, urlencode

from starlette.datastructures import Headers, MutableHeaders
from starlette.responses import RedirectResponse, Response
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from search.server.exception_handlers import refusal

#: Before the port: a browser sends the cookies of all ports of a computer to each of them.
COOKIE = "motionseek_token_"
LOOPBACK = ("127.0.0.1", "::1", "localhost")
_ANYWHERE = ("0.0.0.0", "::", "")

#: Answered without a token: says nothing of the library, and monitors ask it.
_OPEN = "/healthz"

_HOST = re.compile(r"(\[(?P<address>[0-9a-fA-F:.]+)\]|(?P<name>[^\s:/?#@\[\]\\]+))(:(?P<port>\d+))?")

_POLICY = (
    "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' data: blob:; font-src 'self'; "
    "connect-src 'self'; worker-src 'self'; manifest-src 'self'; base-uri 'none'; form-action 'none'; "
    "frame-ancestors 'none'"
)
_HEADERS = {
    "Content-Security-Policy": _POLICY,
    "X-Content-Type-Options": "nosniff",
    "X-Frame-Options": "DENY",
    "Referrer-Policy": "no-referrer",
    "Cross-Origin-Opener-Policy": "same-origin",
    "Cross-Origin-Resource-Policy": "same-origin",
    "Permissions-Policy": "camera=(), microphone=(), geolocation=()",
}


def is_loopback(host: str) -> bool:
    """Whether only this computer reaches a server bound to `host`."""
    try:
        return ipaddress.ip_address(host).is_loopback
    except ValueError:
        return host == "localhost"


class SecurityMiddleware:
    """ASGI middleware: refuses unknown hosts, other sites and askers without the token.

    Parameters
    ----------
    host : str
        What the server is bound to.
    names : iterable of str
        Further names it is known by.
    token : str, optional
        What every request must carry.
    """

    def __init__(self, app: ASGIApp, *, host: str, names: Iterable[str] = (), token: str | None = None) -> None:
        self._app = app
        self._names = {name.lower() for name in (*LOOPBACK, host, *names)} - set(_ANYWHERE)
        self._any_address = host in _ANYWHERE
        self._token = token
        self._cookie = hashlib.sha256((token or "").encode()).hexdigest()

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        if scope["type"] != "http":
            await self._app(scope, receive, send)
            return

        async def send_guarded(message: Message) -> None:
            if message["type"] == "http.response.start":
                MutableHeaders(scope=message).update(_HEADERS)
            await send(message)

        answer = self._refusal(scope, Headers(scope=scope))
        await (answer or self._app)(scope, receive, send_guarded)

    def _refusal(self, scope: Scope, headers: Headers) -> Response | None:
        """What is answered in place of a route; None to let the request pass."""
        if not self._knows(headers.get("host", "")):
            return refusal(421, "this computer is not known by that name; add it with --allow-host")
        if not _same_site(scope, headers):
            return refusal(403, "another site may not ask; open the page of this server")
        if self._token is None or scope["path"] == _OPEN or self._carries_token(headers):
            return None
        return self._signed_in(scope, headers) or refusal(
            401, "a token is needed: open /?token=TOKEN, or send it as Bearer"
        )

    def _knows(self, host: str) -> bool:
        """Whether a Host header names this server: another name means that a DNS entry was pointed here."""
        found = _HOST.fullmatch(host)
        name = (found["address"] or found["name"]).lower() if found else ""
        return name in self._names or (self._any_address and _is_address(name))

    def _carries_token(self, headers: Headers) -> bool:
        kind, _, given = headers.get("authorization", "").partition(" ")
        bears = kind.lower() == "bearer" and self._is_token(given.strip())
        return bears or hmac.compare_digest(_cookie(headers).encode(), self._cookie.encode())

    def _is_token(self, given: str) -> bool:
        return self._token is not None and hmac.compare_digest(given.encode(), self._token.encode())

    def _signed_in(self, scope: Scope, headers: Headers) -> Response | None:
        """The page again, with a cookie in place of the token in its address."""
        asked = parse_qs(scope["query_string"].decode("latin-1"))
        if scope["path"] != "/" or not self._is_token(asked.pop("token", [""])[0]):
            return None
        rest = urlencode(asked, doseq=True)
        response = RedirectResponse("/" + (f"?{rest}" if rest else ""), 303, {"Cache-Control": "no-store"})
        response.set_cookie(_cookie_name(headers), self._cookie, httponly=True, samesite="strict", path="/")
        return response


def _same_site(scope: Scope, headers: Headers) -> bool:
    """Whether no other site's page makes the request; following a link to the page is no such thing."""
    origin = headers.get("origin")
    if origin is not None and origin.lower().partition("://")[2] != headers.get("host", "").lower():
        return False
    site = headers.get("sec-fetch-site", "none")
    follows_link = scope["path"] == "/" and scope["method"] == "GET" and headers.get("sec-fetch-mode") == "navigate"
    return site in ("none", "same-origin") or follows_link


def _is_address(name: str) -> bool:
    try:
        ipaddress.ip_address(name)
    except ValueError:
        return False
    return True


def _cookie_name(headers: Headers) -> str:
    found = _HOST.fullmatch(headers.get("host", ""))
    return COOKIE + ((found["port"] if found else None) or "")


def _cookie(headers: Headers) -> str:
    """The value of our cookie; others may hold what no parser takes."""
    name = _cookie_name(headers)
    pairs = (pair.strip().partition("=") for pair in headers.get("cookie", "").split(";"))
    return next((value for key, _, value in pairs if key == name), "")
