"""Routes of queries: search, moments, the similarity curve, describe, similar."""

from __future__ import annotations

from typing import Annotated, Any

from fastapi import APIRouter, Query, Request, Response
from starlette.exceptions import HTTPException

from search.documents import curve_document, description_document, moments_document, search_document
from search.hits import Hit
from search.moments.one_motion import moments_of
from search.moments.queried_motion import QueriedMotion
from search.query.filters import FilterArguments, refuse_filters
from search.query.mixed import WEIGHT, difference_of
from search.query.question import Question
from search.ranking.description import describe_motion
from search.server import response_models
from search.server.app_state import AppState
from search.server.exception_handlers import ANY, NO_CLIP, UPLOAD, ok
from search.server.parameters import (
    FILE_BODY,
    ClipParam,
    CountParam,
    FileName,
    FilterParams,
    OffsetParam,
    Sentence,
    Sentences,
    ShortOffsetParam,
    SpanParams,
    StrengthParam,
)
from search.server.responses import JsonAnswer, bytes_response
from search.server.served.served_library import SearchRequest
from search.source import MotionSource

_Steps = Annotated[list[Sentence], Query(max_length=8)]


def routes(state: AppState) -> APIRouter:
    """The routes of queries."""
    router = APIRouter(prefix="/api", tags=["queries"], default_response_class=Response, responses=ANY)
    library = state.library

    @router.get("/search", responses=ok(response_models.SearchResponse) | NO_CLIP)
    async def search(
        request: Request,
        q: Sentence,
        given: FilterParams,
        span: SpanParams,
        like: ClipParam | None = None,
        weight: Annotated[float, Query(ge=0, le=1, description="How much counts `q`, the rest being `like`.")] = WEIGHT,
        min_strength: StrengthParam = None,
        k: CountParam = 10,
        offset: OffsetParam = 0,
    ) -> Response:
        """The clips that match a sentence best, each with its best moment; with `like`, those like a clip as well."""
        if like is None and span != (None, None):
            raise HTTPException(422, "start, end: are a span of like, which is not given")
        if like is not None:

            def make() -> JsonAnswer:
                source, (start, end) = state.source(like), span
                found = library.search(
                    q, offset + k, like=source, start=start, end=end, weight=weight, min_strength=min_strength, **given
                )[offset:]
                return JsonAnswer(search_document(q, [difference_of(q)], _documents(found)), found)

            return bytes_response(await state.cached(_key(request), make))
        key, generation = (q, k, offset, min_strength, tuple(given.items())), library.snapshot.generation
        answer = await state.still_true(library.answer_cache.get(key))
        if answer is None:
            question = await state.encode(Question.of(q, split_steps=False))
            asked = SearchRequest(question, offset + k, given, min_strength)
            hits = await state.search_batches.submit(asked)
            answer = JsonAnswer(search_document(q, [q], _documents(hits[offset:])), hits[offset:])
            library.answer_cache.put(key, answer, library.stale_criterion(asked, hits), generation)
        return bytes_response(answer.data)

    @router.get("/moments", responses=ok(response_models.MomentsResponse) | NO_CLIP)
    async def moments(
        request: Request,
        given: FilterParams,
        q: Sentence | None = None,
        then: _Steps = [],  # noqa: B006
        meanwhile: Annotated[list[Sentence], Query(max_length=8, alias="while")] = [],  # noqa: B006
        split: bool = True,
        clip: ClipParam | None = None,
        min_strength: StrengthParam = None,
        k: CountParam = 10,
        offset: ShortOffsetParam = 0,
    ) -> Response:
        """The spans that match: in one clip, with the similarity over time, or anywhere in the library."""
        question = Question.of(q, then, meanwhile, split_steps=split)
        if clip is not None:
            refuse_filters(given)

        def in_library() -> JsonAnswer:
            hits = library.answer(question, k=offset + k, min_strength=min_strength, **given)[offset:]
            return JsonAnswer(moments_document(question, _documents(hits)), hits)

        def in_clip(ref: str) -> JsonAnswer:
            motion = QueriedMotion(library.bundle, state.source(ref), library.encode(question))
            hits = moments_of(motion, offset + k, min_strength)[offset:]
            return JsonAnswer(moments_document(question, _documents(hits, ref), motion.curve()), hits)

        make = in_library if clip is None else lambda: in_clip(clip)
        return bytes_response(await state.cached(_key(request), make))

    @router.get("/curve", responses=ok(response_models.CurveResponse) | NO_CLIP)
    async def curve(request: Request, clip: ClipParam, q: Sentences) -> Response:
        """The similarity of one clip to sentences over time."""
        question = _independent(q)

        def make() -> JsonAnswer:
            source = state.source(clip)
            named = {"clip": _ref(source, clip), "path": source.path, "start": round(source.start, 3)}
            named["duration"] = round(source.duration, 3)
            motion = QueriedMotion(library.bundle, source, library.encode(question))
            return JsonAnswer(named | curve_document(question.sentences, motion.curve()))

        return bytes_response(await state.cached(_key(request), make))

    def described(source: MotionSource, ref: str, span: tuple[float | None, float | None], k: int) -> JsonAnswer:
        texts, _, vectors = library.caption_vectors()
        found = describe_motion(library.bundle, source.cut(*span), k, texts, vectors)
        stale = source.stale()
        document = description_document(source.path, found) | {"stale": stale or None, "clip": _ref(source, ref)}
        return JsonAnswer(document, files=[(source.clip_id, source.file, stale)])

    @router.get("/describe", responses=ok(response_models.DescribeResponse) | NO_CLIP)
    async def describe(request: Request, clip: ClipParam, span: SpanParams, k: CountParam = 5) -> Response:
        """The sentences that match a clip, or a span of it, best."""
        return bytes_response(await state.cached(_key(request), lambda: described(state.source(clip), clip, span, k)))

    @router.post("/describe", openapi_extra=FILE_BODY, responses=ok(response_models.DescribeResponse) | UPLOAD)
    async def describe_upload(request: Request, name: FileName, span: SpanParams, k: CountParam = 5) -> Response:
        """The sentences that match an uploaded motion best."""
        upload = await state.uploads.receive(request, name)
        answer = await state.run_slow(lambda: described(upload.source, upload.key, span, k))
        return bytes_response(answer.data)

    def alike(
        source: MotionSource,
        ref: str,
        span: tuple[float | None, float | None],
        moments: bool,
        least: str | None,
        page: slice,
        given: FilterArguments,
    ) -> JsonAnswer:
        hits = library.similar(source, page.stop, *span, moments=moments, min_strength=least, **given)[page]
        return JsonAnswer({"query": source.path, "hits": _documents(hits), "clip": _ref(source, ref)}, hits)

    @router.get("/similar", responses=ok(response_models.SimilarResponse) | NO_CLIP)
    async def similar(
        request: Request,
        clip: ClipParam,
        span: SpanParams,
        given: FilterParams,
        moments: bool = False,
        min_strength: StrengthParam = None,
        k: CountParam = 10,
        offset: ShortOffsetParam = 0,
    ) -> Response:
        """The clips, or with `moments` the spans, most similar to a clip or a span of it."""
        page = slice(offset, offset + k)

        def make() -> JsonAnswer:
            return alike(state.source(clip), clip, span, moments, min_strength, page, given)

        return bytes_response(await state.cached(_key(request), make))

    @router.post("/similar", openapi_extra=FILE_BODY, responses=ok(response_models.SimilarResponse) | UPLOAD)
    async def similar_upload(
        request: Request,
        name: FileName,
        span: SpanParams,
        given: FilterParams,
        moments: bool = False,
        min_strength: StrengthParam = None,
        k: CountParam = 10,
        offset: ShortOffsetParam = 0,
    ) -> Response:
        """The clips, or with `moments` the spans, most similar to an uploaded motion."""
        upload = await state.uploads.receive(request, name)
        page = slice(offset, offset + k)
        answer = await state.run_slow(
            lambda: alike(upload.source, upload.key, span, moments, min_strength, page, given)
        )
        return bytes_response(answer.data)

    return router


def _key(request: Request) -> tuple[str, bytes]:
    """The cache key of a request."""
    return request.url.path, request.scope["query_string"]


def _documents(hits: list[Hit], upload: str | None = None) -> list[dict[str, Any]]:
    """Hits as JSON content; `upload` is the key of the upload they are in."""
    return [hit.document() | ({"clip": upload} if hit.clip_id < 0 else {}) for hit in hits]


def _ref(source: MotionSource, ref: str) -> int | str:
    return source.clip_id if source.clip_id >= 0 else ref


def _independent(sentences: list[str]) -> Question:
    """Sentences that are compared each on its own.

    Raises
    ------
    QueryError
        If one of them is empty.
    """
    for sentence in sentences:
        Question.of(sentence, split_steps=False)
    return Question(tuple(dict.fromkeys(sentences)))
