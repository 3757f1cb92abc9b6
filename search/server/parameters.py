"""Query parameters that several routes share, validated before any work is done."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from fastapi import Depends, Path, Query, Request
from fastapi.dependencies.models import Dependant
from starlette.exceptions import HTTPException

from search.query.filters import FilterArguments

_TEXT = {"min_length": 1, "max_length": 500}
_CLIP = r"^(#?[0-9]{1,18}|u[0-9a-f]{32})$"

Sentence = Annotated[str, Query(**_TEXT, description="A description of a motion in words.")]
Sentences = Annotated[list[Annotated[str, Query(**_TEXT)]], Query(min_length=1, max_length=8)]
#: A clip's number, or the key of an upload.
ClipParam = Annotated[str, Query(pattern=_CLIP, description="A clip's number, or the key of an upload.")]
ClipsParam = Annotated[
    list[Annotated[str, Query(pattern=_CLIP)]], Query(max_length=200, description="Clips' numbers, or keys of uploads.")
]
ClipInPath = Annotated[str, Path(pattern=_CLIP, description="A clip's number, or the key of an upload.")]
CountParam = Annotated[int, Query(ge=1, le=200, description="The number of results, at most.")]
OffsetParam = Annotated[int, Query(ge=0, le=10_000, description="The number of results to skip.")]
#: As `OffsetParam`, for rankings whose results are refined one by one.
ShortOffsetParam = Annotated[int, Query(ge=0, le=200, description="The number of results to skip.")]
#: See `search.ranking.answers.as_hits`.
StrengthParam = Annotated[
    Literal["weak", "plausible", "strong"] | None,
    Query(description="The least strength of a hit; if not given, plausible where the first hit is, else weak."),
]
SortParam = Annotated[
    Literal["name", "longest", "shortest", "newest"] | None, Query(description="The order of the clips.")
]
_SECONDS = Query(ge=0, le=1e6, allow_inf_nan=False)
Seconds = Annotated[float | None, _SECONDS]
FileName = Annotated[str, Query(min_length=1, max_length=255, description="The file's name; its ending is used.")]

#: OpenAPI: the body is a file.
FILE_BODY: dict[str, Any] = {
    "requestBody": {
        "required": True,
        "content": {"application/octet-stream": {"schema": {"type": "string", "format": "binary"}}},
    }
}


async def known_parameters(request: Request) -> None:
    """Refuse query parameters that a route does not have; a token may be there, read or not.

    Raises
    ------
    HTTPException
        422, with their names.
    """
    known = _query_names(request.scope["route"].dependant)
    unknown = sorted(set(request.query_params) - known - {"token"})
    if unknown:
        offered = f"there are {', '.join(sorted(known))}" if known else "this route has none"
        raise HTTPException(422, f"no parameter {', '.join(unknown)}; {offered}")


def _query_names(dependant: Dependant) -> set[str]:
    """The query parameters of a route and of what it depends on."""
    own = {field.alias for field in dependant.query_params}
    return own.union(*map(_query_names, dependant.dependencies))


async def filters(
    min_duration: Seconds = None,
    max_duration: Seconds = None,
    path: Annotated[str | None, Query(max_length=500)] = None,
    rig: Annotated[str | None, Query(max_length=200)] = None,
    format: Annotated[str | None, Query(max_length=200)] = None,
    captioned: bool | None = None,
    dataset_split: Annotated[str | None, Query(max_length=200)] = None,
    starred: bool | None = None,
    tag: Annotated[str | None, Query(max_length=200)] = None,
    collection: Annotated[str | None, Query(max_length=200)] = None,
) -> FilterArguments:
    """The filters as keyword arguments of `Library.search`."""
    return {
        "min_duration": min_duration,
        "max_duration": max_duration,
        "path": path,
        "rig": rig,
        "format": format,
        "captioned": captioned,
        "split": dataset_split,
        "starred": starred,
        "tag": tag,
        "collection": collection,
    }


FilterParams = Annotated[FilterArguments, Depends(filters)]


async def span(start: Seconds = None, end: Seconds = None) -> tuple[float | None, float | None]:
    """A span of a clip in seconds.

    Raises
    ------
    HTTPException
        422 if it is empty.
    """
    if end is not None and end <= (start or 0.0):
        raise HTTPException(422, "end: must be after start")
    return start, end


SpanParams = Annotated[tuple[float | None, float | None], Depends(span)]
