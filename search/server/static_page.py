"""The page's static files: those of `search/page` with a known ending and no others, compressed where gzip is read."""

from __future__ import annotations

import gzip
from pathlib import Path, PurePosixPath

from anyio.to_thread import run_sync
from starlette.datastructures import Headers
from starlette.exceptions import HTTPException
from starlette.responses import FileResponse, Response
from starlette.staticfiles import StaticFiles
from starlette.types import Scope

FOLDER = Path(__file__).parents[1] / "page"

#: Ending -> media type. Fixed here, because the system's type for `.js` differs between computers.
MEDIA_TYPES = {
    ".html": "text/html; charset=utf-8",
    ".css": "text/css; charset=utf-8",
    ".js": "text/javascript; charset=utf-8",
    ".mjs": "text/javascript; charset=utf-8",
    ".json": "application/json",
    ".webmanifest": "application/manifest+json",
    ".svg": "image/svg+xml",
    ".png": "image/png",
    ".webp": "image/webp",
    ".ico": "image/x-icon",
    ".woff2": "font/woff2",
    ".txt": "text/plain; charset=utf-8",
}


#: Endings of files that are compressed already.
_DENSE = {".png", ".webp", ".woff2", ".ico"}


class StaticPage(StaticFiles):
    """Static files that browsers revalidate by their ETag, so that an update is seen at once.

    A file is compressed when it is first asked for, and again when it has changed.
    """

    def __init__(self, folder: Path = FOLDER) -> None:
        super().__init__(directory=folder, html=True, check_dir=False)
        self._compressed: dict[str, tuple[str, bytes]] = {}

    async def check_config(self) -> None:
        """Nothing to check: without the folder there is no page, and the routes still work."""

    async def get_response(self, path: str, scope: Scope) -> Response:
        """See `StaticFiles.get_response`."""
        if scope["method"] not in ("GET", "HEAD"):
            raise HTTPException(
                405, "method not allowed; /openapi.json lists the routes and their methods", {"Allow": "GET, HEAD"}
            )
        ending = PurePosixPath("index.html" if path == "." else path).suffix
        media_type = MEDIA_TYPES.get(ending)
        if media_type is None or "\0" in path:
            raise HTTPException(404, "no such page")
        response = await super().get_response(path, scope)
        response.headers["Cache-Control"] = "no-cache"
        if response.status_code == 200:
            response.headers["Content-Type"] = media_type
        if ending in _DENSE:
            return response
        response.headers["Vary"] = "Accept-Encoding"
        reads_gzip = "gzip" in Headers(scope=scope).get("accept-encoding", "")
        if not (reads_gzip and isinstance(response, FileResponse) and response.status_code == 200):
            return response
        headers = {name: response.headers[name] for name in ("Content-Type", "Cache-Control", "Vary", "Last-Modified")}
        tag = response.headers["ETag"]
        body = await run_sync(self._gzip, str(response.path), tag)
        return Response(body, headers={**headers, "Content-Encoding": "gzip", "ETag": f"W/{tag}"})

    def _gzip(self, path: str, tag: str) -> bytes:
        """The content of a file with an ETag, compressed."""
        known = self._compressed.get(path)
        if known is None or known[0] != tag:
            known = self._compressed[path] = tag, gzip.compress(Path(path).read_bytes(), 9)
        return known[1]
