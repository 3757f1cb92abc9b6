"""The library as a whole: its numbers and its map."""

from __future__ import annotations

import json
from importlib.metadata import version

from fastapi import APIRouter, Response

from search.map import map_file
from search.map.layout import make_map
from search.query.vocabulary import vocabulary
from search.server import response_models
from search.server.app_state import AppState
from search.server.exception_handlers import ANY, ok
from search.server.response_models import answer, encoded


def routes(state: AppState) -> APIRouter:
    """The routes about the library."""
    router = APIRouter(prefix="/api", tags=["library"], default_response_class=Response, responses=ANY)
    library = state.library

    @router.get("/stats", responses=ok(response_models.StatsResponse))
    def stats() -> Response:
        """What the library holds, in numbers."""
        return answer(library.stats() | {"version": version("motionseek")})

    @router.get("/map", responses=ok(response_models.MapResponse))
    async def whole_map() -> Response:
        """Every clip as a point of a plane, near where clips are alike, with what it looks like most."""
        return encoded(await state.remembered(("map",), lambda: _map(state)))

    return router


def _map(state: AppState) -> bytes:
    library, snapshot = state.library, state.library.snapshot
    folder = library.folder / "previews"
    library_map = map_file.load(folder, snapshot.generation)
    if library_map is None:
        rows, texts = snapshot.clips.rows, vocabulary()
        text_vectors = library.bundle.encode_texts(list(texts))
        library_map = make_map(snapshot.generation, rows.owners, rows.vectors.astype("float32"), texts, text_vectors)
        map_file.save(folder, library_map)
    return json.dumps(library_map.document(), separators=(",", ":")).encode()
