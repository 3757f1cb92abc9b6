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


class StepShape(BaseModel):
    text: str
    score: float
    start: float
    end: float


class HitShape(BaseModel):
    rank: int
    path: str
    score: float
    strength: Literal["strong", "plausible", "weak", ""]
    start: float
    end: float
    duration: float
    caption: str
    clip: ClipRef
    steps: list[StepShape] | None = None


class HitsShape(BaseModel):
    query: str
    hits: list[HitShape]


class CurveShape(BaseModel):
    times: list[float]
    similarity: dict[str, list[float]]


class MomentsShape(HitsShape):
    how: Literal["then", "while"] | None = None
    sentences: list[str] | None = None
    curve: CurveShape | None = None


class ClipCurveShape(CurveShape):
    clip: ClipRef
    path: str
    duration: float


class SimilarShape(HitsShape):
    clip: ClipRef


class SentenceShape(BaseModel):
    text: str
    score: float


class DescriptionShape(BaseModel):
    path: str
    sentences: list[SentenceShape]
    clip: ClipRef


class CaptionShape(BaseModel):
    text: str
    start: float | None
    end: float | None


class MotionShape(BaseModel):
    clip: ClipRef
    path: str
    name: str
    duration: float
    fps: float
    frames: int
    format: str
    rig: str
    added: str


class CaptionedMotionShape(MotionShape):
    captions: list[CaptionShape]


class MotionsShape(BaseModel):
    total: int
    motions: list[CaptionedMotionShape]


class SkeletonShape(BaseModel):
    joints: list[str]
    parents: list[int]


class StatsShape(BaseModel):
    version: str
    clips: int
    generation: int
    seconds: float
    formats: dict[str, int]
    rigs: dict[str, int]


class MapShape(BaseModel):
    generation: int
    clips: list[int]
    x: list[float] = Field(description="0 to 1")
    y: list[float] = Field(description="0 to 1")
    labels: list[str]
    label: list[int]


class HealthShape(BaseModel):
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
