"""Routes of composing: a time line of sentences becomes one motion, to be played or as a file."""

from __future__ import annotations

import base64
import io
import tempfile
import zipfile
from pathlib import Path
from typing import Annotated, Any, Literal

from fastapi import APIRouter, Query, Response
from pydantic import BaseModel, ConfigDict, Field

from search.compose.candidates import Candidate
from search.compose.composition import Composition, compose
from search.compose.report import document, write_composition
from search.compose.timeline import Interval, Pin, Timeline
from search.export import joints_binary
from search.server import response_models
from search.server.app_state import AppState
from search.server.exception_handlers import ANY, ok
from search.server.parameters import FilterParams
from search.server.responses import json_response

#: Sentences of a time line, and its seconds.
_MOST, _LONGEST = 40, 120
_ZIP: dict[int | str, dict[str, Any]] = {200: {"content": {"application/zip": {}}}}
_Seconds = Annotated[float, Field(ge=0, le=_LONGEST, allow_inf_nan=False)]
_Part = Literal["legs", "spine", "head", "left arm", "right arm"]


class SentenceBody(BaseModel):
    """A sentence of a time line; `clip` and `at`, seconds of its file, say what it is to be shown by."""

    model_config = ConfigDict(extra="forbid")
    text: Annotated[str, Field(min_length=1, max_length=500)]
    start: _Seconds
    end: _Seconds
    parts: Annotated[list[_Part], Field(max_length=5)] = []
    clip: Annotated[int, Field(ge=0, lt=1 << 62)] | None = None
    at: Annotated[float, Field(ge=0, le=1e6, allow_inf_nan=False)] = 0.0

    def interval(self) -> Interval:
        """The same as the composer takes it."""
        pin = None if self.clip is None else Pin(self.clip, self.at)
        return Interval(self.text, self.start, self.end, frozenset(self.parts), pin)


class TimelineBody(BaseModel):
    """A time line."""

    model_config = ConfigDict(extra="forbid")
    sentences: Annotated[list[SentenceBody], Field(min_length=1, max_length=_MOST)]


def routes(state: AppState) -> APIRouter:
    """The routes of composing."""
    router = APIRouter(prefix="/api", tags=["compose"], default_response_class=Response, responses=ANY)

    def composed(body: TimelineBody, given: FilterParams) -> Composition:
        line = Timeline.of([one.interval() for one in body.sentences])
        return compose(line, state.library, allowed=state.library.allowed(**given))[0]

    @router.post("/compose", responses=ok(response_models.ComposeResponse))
    async def compose_motion(body: TimelineBody, given: FilterParams) -> Response:
        """The motion of a time line, what each sentence is shown by, and what else it could be shown by."""
        made = await state.run_slow(lambda: composed(body, given))
        answer = document(made)
        for interval, offered in zip(answer["intervals"], made.offered, strict=True):
            interval["options"] = [_option(candidate) for candidate in offered]
        joints = base64.b64encode(joints_binary.pack(made.motion)).decode()
        return json_response(answer | {"joints": joints})

    @router.post("/compose/file", responses=_ZIP)
    async def compose_file(
        body: TimelineBody,
        given: FilterParams,
        to: Annotated[Literal["bvh", "glb", "npz", "npy"], Query(description="The format of the file.")] = "bvh",
    ) -> Response:
        """The motion of a time line as a file, with the report of its sources, in a ZIP archive."""
        data = await state.run_slow(lambda: _zipped(composed(body, given), to))
        headers = {"Content-Disposition": 'attachment; filename="composition.zip"', "Cache-Control": "no-store"}
        return Response(data, media_type="application/zip", headers=headers)

    return router


def _option(candidate: Candidate) -> dict[str, Any]:
    source = candidate.source
    return {
        "clip": source.clip_id,
        "path": source.path,
        "source_start": round(source.start + candidate.start, 3),
        "source_end": round(source.start + candidate.end, 3),
        "score": round(candidate.score, 4),
    }


def _zipped(made: Composition, format: str) -> bytes:
    packed = io.BytesIO()
    with tempfile.TemporaryDirectory(prefix="motionseek-") as folder:
        write_composition(made, Path(folder) / f"composition.{format}")
        with zipfile.ZipFile(packed, "w", zipfile.ZIP_DEFLATED) as archive:
            for path in sorted(Path(folder).iterdir()):
                archive.write(path, path.name)
    return packed.getvalue()
