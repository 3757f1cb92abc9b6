"""The page's files: those of `search/page` that are of a known kind, and nothing else."""

from __future__ import annotations

from pathlib import Path, PurePosixPath

from starlette.exceptions import HTTPException
from starlette.responses import Response
from starlette.staticfiles import StaticFiles
from starlette.types import Scope

from search.server.exception_handlers import Refused

FOLDER = Path(__file__).parents[1] / "page"

#: Ending -> media type. Written out, because what the system says of `.js` differs from computer to computer.
TYPES = {
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


class StaticPage(StaticFiles):
    """Static files, each asked about again with its ETag, so that an update shows at once and costs nothing else."""

    def __init__(self, folder: Path = FOLDER) -> None:
        super().__init__(directory=folder, html=True, check_dir=False)

    async def check_config(self) -> None:
        """Nothing: without its folder, there are no such pages."""

    async def get_response(self, path: str, scope: Scope) -> Response:
        """See `StaticFiles.get_response`."""
        if scope["method"] not in ("GET", "HEAD"):
            raise HTTPException(
                405, "nothing is sent here; the routes and their methods are in /openapi.json", {"Allow": "GET, HEAD"}
            )
        kind = TYPES.get(PurePosixPath("index.html" if path == "." else path).suffix)
        if kind is None or "\0" in path:
            raise Refused(404, "there is no such page")
        response = await super().get_response(path, scope)
        response.headers["Cache-Control"] = "no-cache"
        if response.status_code == 200:
            response.headers["Content-Type"] = kind
        return response
