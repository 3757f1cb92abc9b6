"""Routes of what people find and keep: facets, stacks, marks, and archives of many clips."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from fastapi import APIRouter, Query, Response
from fastapi.responses import StreamingResponse
from pydantic import BaseModel, ConfigDict, Field
from starlette.exceptions import HTTPException

from search.export.archive_stream import ArchivedCut, archive
from search.query.facets import facets
from search.query.filters import Filters
from search.server import response_models
from search.server.app_state import AppState
from search.server.exception_handlers import ANY, NO_CLIP, ErrorResponse, ok
from search.server.parameters import FilterParams
from search.server.responses import JsonAnswer, bytes_response, json_response
from search.stacks.background import BackgroundStacks

#: Clips of one archive, and of one change of marks.
MOST = 200
_CUT = r"^(#?[0-9]{1,18}|u[0-9a-f]{32})(:[0-9]{1,6}(\.[0-9]{1,6})?:[0-9]{1,6}(\.[0-9]{1,6})?)?$"
_ZIP: dict[int | str, dict[str, Any]] = {200: {"content": {"application/zip": {}}}}
_Name = Annotated[str, Field(min_length=1, max_length=100)]
_Names = Annotated[list[_Name], Field(max_length=20)]


class MarksChange(BaseModel):
    """What is to be changed of clips; what is left out stays."""

    model_config = ConfigDict(extra="forbid")
    clips: Annotated[list[Annotated[int, Field(ge=0, lt=1 << 62)]], Field(min_length=1, max_length=MOST)]
    star: bool | None = None
    tags: _Names = []
    untag: _Names = []
    collections: _Names = []
    uncollect: _Names = []


def routes(state: AppState) -> APIRouter:
    """The routes of the shelf."""
    router = APIRouter(prefix="/api", tags=["shelf"], default_response_class=Response, responses=ANY)
    library, found_stacks = state.library, BackgroundStacks(state.library)

    @router.get("/facets", responses=ok(response_models.FacetsResponse))
    async def facet_counts(given: FilterParams) -> Response:
        """How many clips each value of a filter would leave, those of the other filters given."""
        made = await state.cached(("facets", *given.items()), lambda: JsonAnswer(facets(library, Filters.of(given))))
        return bytes_response(made)

    @router.get("/stacks", responses=ok(response_models.StacksResponse))
    def stacks() -> Response:
        """Clips that show one performance: lists of [number, whether mirrored]; or how far the search for them is."""
        generation = library.snapshot.generation
        found = found_stacks.get(generation)
        if found is None:
            return json_response({"generation": generation, "progress": round(found_stacks.progress, 3)})
        return json_response({"generation": generation, "stacks": [[list(copy) for copy in stack] for stack in found]})

    @router.get("/marks", responses=ok(response_models.MarksResponse))
    def marks() -> Response:
        """How many clips have each star, tag and collection, and whether this server may change them."""
        with library.reading():
            return json_response(library.mark_counts() | {"edit": state.edit})

    @router.post(
        "/marks",
        responses=ok(response_models.ChangedMarksResponse)
        | NO_CLIP
        | {403: {"model": ErrorResponse, "description": "Cross-origin request rejected, or not started with --edit"}},
    )
    async def change_marks(change: MarksChange) -> Response:
        """Star clips, tag them or collect them; only where the server was started with `--edit`."""
        if not state.edit:
            raise HTTPException(403, "this server may not change the library; start it with motionseek serve --edit")
        return json_response({"clips": await state.run_change(lambda: _changed(state, change))})

    @router.get("/archive", responses=_ZIP | NO_CLIP)
    def zip_archive(
        clip: Annotated[
            list[Annotated[str, Query(pattern=_CUT)]],
            Query(min_length=1, max_length=MOST, description="A clip, or a span of it, as 12:1.5:3.25"),
        ],
        format: Literal["bvh", "glb", "npz", "npy"] = "bvh",
    ) -> Response:
        """Clips, or spans of them, as files in one ZIP archive, with the credits of their sources."""
        with library.reading():
            cuts = [_cut(state, ref) for ref in clip]

        headers = {"Content-Disposition": 'attachment; filename="motions.zip"', "Cache-Control": "no-store"}
        return StreamingResponse(archive(cuts, format), media_type="application/zip", headers=headers)

    return router


def _cut(state: AppState, ref: str) -> ArchivedCut:
    clip, _, span = ref.partition(":")
    start, end = map(float, span.split(":")) if span else (None, None)
    if start is not None and end is not None and end <= start:
        raise HTTPException(422, f"clip: the end of {ref} must be after its start")
    return ArchivedCut(state.source(clip), start, end)


def _changed(state: AppState, change: MarksChange) -> list[dict[str, Any]]:
    """The marks of the clips after a change, which is in the library and in what is searched."""
    library, refs = state.library, [f"#{clip}" for clip in change.clips]
    if change.star or change.tags or change.collections:
        library.mark(refs, star=bool(change.star), tags=change.tags, collections=change.collections)
    if change.star is False or change.untag or change.uncollect:
        library.unmark(refs, star=change.star is False, tags=change.untag, collections=change.uncollect)
    library.refresh()
    with library.reading():
        return [{"clip": clip} | library.marks(clip).document() for clip in change.clips]
