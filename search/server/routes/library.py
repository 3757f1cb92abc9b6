"""Routes of the whole library: statistics and the map."""

from __future__ import annotations

from importlib.metadata import version
from typing import Any

from fastapi import APIRouter, Response

from search.map import map_file
from search.map.layout import Progress, make_map
from search.map.layout_job import LayoutJobs
from search.query.vocabulary import vocabulary
from search.server import response_models
from search.server.app_state import AppState
from search.server.exception_handlers import ANY, ok
from search.server.responses import bytes_response, json_response, to_json
from search.server.served.served_library import ServedLibrary, State

#: Seconds that a request waits for a map that is being laid out; those of small libraries are ready by then.
_PATIENCE = 2.0
LAYING_OUT: dict[int | str, dict[str, Any]] = {
    202: {"model": response_models.MapProgress, "description": "The map is being laid out; ask again"}
}


def routes(state: AppState) -> APIRouter:
    """The routes of the library."""
    router = APIRouter(prefix="/api", tags=["library"], default_response_class=Response, responses=ANY)
    library, jobs = state.library, LayoutJobs()

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
        snapshot = library.snapshot
        job = jobs.of(snapshot.generation, snapshot.count, lambda progress: _map(library, snapshot, progress))
        document = job.wait(_PATIENCE)
        return json_response(job.status(), 202) if document is None else bytes_response(document)

    return router


def _map(library: ServedLibrary, snapshot: State, progress: Progress) -> bytes:
    """The map of a snapshot as JSON: that of the library's cache, else laid out and cached."""
    folder = library.previews
    library_map = None if folder is None else map_file.load(folder, snapshot.generation)
    if library_map is None:
        rows, texts = library.clips_of_map(), vocabulary()
        text_vectors, vectors = library.bundle.encode_texts(list(texts)), rows.vectors.astype("float32")
        library_map = make_map(snapshot.generation, rows.owners, vectors, texts, text_vectors, progress)
        if folder is not None:
            map_file.save(folder, library_map)
    return to_json(library_map.document() | {"total": snapshot.count})
