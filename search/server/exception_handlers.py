"""Exceptions as HTTP errors: each class has its code, and no message contains an absolute path."""

from __future__ import annotations

import logging
from collections.abc import Mapping, Sequence
from pathlib import PurePath
from typing import Any

from fastapi import FastAPI, Request
from fastapi.exceptions import RequestValidationError
from fastapi.responses import JSONResponse
from pydantic import BaseModel
from starlette.exceptions import HTTPException

from encoders.errors import (
    BundleError,
    BundleMismatch,
    LibraryDamaged,
    LibraryError,
    LibraryLocked,
    LibraryNotFound,
    MotionSeekError,
    QueryError,
    UnknownClip,
    UnreadableMotion,
)
from search.server.microbatching import ServerBusy
from search.server.responses import error_response

BUSY = "server busy; try again in a moment"

#: Class -> message of a 503. The exception's own message names folders, so it goes to the log only.
_UNAVAILABLE: dict[type[MotionSeekError], str] = {
    LibraryNotFound: "the library is missing",
    LibraryLocked: "the library is locked by another process; try again in a moment",
    LibraryDamaged: "the library is damaged",
    BundleMismatch: "the library was re-encoded with another model; restart the server",
    BundleError: "the model cannot be loaded",
    LibraryError: "the library cannot be read",
}

_LOG = logging.getLogger("motionseek.server")


class ErrorResponse(BaseModel):
    """What is wrong and what to do."""

    error: str


#: OpenAPI: errors of any route.
ANY: dict[int | str, dict[str, Any]] = {
    401: {"model": ErrorResponse, "description": "Token missing or wrong"},
    403: {"model": ErrorResponse, "description": "Cross-origin request rejected"},
    421: {"model": ErrorResponse, "description": "Unknown host name"},
    422: {"model": ErrorResponse, "description": "Invalid argument"},
    503: {"model": ErrorResponse, "description": "Server busy, or the library or the model is unavailable"},
}
#: OpenAPI: further errors of routes that take a clip.
NO_CLIP: dict[int | str, dict[str, Any]] = {404: {"model": ErrorResponse, "description": "Unknown clip"}}
#: OpenAPI: further errors of routes that take an upload.
UPLOAD: dict[int | str, dict[str, Any]] = {
    408: {"model": ErrorResponse, "description": "Upload timed out"},
    413: {"model": ErrorResponse, "description": "Upload too large"},
}


def ok(model: type[BaseModel]) -> dict[int | str, dict[str, Any]]:
    """OpenAPI: the response model of a route."""
    return {200: {"model": model}}


def install(app: FastAPI) -> None:
    """Register the handlers with an app."""

    @app.exception_handler(RequestValidationError)
    async def invalid_parameter(_: Request, error: RequestValidationError) -> JSONResponse:
        return error_response(422, "; ".join(f"{_parameter(entry['loc'])}: {_said(entry)}" for entry in error.errors()))

    @app.exception_handler(HTTPException)
    async def http_error(_: Request, error: HTTPException) -> JSONResponse:
        unknown_route = error.status_code == 404 and error.detail == "Not Found"
        response = error_response(
            error.status_code, "no such route; /openapi.json lists them" if unknown_route else error.detail
        )
        response.headers.update(error.headers or {})
        return response

    @app.exception_handler(QueryError)
    async def invalid_query(_: Request, error: QueryError) -> JSONResponse:
        return error_response(422, str(error))

    @app.exception_handler(UnreadableMotion)
    async def unreadable(_: Request, error: UnreadableMotion) -> JSONResponse:
        return error_response(422, f"{PurePath(error.path).name}: {error.reason}")

    @app.exception_handler(UnknownClip)
    async def unknown_clip(_: Request, error: UnknownClip) -> JSONResponse:
        return error_response(404, "no such clip; it may have been removed")

    @app.exception_handler(LibraryError)
    @app.exception_handler(BundleError)
    @app.exception_handler(BundleMismatch)
    async def unavailable(_: Request, error: MotionSeekError) -> JSONResponse:
        _LOG.error("%s", error)
        message = next(said for kind, said in _UNAVAILABLE.items() if isinstance(error, kind))
        return error_response(503, f"{message}; details are in the server's log")

    @app.exception_handler(ServerBusy)
    async def busy(_: Request, error: ServerBusy) -> JSONResponse:
        return error_response(503, BUSY)

    @app.exception_handler(Exception)
    async def unexpected(_: Request, error: Exception) -> JSONResponse:
        return error_response(500, "internal error, see the server's log")


#: Pydantic's type of an error -> what the parameter must be; braces are filled in from the error's context.
_SAID = {
    "missing": "is missing",
    "string_pattern_mismatch": "must be a clip's number, such as 12 or #12, or the key of an upload",
    "int_parsing": "must be a whole number",
    "int_from_float": "must be a whole number",
    "float_parsing": "must be a number",
    "finite_number": "must be a finite number",
    "bool_parsing": "must be true or false",
    "greater_than_equal": "must be {ge} or more",
    "less_than_equal": "must be {le} or less",
    "string_too_short": "must not be empty",
    "string_too_long": "must have at most {max_length} characters",
    "too_long": "can be given at most {max_length} times",
    "literal_error": "must be {expected}",
}


def _said(error: Mapping[str, Any]) -> str:
    """What is wrong with a parameter and what it must be."""
    known = _SAID.get(error["type"])
    return str(error["msg"]) if known is None else known.format(**error.get("ctx", {}))


def _parameter(location: Sequence[str | int]) -> str:
    """The name of the parameter at a location, without the index of the value where it is given several times."""
    return next(part for part in reversed(location) if isinstance(part, str))
