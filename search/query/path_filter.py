"""The filter by path: a file or folder as it is called, else a pattern."""

from __future__ import annotations

import re
from collections.abc import Callable
from difflib import get_close_matches
from pathlib import PurePosixPath

import numpy as np
from numpy.typing import NDArray

from indexer.store.spelling import composed, folded
from indexer.store.stored_library import StoredLibrary

#: Clips whose paths are compared with one that matches nothing; folders that an error suggests, at most.
_COMPARED, _SUGGESTED = 5000, 4
_WILD = re.compile(r"[*?[]")


def clips_at(library: StoredLibrary, pattern: str) -> NDArray[np.int64]:
    """The sorted ids of the clips at a path, by the first reading of it that gives any.

    The path of a file or folder, whatever characters it has; a pattern in which only ``*`` and ``?`` stand for others;
    a pattern with sets such as ``[ab]``; any of these whatever the case. Each is relative to a root, follows the root's
    name, or is absolute; the composed and decomposed forms of Unicode are one.

    Parameters
    ----------
    pattern : str
        ``*`` is any run of characters, ``?`` one, ``[ab]`` one of these.
    """
    for function, spelt in (("nfc", composed), ("folded", folded)):
        places = _places(library, spelt(pattern.replace("\\", "/")), spelt)
        for literal in ("*?[", "[", ""):
            found = _matching(library, places, function, literal)
            if len(found):
                return found
    return np.empty(0, np.int64)


def nearest_paths(library: StoredLibrary, pattern: str) -> list[str]:
    """Folders and files that may have been meant by a path that matches nothing; where none is like it, folders."""
    clips = library.clips_by_id(library.ids()[:_COMPARED]).values()
    paths = list(dict.fromkeys(library.reference(clip.root_name, clip.path) for clip in clips))
    folders = list(dict.fromkeys(f"{above}/" for path in paths for above in PurePosixPath(path).parents if above.name))
    meant = _WILD.sub("", pattern).strip("/")
    near = get_close_matches(meant, [*(folder.rstrip("/") for folder in folders), *paths], n=_SUGGESTED)
    return [f"{path}/" if f"{path}/" in folders else path for path in near] or (folders or paths)[:_SUGGESTED]


def _places(library: StoredLibrary, pattern: str, spelt: Callable[[str], str]) -> list[tuple[int | None, str]]:
    """What a pattern may be relative to: every root (None), or the one that it names, with the rest of it."""
    plain = pattern.removeprefix("./").rstrip("/")
    places: list[tuple[int | None, str]] = [] if pattern and not pattern.strip("/") else [(None, plain)]
    for key, name in library.root_references():
        root = spelt(name)
        if plain and f"{plain}/".startswith(f"{root}/"):
            places.append((key, plain[len(root) + 1 :]))
    return places


def _matching(
    library: StoredLibrary, places: list[tuple[int | None, str]], function: str, literal: str
) -> NDArray[np.int64]:
    """The clips at any of the places; the characters of `literal` stand for themselves."""
    conditions: list[str] = ["0"]
    values: list[int | str] = []
    for root, rest in places:
        pattern = "".join(f"[{letter}]" if letter in literal else letter for letter in rest)
        alternatives = [pattern, f"{pattern}/*"] if literal == "*?[" else [pattern]
        alternatives = alternatives if rest else ["*"]
        columns = ("files.path", "clips.clip_path")
        matches = " OR ".join(f"{function}({column}) GLOB ?" for column in columns for _ in alternatives)
        conditions.append(f"({matches})" if root is None else f"(files.root_id = ? AND ({matches}))")
        values += [*([] if root is None else [root]), *alternatives, *alternatives]
    return library.ids(" OR ".join(conditions), values)
