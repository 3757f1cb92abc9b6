"""Watching folders: whether a file in them has come, gone or changed, by names, sizes and times."""

from __future__ import annotations

import time
from collections.abc import Iterator, Sequence
from hashlib import blake2b
from os import PathLike
from pathlib import Path

from indexer.ingest.scan import walk

#: Seconds between two looks, at least, and how many times as long as a look takes.
PAUSE, _SHARE = 2.0, 10.0


def seen(folders: Sequence[str | PathLike[str]]) -> bytes:
    """A digest of the names, sizes and times of all files in folders; one that cannot be listed counts as empty."""
    digest = blake2b(digest_size=16)
    for folder in folders:
        try:
            scan = walk(Path(folder).resolve())
        except OSError:
            continue
        files = [(file.path, file.size, file.mtime_ns) for found in scan.folders for file in found.files]
        digest.update(repr((str(folder), sorted(files), sorted(scan.failed))).encode("utf-8", "surrogatepass"))
    return digest.digest()


def changes(folders: Sequence[str | PathLike[str]], known: bytes, *, pause: float = PAUSE) -> Iterator[None]:
    """Yield whenever a file in folders has changed and nothing has for a moment since; never ends.

    What changes while the caller works is found at the next look. Looks take a small share of the time, however many
    files there are.

    Parameters
    ----------
    known : bytes
        What was `seen` before the folders were last indexed.
    """
    while True:
        time.sleep(pause)
        began = time.monotonic()
        now = seen(folders)
        if now != known:
            while (later := _after(pause, folders)) != now:
                now = later
            known = now
            yield
        else:
            time.sleep(min(_SHARE * (time.monotonic() - began), 60.0))


def _after(pause: float, folders: Sequence[str | PathLike[str]]) -> bytes:
    time.sleep(pause)
    return seen(folders)
