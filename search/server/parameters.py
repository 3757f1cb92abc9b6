"""What requests may carry: the parameters that several routes share, checked before any work is done."""

from __future__ import annotations

from typing import Annotated, Any

from fastapi import Depends, Query

from search.server.exception_handlers import Refused

_TEXT = {"min_length": 1, "max_length": 500}

Sentence = Annotated[str, Query(**_TEXT, description="What happens, in words.")]
Sentences = Annotated[list[Annotated[str, Query(**_TEXT)]], Query(min_length=1, max_length=8)]
#: A number of the library, or what an upload was called.
ClipRef = Annotated[str, Query(pattern=r"^([0-9]{1,18}|u[0-9a-f]{32})$", description="A clip, by its number.")]
Count = Annotated[int, Query(ge=1, le=200, description="At most so many.")]
Offset = Annotated[int, Query(ge=0, le=10_000, description="Leave out so many of the first.")]
#: As `Offset`, of answers that are looked for one by one.
NearOffset = Annotated[int, Query(ge=0, le=200, description="Leave out so many of the first.")]
_Seconds = Query(ge=0, le=1e6, allow_inf_nan=False)
Start = Annotated[float | None, _Seconds]
End = Annotated[float | None, _Seconds]
FileName = Annotated[str, Query(min_length=1, max_length=255, description="The file's name, for its ending.")]


async def filters(
    min_duration: Annotated[float | None, _Seconds] = None,
    max_duration: Annotated[float | None, _Seconds] = None,
    path: Annotated[str | None, Query(max_length=500)] = None,
    rig: Annotated[str | None, Query(max_length=200)] = None,
    format: Annotated[str | None, Query(max_length=200)] = None,
    captioned: bool | None = None,
) -> dict[str, Any]:
    """The filters that were given, as `SearchableLibrary` takes them."""
    given = {
        "min_duration": min_duration,
        "max_duration": max_duration,
        "path": path,
        "rig": rig,
        "format": format,
        "captioned": captioned,
    }
    return {name: value for name, value in given.items() if value is not None}


Filters = Annotated[dict[str, Any], Depends(filters)]


async def span(start: Start = None, end: End = None) -> tuple[float | None, float | None]:
    """A span of a clip.

    Raises
    ------
    Refused
        If it ends before it begins.
    """
    if end is not None and end <= (start or 0.0):
        raise Refused(422, "end: must come after start")
    return start, end


Span = Annotated[tuple[float | None, float | None], Depends(span)]
