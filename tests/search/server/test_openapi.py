"""The server against its own description."""

from __future__ import annotations

import pytest
from hypothesis import HealthCheck, given, settings

from search.server.app import create_app
from search.server.snapshot_library import SnapshotLibrary

schemathesis = pytest.importorskip("schemathesis")
_checks = pytest.importorskip("schemathesis.specs.openapi.checks")


ROUTES = {
    ("/api/search", "get"),
    ("/api/moments", "get"),
    ("/api/curve", "get"),
    ("/api/describe", "get"),
    ("/api/describe", "post"),
    ("/api/similar", "get"),
    ("/api/similar", "post"),
    ("/api/motions", "get"),
    ("/api/motions/{clip}", "get"),
    ("/api/motions/{clip}/joints", "get"),
    ("/api/clips", "get"),
    ("/api/skeleton", "get"),
    ("/api/export", "get"),
    ("/api/formats", "get"),
    ("/api/uploads", "post"),
    ("/api/stats", "get"),
    ("/api/map", "get"),
    ("/api/facets", "get"),
    ("/api/stacks", "get"),
    ("/api/marks", "get"),
    ("/api/marks", "post"),
    ("/api/archive", "get"),
    ("/api/compose", "post"),
    ("/api/compose/file", "post"),
    ("/healthz", "get"),
    ("/metrics", "get"),
}


@pytest.fixture(scope="module")
def described(indexed, bundle):
    """The server as its description tells of it."""
    app = create_app(SnapshotLibrary.open(indexed, bundle=bundle))
    return schemathesis.openapi.from_asgi("/openapi.json", app, headers={"Host": "127.0.0.1"})


def test_every_route_is_described(client):
    paths = client.get("/openapi.json").json()["paths"]
    assert {(path, method) for path, routes in paths.items() for method in routes} == ROUTES


@pytest.mark.slow
def test_answers_are_as_described(described):
    operations = list(described.get_all_operations())
    assert len(operations) == len(ROUTES)
    for found in operations:

        @settings(max_examples=15, deadline=None, derandomize=True, suppress_health_check=list(HealthCheck))
        @given(case=found.ok().as_strategy())
        def holds(case):
            # A description cannot say that a sentence needs a word, or where a clip ends.
            case.call_and_validate(headers={"Host": "127.0.0.1"}, excluded_checks=[_checks.positive_data_acceptance])

        holds()
