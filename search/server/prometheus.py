"""Metrics in Prometheus's text format: requests, their duration, and gauges of the server."""

from __future__ import annotations

import sys
import threading
import time
from bisect import bisect_left
from collections import defaultdict
from collections.abc import Mapping
from itertools import accumulate
from pathlib import Path

from starlette.types import ASGIApp, Message, Receive, Scope, Send

#: Upper bounds of the histogram's buckets, in seconds.
_BOUNDS = (0.002, 0.005, 0.01, 0.02, 0.05, 0.1, 0.25, 0.5, 1.0, 2.5, 5.0, 10.0, 30.0)

CONTENT_TYPE = "text/plain; version=0.0.4; charset=utf-8"


class Metrics:
    """Counts of requests by route, method and status code, and histograms of their duration by route."""

    def __init__(self) -> None:
        self.in_flight = 0
        self._requests: dict[tuple[str, str, int], int] = defaultdict(int)
        self._buckets: dict[str, list[int]] = defaultdict(lambda: [0] * (len(_BOUNDS) + 1))
        self._seconds: dict[str, float] = defaultdict(float)
        self._lock = threading.Lock()

    def record(self, route: str, method: str, code: int, seconds: float) -> None:
        """Count one request."""
        with self._lock:
            self._requests[route, method, code] += 1
            self._buckets[route][bisect_left(_BOUNDS, seconds)] += 1
            self._seconds[route] += seconds

    def text(self, gauges: Mapping[str, tuple[str, str, float]]) -> str:
        """All metrics as text; `gauges` are further ones: name -> (type, help, value)."""
        with self._lock:
            lines = [*_declared("motionseek_requests_total", "counter", "Requests processed.")]
            lines += [
                f'motionseek_requests_total{{route="{route}",method="{method}",code="{code}"}} {count}'
                for (route, method, code), count in sorted(self._requests.items())
            ]
            name = "motionseek_request_seconds"
            lines += _declared(name, "histogram", "Duration of a request.")
            for route, buckets in sorted(self._buckets.items()):
                bounds = (*(f"{bound:g}" for bound in _BOUNDS), "+Inf")
                cumulative = list(accumulate(buckets))
                lines += [
                    f'{name}_bucket{{route="{route}",le="{b}"}} {n}' for b, n in zip(bounds, cumulative, strict=True)
                ]
                lines.append(f'{name}_sum{{route="{route}"}} {self._seconds[route]:.6f}')
                lines.append(f'{name}_count{{route="{route}"}} {cumulative[-1]}')
        for name, (kind, meaning, value) in gauges.items():
            lines += [*_declared(name, kind, meaning), f"{name} {value:g}"]
        return "\n".join(lines) + "\n"


class MetricsMiddleware:
    """ASGI middleware that records every request."""

    def __init__(self, app: ASGIApp, metrics: Metrics) -> None:
        self._app = app
        self._metrics = metrics

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        if scope["type"] != "http":
            await self._app(scope, receive, send)
            return
        began, code = time.perf_counter(), 500

        async def send_recorded(message: Message) -> None:
            nonlocal code
            if message["type"] == "http.response.start":
                code = message["status"]
            await send(message)

        self._metrics.in_flight += 1
        try:
            await self._app(scope, receive, send_recorded)
        finally:
            self._metrics.in_flight -= 1
            # The route's pattern and a known method: labels that clients choose would grow without bound.
            route = getattr(scope.get("route"), "path", "") or "other"
            method = scope["method"] if scope["method"] in ("GET", "HEAD", "POST") else "other"
            self._metrics.record(route, method, code, time.perf_counter() - began)


def resident_bytes() -> int:
    """Resident memory of this process; 0 where the system does not report it."""
    try:
        for line in Path("/proc/self/status").read_text().splitlines():
            if line.startswith("VmRSS:"):
                return int(line.split()[1]) * 1024
    except OSError:
        pass
    try:
        import resource
    except ImportError:
        return 0
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    return peak if sys.platform == "darwin" else peak * 1024


def _declared(name: str, kind: str, meaning: str) -> tuple[str, str]:
    return f"# HELP {name} {meaning}", f"# TYPE {name} {kind}"
