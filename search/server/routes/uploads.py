"""Routes of files that a client brings: what can be read, and reading them."""

from __future__ import annotations

from typing import Annotated

from fastapi import APIRouter, Query, Request, Response
from starlette.exceptions import HTTPException

from indexer.formats.table import FORMATS
from search.server import response_models
from search.server.app_state import AppState
from search.server.exception_handlers import ANY, UPLOAD, ok
from search.server.parameters import FILE_BODY, FileName
from search.server.responses import json_response

_MOST_FILES = 64
_Names = Annotated[list[FileName], Query(max_length=_MOST_FILES, description="The motion's name, then companions'.")]
_Sizes = Annotated[
    list[Annotated[int, Query(ge=0, le=1 << 40)]],
    Query(max_length=_MOST_FILES, description="The size of each file in bytes; may be left out for a single one."),
]


def routes(state: AppState) -> APIRouter:
    """The routes of files that a client brings."""
    router = APIRouter(prefix="/api", tags=["uploads"], default_response_class=Response, responses=ANY)

    @router.get("/formats", responses=ok(response_models.FormatsResponse))
    async def formats() -> Response:
        """The formats that can be read, and the files that they may need beside them."""
        rows = [
            {
                "ending": row.ending,
                "companion": row.companion.ending if row.companion else None,
                "same_name": row.companion is not None and row.companion.same_name,
            }
            for row in FORMATS
        ]
        return json_response({"formats": rows})

    @router.post("/uploads", openapi_extra=FILE_BODY, responses=ok(response_models.UploadsResponse) | UPLOAD)
    async def upload(request: Request, name: _Names, size: _Sizes = []) -> Response:  # noqa: B006
        """Read a motion file, with the files that it needs behind it in the body: every motion in it."""
        if not name or len(size) != (len(name) if size or len(name) > 1 else 0):
            raise HTTPException(422, "size: one is needed for each name")
        sizes: list[int | None] = [*size] if size else [None]
        found = await state.uploads.receive_files(request, list(zip(name, sizes, strict=True)))
        return json_response({"motions": [one.document() for one in found]})

    return router
