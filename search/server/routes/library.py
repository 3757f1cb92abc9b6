"""Routes of the whole library: statistics and the map."""

from __future__ import annotations

from importlib.metadata import version
from typing import Any

from fastapi import APIRouter, Response

from search.server import response_models
from search.server.app_state import AppState
from search.server.exception_handlers import ANY, ok
from search.server.responses import bytes_response, json_response

#: Seconds that a request waits for a map that is being laid out; those of small libraries are ready by then.
_PATIENCE = 2.0
LAYING_OUT: dict[int | str, dict[str, Any]] = {
    202: {"model": response_models.MapProgress, "description": "The map is being laid out; ask again"}
}


def routes(state: AppState) -> APIRouter:
    """The routes of the library."""
    router = APIRouter(prefix="/api", tags=["library"], default_response_class=Response, responses=ANY)
    library = state.library

    @router.get("/stats", responses=ok(response_models.StatsResponse))
    def stats() -> Response:
        """Statistics of the library; roots by name, as absolute paths are not published."""
        with library.reading():
            found = library.stats()
            del found["folder"]
            return json_response(found | {"roots": library.root_names, "version": version("motionseek")})

    @router.get("/map", responses=ok(response_models.MapResponse) | LAYING_OUT)
    def whole_map() -> Response:
        """Every clip as a point of a plane, similar clips close together, with its nearest sentence."""
        job = state.maps.current()
        document = job.wait(_PATIENCE)
        return json_response(job.status(), 202) if document is None else bytes_response(document)

    return router
