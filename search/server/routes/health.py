"""For machines that watch machines: is it well, and how busy."""

from __future__ import annotations

from fastapi import APIRouter, Response

from search.server import prometheus, response_models
from search.server.app_state import AppState
from search.server.exception_handlers import ANY, ok
from search.server.response_models import answer


def routes(state: AppState) -> APIRouter:
    """The routes for monitors."""
    router = APIRouter(tags=["health"], default_response_class=Response, responses=ANY)

    @router.get("/healthz", responses=ok(response_models.HealthResponse))
    async def healthz() -> Response:
        """Whether questions can be answered."""
        state.library.snapshot  # noqa: B018  raises where they cannot
        return answer({"status": "ok"})

    @router.get("/metrics", responses={200: {"content": {"text/plain": {"schema": {"type": "string"}}}}})
    async def numbers() -> Response:
        """Counts and times in Prometheus's text format."""
        snapshot, sentences = state.library.snapshot, state.sentences
        gauges = {
            "motionseek_clips": ("gauge", "Clips that can be found.", snapshot.count),
            "motionseek_generation": ("gauge", "AppState of the library that is answered from.", snapshot.generation),
            "motionseek_requests_in_flight": ("gauge", "Requests being answered.", state.metrics.in_flight),
            "motionseek_sentence_batches_total": ("counter", "Batches of new sentences.", sentences.batches),
            "motionseek_sentences_total": ("counter", "New sentences encoded.", sentences.items),
            "motionseek_uploads_refused_total": ("counter", "UploadStore refused.", state.uploads.refused),
            "motionseek_resident_bytes": ("gauge", "Memory held.", prometheus.resident_bytes()),
        }
        return Response(state.metrics.text(gauges), media_type=prometheus.CONTENT_TYPE)

    return router
