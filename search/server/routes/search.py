"""Questions: search, moments, the curve over a take, describe, similar."""

from __future__ import annotations

import json
from typing import Annotated, Any, cast

from fastapi import APIRouter, Query, Request, Response

from search.moments.one_take import curves, describe_motion, moments_in
from search.query.question import Question
from search.server import response_models
from search.server.app_state import AppState
from search.server.exception_handlers import ANY, NO_CLIP, UPLOAD, ok
from search.server.parameters import ClipRef, Count, FileName, Filters, NearOffset, Offset, Sentence, Sentences, Span
from search.server.response_models import encoded
from search.server.snapshot_library import SearchRequest
from search.source import MotionSource

Given = dict[str, Any]

_BODY: dict[str, Any] = {
    "requestBody": {
        "required": True,
        "content": {"application/octet-stream": {"schema": {"type": "string", "format": "binary"}}},
    }
}


def routes(state: AppState) -> APIRouter:
    """The routes that answer questions."""
    router = APIRouter(prefix="/api", tags=["asking"], default_response_class=Response, responses=ANY)
    library = state.library

    @router.get("/search", responses=ok(response_models.SearchResponse))
    async def search(q: Sentence, given: Filters, k: Count = 10, offset: Offset = 0) -> Response:
        """The clips that fit a sentence best, each with the span that does."""
        question, generation = SearchRequest(q, offset + k, tuple(given.items())), library.snapshot.generation
        document = library.standing.get((question, offset))
        if document is None:
            hits = await state.search(question)
            document = _written({"query": q, "hits": response_models.hits(hits[offset:])})
            library.standing.put((question, offset), document, library.grounds(question, hits), generation)
        return encoded(document)

    @router.get("/moments", responses=ok(response_models.MomentsResponse) | NO_CLIP)
    async def moments(
        request: Request,
        given: Filters,
        q: Sentence | None = None,
        then: Annotated[list[Sentence], Query(max_length=8)] = [],  # noqa: B006
        meanwhile: Annotated[list[Sentence], Query(max_length=8, alias="while")] = [],  # noqa: B006
        split: bool = True,
        clip: ClipRef | None = None,
        k: Count = 10,
        offset: NearOffset = 0,
    ) -> Response:
        """Where it happens: in one take, with the similarity over time, or anywhere in the library."""
        question = Question.of(q, then, meanwhile, split_steps=split)

        def in_library() -> bytes:
            found = library.answer(question, k=offset + k, **given)[offset:]
            return _written(_moments(question, response_models.hits(found)))

        def in_clip() -> bytes:
            assert clip is not None
            source = state.source(clip)
            found = response_models.hits(moments_in(library.bundle, source, question, offset + k)[offset:], clip)
            return _written(_moments(question, found) | {"curve": _curve(state, source, question)})

        return encoded(await state.remembered(_asked(request), in_library if clip is None else in_clip))

    @router.get("/curve", responses=ok(response_models.CurveResponse) | NO_CLIP)
    async def curve(request: Request, clip: ClipRef, q: Sentences) -> Response:
        """Similarity over time of one take to sentences."""
        question = _several(q)

        def make() -> bytes:
            source = state.source(clip)
            named = {"clip": _ref(source, clip), "path": source.path, "duration": round(source.duration, 3)}
            return _written(named | _curve(state, source, question))

        return encoded(await state.remembered(_asked(request), make))

    def described(source: MotionSource, ref: str, span: tuple[float | None, float | None], k: int) -> bytes:
        texts, _, vectors = library.caption_vectors()
        found = describe_motion(library.bundle, source.cut(*span), k, texts, vectors)
        sentences = [{"text": text, "score": round(score, 4)} for text, score in found]
        return _written({"path": source.path, "sentences": sentences, "clip": _ref(source, ref)})

    @router.get("/describe", responses=ok(response_models.DescribeResponse) | NO_CLIP)
    async def describe(request: Request, clip: ClipRef, span: Span, k: Count = 5) -> Response:
        """The sentences that fit a clip, or a span of it, best."""
        return encoded(await state.remembered(_asked(request), lambda: described(state.source(clip), clip, span, k)))

    @router.post("/describe", openapi_extra=_BODY, responses=ok(response_models.DescribeResponse) | UPLOAD)
    async def describe_upload(request: Request, name: FileName, span: Span, k: Count = 5) -> Response:
        """The sentences that fit an uploaded motion best."""
        upload = await state.uploads.receive(request, name)
        return encoded(await state.at_length(lambda: described(upload.source, upload.key, span, k)))

    def alike(
        source: MotionSource,
        ref: str,
        span: tuple[float | None, float | None],
        moments: bool,
        part: slice,
        given: Given,
    ) -> bytes:
        found = library.similar(cast(Any, source), part.stop, *span, moments=moments, **given)[part]
        return _written({"query": source.path, "hits": response_models.hits(found), "clip": _ref(source, ref)})

    @router.get("/similar", responses=ok(response_models.SimilarResponse) | NO_CLIP)
    async def similar(
        request: Request,
        clip: ClipRef,
        span: Span,
        given: Filters,
        moments: bool = False,
        k: Count = 10,
        offset: NearOffset = 0,
    ) -> Response:
        """The clips, or with `moments` the spans, that move like a clip or a span of it."""
        part = slice(offset, offset + k)

        def make() -> bytes:
            return alike(state.source(clip), clip, span, moments, part, given)

        return encoded(await state.remembered(_asked(request), make))

    @router.post("/similar", openapi_extra=_BODY, responses=ok(response_models.SimilarResponse) | UPLOAD)
    async def similar_upload(
        request: Request,
        name: FileName,
        span: Span,
        given: Filters,
        moments: bool = False,
        k: Count = 10,
        offset: NearOffset = 0,
    ) -> Response:
        """The clips, or with `moments` the spans, that move like an uploaded motion."""
        upload = await state.uploads.receive(request, name)
        part = slice(offset, offset + k)
        return encoded(await state.at_length(lambda: alike(upload.source, upload.key, span, moments, part, given)))

    return router


def _asked(request: Request) -> tuple[str, bytes]:
    """What tells one question from another."""
    return request.url.path, request.scope["query_string"]


def _written(content: Any) -> bytes:
    return json.dumps(content, allow_nan=False, separators=(",", ":")).encode()


def _ref(source: MotionSource, ref: str) -> int | str:
    return source.clip_id if source.clip_id >= 0 else ref


def _several(sentences: list[str]) -> Question:
    """Sentences that are each asked for themselves."""
    for sentence in sentences:
        Question.of(sentence, split_steps=False)
    return Question(tuple(dict.fromkeys(sentences)))


def _moments(question: Question, hits: list[dict[str, Any]]) -> dict[str, Any]:
    content: dict[str, Any] = {"query": str(question), "hits": hits}
    if question.how != "alone":
        content |= {"how": question.how, "sentences": list(question.sentences)}
    return content


def _curve(state: AppState, source: MotionSource, question: Question) -> dict[str, Any]:
    bundle = state.library.bundle
    times, similarity = curves(bundle, source, question.encode(bundle))
    named = zip(question.sentences, similarity.round(4).astype(float).round(4).tolist(), strict=True)
    return {"times": times.round(3).tolist(), "similarity": dict(named)}
