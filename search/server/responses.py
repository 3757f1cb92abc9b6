"""JSON responses: documents, and errors in the form `{"error": "..."}`."""

from __future__ import annotations

import json
import time
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from fastapi import Response
from fastapi.responses import JSONResponse

from indexer.ingest.unindexed import file_state
from indexer.store.stored_library import StoredLibrary
from search.hits import Hit

#: Seconds for which the files of an answer are not looked at again.
_LOOK = 1.0


class JsonAnswer:
    """A document as JSON that can be given again, as long as the files it tells of are as it says.

    Parameters
    ----------
    hits : sequence of Hit
        Whose files it tells of.
    files : sequence of (int, Path or None, str)
        Others: the number of a clip, its file, and what became of that, as of `Hit`.
    """

    def __init__(
        self, document: Any, hits: Sequence[Hit] = (), files: Sequence[tuple[int, Path | None, str]] = ()
    ) -> None:
        self.data = to_json(document)
        told = [*((hit.clip_id, hit.file, hit.stale) for hit in hits), *files]
        self._files = [one for one in told if one[0] >= 0]
        self._looked = time.monotonic()

    @property
    def is_recent(self) -> bool:
        """Whether its files were looked at a moment ago, or there are none."""
        return not self._files or time.monotonic() - self._looked < _LOOK

    def holds(self, library: StoredLibrary) -> bool:
        """Look at the files: whether each is as the answer says."""
        self._looked = time.monotonic()
        return all(file is None or file_state(library, clip, file) == stale for clip, file, stale in self._files)


def to_json(content: Any) -> bytes:
    """A document as compact JSON; numbers must be finite."""
    return json.dumps(content, allow_nan=False, separators=(",", ":")).encode()


def json_response(content: Any, code: int = 200) -> Response:
    """A document as a response."""
    return bytes_response(to_json(content), code)


def bytes_response(document: bytes, code: int = 200) -> Response:
    """A document that is JSON already as a response."""
    return Response(document, code, media_type="application/json", headers={"Cache-Control": "no-store"})


def error_response(code: int, message: str) -> JSONResponse:
    """An error as a response."""
    headers = {"Cache-Control": "no-store"}
    if code == 503:
        headers["Retry-After"] = "1"
    if code == 401:
        headers["WWW-Authenticate"] = "Bearer"
    return JSONResponse({"error": message}, code, headers)
