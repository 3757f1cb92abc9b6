"""The response models of the OpenAPI description; responses are written as JSON without passing through them."""

from __future__ import annotations

from typing import Literal

from pydantic import BaseModel, Field

#: A clip's number, or the key of an upload.
ClipKey = int | str


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
    clip: ClipKey
    root: str | None
    source_fps: float | None
    first_frame: int | None
    last_frame: int | None
    stale: str | None
    matched: list[Literal["name", "folder", "caption", "tag", "collection"]]
    starred: bool
    tags: list[str]
    collections: list[str]
    steps: list[StepModel] | None = None


class SearchResponse(BaseModel):
    query: str
    language: str | None = None
    without: list[str] | None = None
    hits: list[HitModel]


class CurveModel(BaseModel):
    times: list[float]
    similarity: dict[str, list[float]]


class MomentsResponse(SearchResponse):
    how: Literal["then", "while"] | None = None
    sentences: list[str] | None = None
    curve: CurveModel | None = None


class CurveResponse(CurveModel):
    clip: ClipKey
    path: str
    start: float
    duration: float


class SimilarResponse(SearchResponse):
    clip: ClipKey


class SentenceModel(BaseModel):
    text: str
    score: float
    strength: str


class DescribeResponse(BaseModel):
    path: str
    sentences: list[SentenceModel]
    stale: str | None
    clip: ClipKey


class CaptionModel(BaseModel):
    text: str
    start: float | None
    end: float | None


class MotionResponse(BaseModel):
    clip: ClipKey
    root: str | None
    path: str
    name: str
    duration: float
    fps: float
    frames: int
    format: str
    rig: str
    added: str
    up: str | None
    up_reason: str | None
    start: float
    source_fps: float | None
    source_frames: int | None
    warnings: list[str]
    captions: list[CaptionModel]
    starred: bool
    tags: list[str]
    collections: list[str]


class MotionsResponse(BaseModel):
    total: int
    motions: list[MotionResponse]


class ClipsResponse(BaseModel):
    clips: list[int]


class UploadsResponse(BaseModel):
    motions: list[MotionResponse]


class FormatModel(BaseModel):
    ending: str
    companion: str | None = Field(description="the ending of files beside it that it may need")
    same_name: bool = Field(description="whether only a companion of the same name is one")


class FormatsResponse(BaseModel):
    formats: list[FormatModel]


class SkeletonResponse(BaseModel):
    joints: list[str]
    parents: list[int]


class StatsResponse(BaseModel):
    version: str
    roots: list[str]
    clips: int
    generation: int
    seconds: float
    formats: dict[str, int]
    rigs: dict[str, int]


class MapProgress(BaseModel):
    generation: int
    count: int
    progress: float = Field(description="0 to 1")


class MapResponse(BaseModel):
    generation: int
    clips: list[int]
    x: list[float] = Field(description="0 to 1")
    y: list[float] = Field(description="0 to 1")
    labels: list[str]
    label: list[int]
    total: int = Field(description="Clips of the library, of which those above may be a sample")


class FacetValue(BaseModel):
    count: int
    value: str | None = None
    start: float | None = Field(default=None, alias="from", description="Seconds, of a length")
    to: float | None = None


class FacetsResponse(BaseModel):
    folder: list[FacetValue]
    format: list[FacetValue]
    rig: list[FacetValue]
    length: list[FacetValue]
    tag: list[FacetValue]
    collection: list[FacetValue]
    starred: list[FacetValue]


class StacksResponse(BaseModel):
    generation: int
    stacks: list[list[list[int | bool]]] | None = Field(default=None, description="Clip, and whether it is mirrored")
    progress: float | None = Field(default=None, description="0 to 1, while they are being found")


class MarksResponse(BaseModel):
    starred: int
    tags: dict[str, int]
    collections: dict[str, int]
    edit: bool


class ClipMarksModel(BaseModel):
    clip: int
    starred: bool
    tags: list[str]
    collections: list[str]


class ChangedMarksResponse(BaseModel):
    clips: list[ClipMarksModel]


class ComposeOption(BaseModel):
    clip: int
    path: str
    source_start: float
    source_end: float
    score: float


class ComposedInterval(BaseModel):
    text: str
    start: float
    end: float
    parts: list[str]
    path: str
    root: str | None
    clip: int
    source_start: float
    source_end: float
    repeats: int
    rate: float
    score: float
    tmr_score: float = Field(description="0 to 1, of what came out")
    options: list[ComposeOption] = Field(description="What could show it, the best first")


class TransitionModel(BaseModel):
    at: float
    cm: float


class ComposeResponse(BaseModel):
    timeline: str | None
    duration: float
    intervals: list[ComposedInterval]
    joins: list[float]
    transitions: list[TransitionModel]
    sliding: float = Field(description="Percent of frames in which a standing foot slides")
    credits: str | None
    joints: str = Field(description="MSJ1, as of /api/motions/{clip}/joints, in base64")


class HealthResponse(BaseModel):
    status: Literal["ok"]
