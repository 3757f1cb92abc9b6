"""Cuts of many clips as one ZIP archive, written piece by piece as it is sent."""

from __future__ import annotations

import io
import re
import tempfile
import zipfile
from collections.abc import Iterator, Sequence
from pathlib import Path, PurePosixPath
from typing import NamedTuple

from encoders.errors import MotionSeekError
from indexer.part_names import with_part
from search.export.credits import credits_text
from search.export.cut import write_cut
from search.export.hit_files import CREDITS
from search.source import MotionSource

#: What is told of clips that could not be written.
NOT_WRITTEN = "not_written.txt"
#: Bytes gathered before they are sent.
_PIECE = 1 << 18


class ArchivedCut(NamedTuple):
    """A motion, or a span of it in seconds of its file."""

    source: MotionSource
    start: float | None
    end: float | None


class _Pipe(io.RawIOBase):
    """Takes what a ZIP file writes until it is fetched."""

    def __init__(self) -> None:
        self._held = bytearray()

    def writable(self) -> bool:
        return True

    def write(self, data: bytes) -> int:  # type: ignore[override]
        self._held += data
        return len(data)

    def fetch(self, least: int = 1) -> bytes:
        """What was written, once it is at least so many bytes; else nothing."""
        if len(self._held) < least:
            return b""
        data, self._held = bytes(self._held), bytearray()
        return data


def archive(cuts: Sequence[ArchivedCut], format: str) -> Iterator[bytes]:
    """The bytes of a ZIP archive with a file of each cut, and the credits of their sources.

    One file at a time lies on disk, and little of the archive in memory. A cut that cannot be written is named in
    `not_written.txt`: the archive has begun by then.
    """
    pipe, failed = _Pipe(), []
    with zipfile.ZipFile(pipe, "w", zipfile.ZIP_DEFLATED) as packed, tempfile.TemporaryDirectory() as scratch:
        names = archive_names(cuts, format)
        for cut, name in zip(cuts, names, strict=True):
            out = Path(scratch) / f"cut.{format}"
            try:
                write_cut(cut.source, out, cut.start, cut.end)
                packed.write(out, name)
                out.unlink()
            except MotionSeekError:
                failed.append(name)
            if data := pipe.fetch(_PIECE):
                yield data
        places = {name: _place(cut.source) for cut, name in zip(cuts, names, strict=True) if name not in failed}
        if credits := credits_text({name: place for name, place in places.items() if place is not None}):
            packed.writestr(CREDITS, credits)
        if failed:
            packed.writestr(NOT_WRITTEN, "".join(f"{name}\n" for name in failed))
    yield pipe.fetch()


def archive_names(cuts: Sequence[ArchivedCut], format: str) -> list[str]:
    """A name for each cut: the path of its clip in its folder, with the span where it has one, and no name twice."""
    names: list[str] = []
    taken: set[str] = set()
    for cut in cuts:
        path = PurePosixPath(cut.source.path.removesuffix(with_part("", cut.source.part)))
        stem = _safe(f"{cut.source.root}/{path.with_suffix('')}{'_' if cut.source.part else ''}{cut.source.part}")
        stem += "" if cut.start is None else f"_{cut.start:g}-{'end' if cut.end is None else f'{cut.end:g}'}"
        number, name = 1, f"{stem}.{format}"
        while name.casefold() in taken:
            number += 1
            name = f"{stem} ({number}).{format}"
        taken.add(name.casefold())
        names.append(name)
    return names


def _place(source: MotionSource) -> tuple[Path, Path] | None:
    """The file of a clip and the indexed folder that it lies in; None for a motion without one."""
    if source.file is None or source.library is None:
        return None
    return source.file, source.library.clip(source.clip_id).root


def _safe(path: str) -> str:
    """A path without parts that lead out of a folder or that some systems refuse."""
    parts = [re.sub(r'[<>:"\\\\|?*\x00-\x1f]', "_", part) for part in path.split("/")]
    return "/".join(part for part in parts if part.strip(". ")) or "motion"
