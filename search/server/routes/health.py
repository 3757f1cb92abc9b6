"""Routes for monitoring: health and metrics."""

from __future__ import annotations

from fastapi import APIRouter, Response

from search.server import prometheus, response_models
from search.server.app_state import AppState
from search.server.exception_handlers import ANY, ok
from search.server.responses import json_response


def routes(state: AppState) -> APIRouter:
    """The routes for monitoring."""
    router = APIRouter(tags=["health"], default_response_class=Response, responses=ANY)

    @router.get("/healthz", responses=ok(response_models.HealthResponse))
    async def healthz() -> Response:
        """Whether the library can be searched."""
        state.library.snapshot  # noqa: B018  raises where it cannot
        return json_response({"status": "ok"})

    @router.get("/metrics", responses={200: {"content": {"text/plain": {"schema": {"type": "string"}}}}})
    async def metrics() -> Response:
        """Counters and timings in Prometheus's text format."""
        snapshot, batches = state.library.snapshot, state.text_batches
        gauges = {
            "motionseek_clips": ("gauge", "Clips that can be found.", snapshot.count),
            "motionseek_generation": ("gauge", "Generation of the library that is searched.", snapshot.generation),
            "motionseek_requests_in_flight": ("gauge", "Requests being processed.", state.metrics.in_flight),
            "motionseek_sentence_batches_total": ("counter", "Batches of new sentences.", batches.batches),
            "motionseek_sentences_total": ("counter", "New sentences encoded.", batches.items),
            "motionseek_uploads_refused_total": ("counter", "Uploads rejected.", state.uploads.rejected),
            "motionseek_resident_bytes": ("gauge", "Resident memory.", prometheus.resident_bytes()),
        }
        return Response(state.metrics.text(gauges), media_type=prometheus.CONTENT_TYPE)

    return router
