"""Routes of the whole library: statistics and the map."""

from __future__ import annotations

from importlib.metadata import version

from fastapi import APIRouter, Response

from search.map import map_file
from search.map.layout import make_map
from search.query.vocabulary import vocabulary
from search.server import response_models
from search.server.app_state import AppState
from search.server.exception_handlers import ANY, ok
from search.server.responses import JsonAnswer, bytes_response, json_response


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

    @router.get("/map", responses=ok(response_models.MapResponse))
    async def whole_map() -> Response:
        """Every clip as a point of a plane, similar clips close together, with its nearest sentence."""
        return bytes_response(await state.cached(("map",), lambda: _map(state)))

    return router


def _map(state: AppState) -> JsonAnswer:
    library, snapshot = state.library, state.library.snapshot
    folder = library.folder / "previews"
    library_map = map_file.load(folder, snapshot.generation)
    if library_map is None:
        rows, texts = snapshot.clips.rows, vocabulary()
        text_vectors = library.bundle.encode_texts(list(texts))
        library_map = make_map(snapshot.generation, rows.owners, rows.vectors.astype("float32"), texts, text_vectors)
        map_file.save(folder, library_map)
    return JsonAnswer(library_map.document())
