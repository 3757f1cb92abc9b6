"""Security: the checks of every request (host, origin, token) and the security headers of every response."""

from __future__ import annotations

import hashlib
import hmac
import ipaddress
import re
from collections.abc import Iterable
from urllib.parse import parse_qs, urlencode

from starlette.datastructures import Headers, MutableHeaders
from starlette.responses import FileResponse, RedirectResponse, Response
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from search.server.responses import error_response
from search.server.static_page import FOLDER, MEDIA_TYPES

#: Followed by the port: browsers send the cookies of all ports of a host to each of them.
COOKIE = "motionseek_token_"
LOOPBACK = ("127.0.0.1", "::1", "localhost")
_ANYWHERE = ("0.0.0.0", "::", "")

#: Need no token, as they tell nothing about the library: what monitoring polls, and what the sign-in page is made of.
_PUBLIC = {"/healthz", "/sign_in.js", "/style.css", "/icon.svg", "/vendor/inter/inter-latin-wght-normal.woff2"}
_SIGN_IN = "/sign-in"

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
    """Whether a server bound to `host` is reachable from this computer only."""
    try:
        return ipaddress.ip_address(host).is_loopback
    except ValueError:
        return host == "localhost"


class SecurityMiddleware:
    """ASGI middleware that rejects unknown hosts, cross-origin requests and requests without the token.

    Parameters
    ----------
    host : str
        The address the server is bound to.
    names : iterable of str
        Further host names that requests may use.
    token : str, optional
        The secret that every request must carry.
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

        async def send_with_headers(message: Message) -> None:
            if message["type"] == "http.response.start":
                MutableHeaders(scope=message).update(_HEADERS)
            await send(message)

        rejection = self._rejection(scope, Headers(scope=scope))
        await (rejection or self._app)(scope, receive, send_with_headers)

    def _rejection(self, scope: Scope, headers: Headers) -> Response | None:
        """The response in place of a route's; None where the request passes."""
        if not self._is_known_host(headers.get("host", "")):
            return error_response(421, "unknown host name; add it with --allow-host")
        if not _same_site(scope, headers):
            return error_response(403, "cross-origin request rejected; open this server's own page")
        if self._token is not None and scope["path"] == _SIGN_IN and scope["method"] == "POST" and _bearer(headers):
            return self._signed_in(headers)
        if self._token is None or scope["path"] in _PUBLIC or self._carries_token(headers):
            return None
        return self._redirect(scope, headers) or _unauthorised(scope, headers)

    def _is_known_host(self, host: str) -> bool:
        """Whether a Host header names this server; another name is a sign of DNS rebinding."""
        found = _HOST.fullmatch(host)
        name = (found["address"] or found["name"]).lower() if found else ""
        return name in self._names or (self._any_address and _is_address(name))

    def _carries_token(self, headers: Headers) -> bool:
        return self._is_token(_bearer(headers)) or hmac.compare_digest(_cookie(headers).encode(), self._cookie.encode())

    def _is_token(self, given: str) -> bool:
        return self._token is not None and hmac.compare_digest(given.encode(), self._token.encode())

    def _redirect(self, scope: Scope, headers: Headers) -> Response | None:
        """A redirect to the page that replaces the token in its address by a cookie."""
        query = parse_qs(scope["query_string"].decode("latin-1"))
        if scope["path"] != "/" or not self._is_token(query.pop("token", [""])[0]):
            return None
        rest = urlencode(query, doseq=True)
        response = RedirectResponse("/" + (f"?{rest}" if rest else ""), 303, {"Cache-Control": "no-store"})
        return self._with_cookie(response, headers)

    def _signed_in(self, headers: Headers) -> Response:
        """The answer to the sign-in page, which sends the token as any program does."""
        if not self._is_token(_bearer(headers)):
            return error_response(401, "this is not the token")
        return self._with_cookie(Response(status_code=204, headers={"Cache-Control": "no-store"}), headers)

    def _with_cookie(self, response: Response, headers: Headers) -> Response:
        # Lax, not strict: it comes with a link on another site, and what other sites may not ask is refused anyway.
        response.set_cookie(_cookie_name(headers), self._cookie, httponly=True, samesite="lax", path="/")
        return response


def _unauthorised(scope: Scope, headers: Headers) -> Response:
    """An error; for a browser that opens the page, a form that asks for the token and keeps the address."""
    error = error_response(401, "token missing or wrong; open /?token=TOKEN or send 'Authorization: Bearer TOKEN'")
    if scope["path"] != "/" or "text/html" not in headers.get("accept", ""):
        return error
    return FileResponse(FOLDER / "sign_in.html", 401, {"Cache-Control": "no-store"}, media_type=MEDIA_TYPES[".html"])


def _bearer(headers: Headers) -> str:
    """The token that a request carries in its head."""
    kind, _, given = headers.get("authorization", "").partition(" ")
    return given.strip() if kind.lower() == "bearer" else ""


def _same_site(scope: Scope, headers: Headers) -> bool:
    """Whether a request is same-origin, or no page's at all; following a link to the page is allowed, too."""
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
    """The value of our cookie, parsed leniently: cookies of others may be malformed."""
    name = _cookie_name(headers)
    pairs = (pair.strip().partition("=") for pair in headers.get("cookie", "").split(";"))
    return next((value for key, _, value in pairs if key == name), "")
