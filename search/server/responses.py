"""JSON responses: documents, and errors in the form `{"error": "..."}`."""

from __future__ import annotations

import json
from typing import Any

from fastapi import Response
from fastapi.responses import JSONResponse


def to_json(content: Any) -> bytes:
    """A document as compact JSON; numbers must be finite."""
    return json.dumps(content, allow_nan=False, separators=(",", ":")).encode()


def json_response(content: Any) -> Response:
    """A document as a response."""
    return bytes_response(to_json(content))


def bytes_response(document: bytes) -> Response:
    """A document that is JSON already as a response."""
    return Response(document, media_type="application/json", headers={"Cache-Control": "no-store"})


def error_response(code: int, message: str) -> JSONResponse:
    """An error as a response."""
    headers = {"Cache-Control": "no-store"}
    if code == 503:
        headers["Retry-After"] = "1"
    if code == 401:
        headers["WWW-Authenticate"] = "Bearer"
    return JSONResponse({"error": message}, code, headers)
