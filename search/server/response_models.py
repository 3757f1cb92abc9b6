"""The shapes of the server's answers, for its description; answers are written as JSON without passing through them."""

from __future__ import annotations

import json
from collections.abc import Sequence
from typing import Any, Literal

from fastapi import Response
from pydantic import BaseModel, Field

from indexer.store.clips import Caption, Clip
from search.hits import Hit

#: The number of a clip of the library, or what an upload is called.
ClipRef = int | str


class StepModel(BaseModel):
    text: str
    score: float
    start: float
    end: float


class HitModel(BaseModel):
    rank: int
    path: str
    score: float
    strength: Literal["strong", "plausible", "weak", ""]
    start: float
    end: float
    duration: float
    caption: str
    clip: ClipRef
    steps: list[StepModel] | None = None


class SearchResponse(BaseModel):
    query: str
    hits: list[HitModel]


class CurveModel(BaseModel):
    times: list[float]
    similarity: dict[str, list[float]]


class MomentsResponse(SearchResponse):
    how: Literal["then", "while"] | None = None
    sentences: list[str] | None = None
    curve: CurveModel | None = None


class CurveResponse(CurveModel):
    clip: ClipRef
    path: str
    duration: float


class SimilarResponse(SearchResponse):
    clip: ClipRef


class SentenceModel(BaseModel):
    text: str
    score: float


class DescribeResponse(BaseModel):
    path: str
    sentences: list[SentenceModel]
    clip: ClipRef


class CaptionModel(BaseModel):
    text: str
    start: float | None
    end: float | None


class MotionModel(BaseModel):
    clip: ClipRef
    path: str
    name: str
    duration: float
    fps: float
    frames: int
    format: str
    rig: str
    added: str


class MotionResponse(MotionModel):
    captions: list[CaptionModel]


class MotionsResponse(BaseModel):
    total: int
    motions: list[MotionResponse]


class SkeletonResponse(BaseModel):
    joints: list[str]
    parents: list[int]


class StatsResponse(BaseModel):
    version: str
    clips: int
    generation: int
    seconds: float
    formats: dict[str, int]
    rigs: dict[str, int]


class MapResponse(BaseModel):
    generation: int
    clips: list[int]
    x: list[float] = Field(description="0 to 1")
    y: list[float] = Field(description="0 to 1")
    labels: list[str]
    label: list[int]


class HealthResponse(BaseModel):
    status: Literal["ok"]


def answer(content: Any, headers: dict[str, str] | None = None) -> Response:
    """A JSON document as a response."""
    return encoded(json.dumps(content, allow_nan=False, separators=(",", ":")).encode(), headers)


def encoded(document: bytes, headers: dict[str, str] | None = None) -> Response:
    """A JSON document, written already, as a response."""
    return Response(document, media_type="application/json", headers={"Cache-Control": "no-store"} | (headers or {}))


def hits(found: Sequence[Hit], upload: str | None = None) -> list[dict[str, Any]]:
    """Hits as the command line writes them, each with its clip; `upload` names the one that is in no library."""
    return [hit.document() | {"clip": hit.clip_id if hit.clip_id >= 0 else upload} for hit in found]


def motion(clip: Clip) -> dict[str, Any]:
    """What is known of a clip."""
    return {
        "clip": clip.id,
        "path": clip.path,
        "name": clip.name,
        "duration": round(clip.duration, 3),
        "fps": clip.fps,
        "frames": clip.frames,
        "format": clip.format,
        "rig": clip.rig,
        "added": clip.added,
    }


def captions(said: Sequence[Caption]) -> list[dict[str, Any]]:
    """Captions as they are written."""
    return [{"text": caption.text, "start": caption.start, "end": caption.end} for caption in said]
