"""What the folders of motions say about credits and terms of use."""

from __future__ import annotations

import re
from collections.abc import Mapping
from itertools import takewhile
from pathlib import Path

from indexer.formats.table import is_motion

_NAMES = re.compile(r"(licen[sc]e|terms|sources|credits)", re.IGNORECASE)
#: Bytes that are taken from one file, and from all.
_MOST, _MOST_IN_ALL = 64_000, 1_000_000


def credits_text(files: Mapping[str, tuple[Path, Path]]) -> str:
    """The credits of files, one part for each file of credits, under its name and the files it is for.

    Parameters
    ----------
    files : mapping
        Name of each file that is to be credited -> its source, and the indexed folder that holds the source.

    Returns
    -------
    str
        Empty where no folder says anything.
    """
    named: dict[tuple[Path, Path], list[str]] = {}
    for name, (source, root) in files.items():
        for credit in credit_files(source, root):
            named.setdefault((credit, root), []).append(name)
    parts: list[str] = []
    left = _MOST_IN_ALL
    for (credit, root), names in sorted(named.items()):
        try:
            with credit.open("rb") as file:
                data = file.read(min(_MOST, left) + 1)
        except OSError:
            continue
        text = data[: min(_MOST, left)].decode("utf-8-sig", errors="replace").strip()
        cut = f"\n(cut; the rest is in {credit})" if len(data) > min(_MOST, left) else ""
        title = (Path(root.name) / credit.relative_to(root)).as_posix()
        parts.append(f"== {title}\n== of {', '.join(names)}\n\n{text}{cut}\n")
        left -= min(len(data), left)
    return "\n".join(parts)


def credit_files(source: Path, root: Path) -> list[Path]:
    """The files of credits nearest to a source: in its folder, else in the folders above up to `root`."""
    inside = root.resolve()
    folders = list(takewhile(lambda folder: folder == root or root in folder.parents, source.parents))
    for folder in folders:
        try:
            beside = sorted(path for path in folder.iterdir() if _NAMES.match(path.name) and path.is_file())
        except OSError:
            continue
        found = [path for path in beside if not is_motion(path.suffix.lower()) and inside in path.resolve().parents]
        if found:
            return found
    return []
