"""The library as a whole: its numbers and its map."""

from __future__ import annotations

import json
from importlib.metadata import version

from fastapi import APIRouter, Response

from search.map import layout
from search.query.vocabulary import vocabulary
from search.server import documents
from search.server.documents import answer, encoded
from search.server.error_responses import ANY, ok
from search.server.state import State


def routes(state: State) -> APIRouter:
    """The routes about the library."""
    router = APIRouter(prefix="/api", tags=["library"], default_response_class=Response, responses=ANY)
    library = state.library

    @router.get("/stats", responses=ok(documents.StatsShape))
    def stats() -> Response:
        """What the library holds, in numbers."""
        return answer(library.stats() | {"version": version("motionseek")})

    @router.get("/map", responses=ok(documents.MapShape))
    async def whole_map() -> Response:
        """Every clip as a point of a plane, near where clips are alike, with what it looks like most."""
        return encoded(await state.remembered(("map",), lambda: _map(state)))

    return router


def _map(state: State) -> bytes:
    library, snapshot = state.library, state.library.snapshot
    folder = library.folder / "previews"
    made = layout.load(folder, snapshot.generation)
    if made is None:
        rows = snapshot.clips.rows
        texts = vocabulary()
        made = layout.make(
            snapshot.generation,
            rows.owners,
            rows.vectors.astype("float32"),
            texts,
            library.bundle.encode_texts(list(texts)),
        )
        layout.save(folder, made)
    return json.dumps(made.document(), separators=(",", ":")).encode()
