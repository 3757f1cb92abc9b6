"""Errors as the server says them: `{"error": "..."}` with the right code."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from fastapi import FastAPI, Request
from fastapi.exceptions import RequestValidationError
from fastapi.responses import JSONResponse
from pydantic import BaseModel
from starlette.exceptions import HTTPException

from encoders.errors import BundleError, BundleMismatch, LibraryError, QueryError, UnreadableMotion
from search.server.microbatching import ServerBusy

BUSY = "too much is asked at once; ask again in a moment"


class ErrorResponse(BaseModel):
    """What is wrong and what to do."""

    error: str


class Refused(Exception):
    """A request that is answered with an error."""

    def __init__(self, code: int, message: str) -> None:
        super().__init__(message)
        self.code = code
        self.message = message


#: Codes that any route may answer with, for its description.
ANY: dict[int | str, dict[str, Any]] = {
    401: {"model": ErrorResponse, "description": "A token is needed"},
    403: {"model": ErrorResponse, "description": "Another site asks"},
    421: {"model": ErrorResponse, "description": "Asked under a name that is not this computer's"},
    422: {"model": ErrorResponse, "description": "What is asked makes no sense"},
    503: {"model": ErrorResponse, "description": "Busy, or model and library do not fit"},
}
#: Beside these, where a clip is named.
NO_CLIP: dict[int | str, dict[str, Any]] = {404: {"model": ErrorResponse, "description": "No such clip"}}
#: Beside these, where a file is uploaded.
UPLOAD: dict[int | str, dict[str, Any]] = {
    408: {"model": ErrorResponse, "description": "The upload took too long"},
    413: {"model": ErrorResponse, "description": "The upload is too large"},
}


def ok(model: type[BaseModel]) -> dict[int | str, dict[str, Any]]:
    """The description of a good answer."""
    return {200: {"model": model}}


def refusal(code: int, message: str) -> JSONResponse:
    """An error as a response."""
    headers = {"Retry-After": "1"} if code == 503 else {}
    if code == 401:
        headers["WWW-Authenticate"] = "Bearer"
    return JSONResponse({"error": message}, code, headers | {"Cache-Control": "no-store"})


def _named(place: Sequence[str | int]) -> str:
    """The parameter at a place, without the number of the value where it has several."""
    return next(part for part in reversed(place) if isinstance(part, str))


def install(app: FastAPI) -> None:
    """Let the app say every error in this way."""

    @app.exception_handler(Refused)
    async def refused(_: Request, error: Refused) -> JSONResponse:
        return refusal(error.code, error.message)

    @app.exception_handler(RequestValidationError)
    async def invalid(_: Request, error: RequestValidationError) -> JSONResponse:
        return refusal(422, "; ".join(f"{_named(entry['loc'])}: {entry['msg']}" for entry in error.errors()))

    @app.exception_handler(HTTPException)
    async def http(_: Request, error: HTTPException) -> JSONResponse:
        said = "there is nothing here; the routes are in /openapi.json" if error.status_code == 404 else error.detail
        response = refusal(error.status_code, said)
        response.headers.update(error.headers or {})
        return response

    @app.exception_handler(QueryError)
    @app.exception_handler(UnreadableMotion)
    async def senseless(_: Request, error: Exception) -> JSONResponse:
        return refusal(422, str(error))

    @app.exception_handler(LibraryError)
    @app.exception_handler(BundleError)
    @app.exception_handler(BundleMismatch)
    async def unusable(_: Request, error: Exception) -> JSONResponse:
        return refusal(503, str(error))

    @app.exception_handler(ServerBusy)
    async def busy(_: Request, error: ServerBusy) -> JSONResponse:
        return refusal(503, BUSY)

    @app.exception_handler(Exception)
    async def unexpected(_: Request, error: Exception) -> JSONResponse:
        return refusal(500, "the server failed at this; what it says where it was started tells more")
