"""Routes of motions: metadata, joints, and cuts as files."""

from __future__ import annotations

import tempfile
from contextlib import suppress
from pathlib import Path, PurePosixPath
from typing import Annotated, Any, Literal

from fastapi import APIRouter, Query, Request, Response
from fastapi.responses import FileResponse
from starlette.background import BackgroundTask
from starlette.exceptions import HTTPException

from encoders.motion import FPS, Motion
from encoders.skeleton import JOINTS, PARENTS
from indexer.store.clips import Clip
from search.export import joints_binary
from search.export.cut import write_cut
from search.query.filters import refuse_filters
from search.server import response_models
from search.server.app_state import AppState
from search.server.exception_handlers import ANY, NO_CLIP, ok
from search.server.parameters import ClipInPath, ClipParam, ClipsParam, CountParam, FilterParams, SortParam, SpanParams
from search.server.responses import json_response
from search.server.uploads.upload_store import Upload
from search.source import MotionSource

_BYTES: dict[int | str, dict[str, Any]] = {
    200: {"content": {"application/octet-stream": {"schema": {"type": "string", "format": "binary"}}}}
}


def routes(state: AppState) -> APIRouter:
    """The routes of motions."""
    router = APIRouter(prefix="/api", tags=["motions"], default_response_class=Response, responses=ANY)
    library = state.library

    def document(clip: Clip | Upload) -> dict[str, Any]:
        if isinstance(clip, Upload):
            return clip.document()
        found = clip.document(library.captions(clip.id))
        return {"clip": found.pop("id")} | found | library.marks(clip.id).document()

    def chosen(refs: list[str], shown: slice) -> Response:
        found = []
        for ref in refs[shown]:
            with suppress(HTTPException):  # one that is gone meanwhile
                found.append(document(state.clip(ref)))
        return json_response({"total": len(refs), "motions": found})

    @router.get("/motions", responses=ok(response_models.MotionsResponse))
    def motions(
        given: FilterParams,
        clip: ClipsParam = [],  # noqa: B006
        offset: Annotated[int, Query(ge=0, le=10**9)] = 0,
        limit: CountParam = 24,
        seed: Annotated[
            int | None, Query(ge=0, le=2**31, description="A varied choice of this seed comes first.")
        ] = None,
        sort: SortParam = None,
    ) -> Response:
        """One page of the clips: by number, sorted, varied by `seed`, or named by `clip` in that order."""
        with library.reading():
            if clip:
                refuse_filters(given)
                return chosen(clip, slice(offset, offset + limit))
            total, clips = library.page(given, offset, limit, seed, sort)
            return json_response({"total": total, "motions": [document(found) for found in clips]})

    @router.get("/clips", responses=ok(response_models.ClipsResponse))
    def clips(given: FilterParams) -> Response:
        """The numbers of all clips that pass the filters."""
        with library.reading():
            allowed = library.allowed(**given)
            return json_response({"clips": (library.ids() if allowed is None else allowed).tolist()})

    @router.get("/motions/{clip}", responses=ok(response_models.MotionResponse) | NO_CLIP)
    def motion(clip: ClipInPath) -> Response:
        """The metadata of a motion."""
        with library.reading():
            found = state.clip(clip)
            return json_response(document(found))

    @router.get("/motions/{clip}/joints", responses=_BYTES | NO_CLIP)
    def motion_joints(
        request: Request, clip: ClipInPath, span: SpanParams, fps: Annotated[float, Query(ge=1, le=60)] = FPS
    ) -> Response:
        """The 22 joints of a motion, or a span of it, as bytes: see docs/serving.md."""
        start, end = span
        tag = f'"{library.snapshot.generation:x}-{clip}-{start}-{end}-{fps:g}"'
        headers = {"ETag": tag, "Cache-Control": "private, no-cache"}
        if request.headers.get("if-none-match") == tag:
            return Response(status_code=304, headers=headers)
        with library.reading():
            cut, begin = _cut(state, clip, start or 0.0, end)
        data = joints_binary.pack(cut if fps == cut.fps else cut.resample(fps), begin)
        return Response(data, media_type="application/octet-stream", headers=headers)

    @router.get("/skeleton", responses=ok(response_models.SkeletonResponse))
    def skeleton() -> Response:
        """The names and parents of the 22 joints."""
        return json_response({"joints": list(JOINTS), "parents": PARENTS.tolist()})

    @router.get("/export", responses=_BYTES | NO_CLIP)
    async def export(
        clip: ClipParam,
        span: SpanParams,
        format: Literal["bvh", "glb", "npz", "npy"] = "bvh",
        fps: Annotated[float | None, Query(ge=1, le=1000)] = None,
        in_place: bool = False,
    ) -> Response:
        """A motion, or a span of it, as a file."""
        folder = tempfile.TemporaryDirectory(prefix="motionseek-")
        try:
            out = Path(folder.name) / f"cut.{format}"
            path, stale = await state.run_slow(lambda: _write(state.source(clip), out, *span, fps, in_place))
        except BaseException:
            folder.cleanup()
            raise
        name = _file_name(PurePosixPath(path).stem, *span, format)
        return FileResponse(
            out,
            media_type="application/octet-stream",
            filename=name,
            headers={"Cache-Control": "no-store"} | ({"X-Stale": stale} if stale else {}),
            background=BackgroundTask(folder.cleanup),
        )

    return router


def _cut(state: AppState, ref: str, start: float, end: float | None) -> tuple[Motion, float]:
    """A span of a motion and the time of its first frame; of a clip, only the stored chunks it touches are read."""
    found = state.clip(ref)
    if isinstance(found, Upload):
        cut, frames, origin = found.source.cut(start, end), len(found.source.motion), found.source.start
    else:
        cut, frames, origin = state.library.motion(found.id, start, end), found.frames, found.start
    return cut, origin + min(round(max(start - origin, 0.0) * cut.fps), frames - 1) / cut.fps


def _write(
    source: MotionSource, out: Path, start: float | None, end: float | None, fps: float | None, in_place: bool
) -> tuple[str, str]:
    """Write a span of a motion as a file; the motion's path, and what became of its file since it was indexed."""
    write_cut(source, out, start, end, fps=fps, in_place=in_place)
    return source.path, source.stale()


def _file_name(stem: str, start: float | None, end: float | None, format: str) -> str:
    span = "" if start is None and end is None else f"_{start or 0:g}-{'end' if end is None else f'{end:g}'}"
    return f"{stem}{span}.{format}"
