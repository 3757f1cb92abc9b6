"""The page's static files: those of `search/page` with a known ending, and no others."""

from __future__ import annotations

from pathlib import Path, PurePosixPath

from starlette.exceptions import HTTPException
from starlette.responses import Response
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


class StaticPage(StaticFiles):
    """Static files that browsers revalidate by their ETag, so that an update is seen at once."""

    def __init__(self, folder: Path = FOLDER) -> None:
        super().__init__(directory=folder, html=True, check_dir=False)

    async def check_config(self) -> None:
        """Nothing to check: without the folder there is no page, and the routes still work."""

    async def get_response(self, path: str, scope: Scope) -> Response:
        """See `StaticFiles.get_response`."""
        if scope["method"] not in ("GET", "HEAD"):
            raise HTTPException(
                405, "method not allowed; /openapi.json lists the routes and their methods", {"Allow": "GET, HEAD"}
            )
        media_type = MEDIA_TYPES.get(PurePosixPath("index.html" if path == "." else path).suffix)
        if media_type is None or "\0" in path:
            raise HTTPException(404, "no such page")
        response = await super().get_response(path, scope)
        response.headers["Cache-Control"] = "no-cache"
        if response.status_code == 200:
            response.headers["Content-Type"] = media_type
        return response
