"""Motions: what is known of them, their joints, their cuts as files."""

from __future__ import annotations

import tempfile
from pathlib import Path, PurePosixPath
from typing import Annotated, Any, Literal

from fastapi import APIRouter, Query, Request, Response
from fastapi import Path as InPath
from fastapi.responses import FileResponse
from starlette.background import BackgroundTask

from encoders.errors import QueryError
from encoders.motion import FPS, Motion
from encoders.skeleton import JOINTS, PARENTS
from indexer.store.clips import Clip
from search.export.cut import write_cut
from search.server import joints_binary, response_models
from search.server.app_state import AppState
from search.server.exception_handlers import ANY, NO_CLIP, ok
from search.server.parameters import ClipRef, Count, Filters, Span
from search.server.response_models import answer
from search.server.uploads import Upload

_Clip = Annotated[str, InPath(pattern=r"^([0-9]{1,18}|u[0-9a-f]{32})$")]
_BYTES: dict[int | str, dict[str, Any]] = {
    200: {"content": {"application/octet-stream": {"schema": {"type": "string", "format": "binary"}}}}
}


def routes(state: AppState) -> APIRouter:
    """The routes about motions."""
    router = APIRouter(prefix="/api", tags=["motions"], default_response_class=Response, responses=ANY)
    library = state.library

    def captioned(clip: Clip) -> dict[str, Any]:
        return response_models.motion(clip) | {"captions": response_models.captions(library.captions(clip.id))}

    @router.get("/motions", responses=ok(response_models.MotionsResponse))
    def motions(given: Filters, offset: Annotated[int, Query(ge=0, le=10**9)] = 0, limit: Count = 24) -> Response:
        """The library page by page, in order of clip numbers."""
        allowed = library.allowed(**given)
        ids = library.ids() if allowed is None else allowed
        clips = library.clips(ids[offset : offset + limit].tolist())
        return answer({"total": len(ids), "motions": [captioned(clip) for clip in clips.values()]})

    @router.get("/motions/{clip}", responses=ok(response_models.MotionResponse) | NO_CLIP)
    def motion(clip: _Clip) -> Response:
        """What is known of a motion."""
        found = state.clip(clip)
        if isinstance(found, Upload):
            return answer(_uploaded(found))
        return answer(captioned(found))

    @router.get("/motions/{clip}/joints", responses=_BYTES | NO_CLIP)
    def motion_joints(
        request: Request, clip: _Clip, span: Span, fps: Annotated[float, Query(ge=1, le=60)] = FPS
    ) -> Response:
        """The 22 joints of a motion, or a span of it, as bytes: see docs/serving.md."""
        start, end = span
        tag = f'"{library.snapshot.generation:x}-{clip}-{start}-{end}-{fps:g}"'
        headers = {"ETag": tag, "Cache-Control": "private, no-cache"}
        if request.headers.get("if-none-match") == tag:
            return Response(status_code=304, headers=headers)
        cut, begin = _cut(state, clip, start or 0.0, end)
        data = joints_binary.pack(cut if fps == cut.fps else cut.resample(fps), begin)
        return Response(data, media_type="application/octet-stream", headers=headers)

    @router.get("/skeleton", responses=ok(response_models.SkeletonResponse))
    def skeleton() -> Response:
        """The 22 joints: their names and parents."""
        return answer({"joints": list(JOINTS), "parents": PARENTS.tolist()})

    @router.get("/export", responses=_BYTES | NO_CLIP)
    async def export(clip: ClipRef, span: Span, format: Literal["bvh", "npz", "npy"] = "bvh") -> Response:
        """A motion, or a span of it, as a file."""
        folder = tempfile.TemporaryDirectory(prefix="motionseek-")
        try:
            source = state.source(clip)
            out = Path(folder.name) / f"cut.{format}"
            await state.at_length(lambda: write_cut(source, out, *span))
        except BaseException:
            folder.cleanup()
            raise
        name = _file_name(PurePosixPath(source.path).stem, *span, format)
        return FileResponse(
            out,
            media_type="application/octet-stream",
            filename=name,
            headers={"Cache-Control": "no-store"},
            background=BackgroundTask(folder.cleanup),
        )

    return router


def _cut(state: AppState, ref: str, start: float, end: float | None) -> tuple[Motion, float]:
    """A span of a motion, and the second of its first frame; of a clip only the stored pieces it touches are read."""
    found = state.clip(ref)
    if isinstance(found, Upload):
        cut, frames = found.source.cut(start, end), len(found.source.motion)
    else:
        try:
            cut, frames = state.library.motion(found.id, start, end), found.frames
        except ValueError as error:
            raise QueryError(f"{error}; give a start and end inside it, in seconds") from None
    return cut, min(round(start * cut.fps), frames - 1) / cut.fps


def _uploaded(upload: Upload) -> dict[str, object]:
    motion, path = upload.source.motion, upload.source.path
    return {
        "clip": upload.key,
        "path": path,
        "name": PurePosixPath(path).stem,
        "duration": round(motion.duration, 3),
        "fps": motion.fps,
        "frames": len(motion),
        "format": upload.format,
        "rig": upload.rig,
        "added": "",
        "captions": [],
    }


def _file_name(stem: str, start: float | None, end: float | None, format: str) -> str:
    span = "" if start is None and end is None else f"_{start or 0:g}-{'end' if end is None else f'{end:g}'}"
    return f"{stem}{span}.{format}"
