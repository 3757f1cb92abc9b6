"""What changed in a folder since it was last indexed: by path, size and time, then by content."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from functools import partial
from pathlib import Path
from unicodedata import normalize

from encoders.errors import UnreadableMotion
from indexer.formats.opening import MAX_BYTES, TOO_LARGE, size, state
from indexer.ingest.scan import Scan, with_companions
from indexer.store import file_rows, read_options
from indexer.store.captions import Stated
from indexer.store.files import INDEXED, File, FileVersion, KnownFile
from indexer.store.read_options import ReadOptions
from indexer.store.writer import Writer


@dataclass(frozen=True)
class RequestedOptions:
    """How files are to be read in a run: the options that were given, None for those that were not.

    A file is read as it was before where no other option is given, so that options need not be repeated.

    Attributes
    ----------
    fps : float or None
    joint_map : mapping or None
        Target joint to joint name in the file.
    retry : bool
        Read unchanged files again that could not be read.
    up : str or None
        The axis that is up.
    """

    fps: float | None = None
    joint_map: Mapping[str, str] | None = None
    retry: bool = False
    up: str | None = None

    def for_file(self, stated: Stated, before: ReadOptions | None) -> ReadOptions:
        """The options for a file of which captions tables state some, and that was read with some before."""
        before = before or ReadOptions()
        joint_map = before.joint_map if self.joint_map is None else tuple(sorted(self.joint_map.items()))
        fps = stated.fps or self.fps or (None if before.from_table else before.fps)
        up = stated.up or self.up or (None if before.up_from_table else before.up)
        from_table = stated.fps is not None, stated.up is not None
        return ReadOptions(fps, from_table[0], joint_map, read_options.READER_VERSION, up, from_table[1])


@dataclass
class Changes:
    """The changes to the motions of one root.

    Attributes
    ----------
    read : list of FileVersion
        New and changed files.
    refused : list of (FileVersion, reason)
        Files that are not read because of what the archive states in which they lie.
    unread : list of (path, reason)
        Files that cannot be opened now. Nothing of them is recorded, so that they are tried again at the next run; a
        clip that is known stays as it was.
    moved : list of (file id, root id, File)
        Files that lie elsewhere than before, or are back.
    touched : list of (file id, File)
        Files with a new time and the old content.
    gone : list of KnownFile
        Files that have vanished.
    unchanged, failed_before : int
        Files as they were: those indexed, and those that could not be read.
    """

    read: list[FileVersion] = field(default_factory=list)
    refused: list[tuple[FileVersion, str]] = field(default_factory=list)
    unread: list[tuple[str, str]] = field(default_factory=list)
    moved: list[tuple[int, int, File]] = field(default_factory=list)
    touched: list[tuple[int, File]] = field(default_factory=list)
    gone: list[KnownFile] = field(default_factory=list)
    unchanged: int = 0
    failed_before: int = 0

    def count_as_before(self, known: KnownFile) -> None:
        """Count an unchanged file."""
        if known.state == INDEXED:
            self.unchanged += 1
        else:
            self.failed_before += 1


def compare(
    writer: Writer,
    root: Path,
    root_id: int,
    scan: Scan,
    motions: list[File],
    requested: RequestedOptions,
    stated: Mapping[str, Stated],
) -> Changes:
    """Compare the motions found under a root with what the library knows; changes nothing.

    Parameters
    ----------
    requested : RequestedOptions
        How files are to be read.
    stated : mapping
        Path in Unicode's composed form -> what captions tables state, which takes precedence over what is requested.
    """
    changes = Changes()
    known = file_rows.known(writer.connection, root_id)
    found = {file.path for file in motions}
    taken: set[int] = set()

    def has_left(path: str) -> bool:
        return path not in found and not scan.may_hold(path)

    origins = _Origins(writer, root_id, has_left)
    for file in motions:
        of_tables = stated.get(normalize("NFC", file.path), Stated())
        old = known.get(file.path)
        options = requested.for_file(of_tables, None if old is None else old.options)
        again = old is None or old.options != options or (requested.retry and old.state != INDEXED)
        if old is not None and not again and (old.size, old.mtime_ns) == (file.size, file.mtime_ns):
            changes.count_as_before(old)
            continue
        if file.refusal:
            changes.refused.append((FileVersion(root_id, file, "", options), file.refusal))
            continue
        try:
            seen = file.look(root)
            if file.size > MAX_BYTES and size(root / file.path) > MAX_BYTES:  # with companions it may be more
                raise UnreadableMotion(file.path, TOO_LARGE)
            source = FileVersion(root_id, file, file.hash(root), options, seen)
        except UnreadableMotion as error:
            changes.refused.append((FileVersion(root_id, file, "", options), error.reason))
            continue
        except OSError as error:
            changes.unread.append((file.path, (error.strerror or str(error)).lower()))
            continue
        if old is not None and not again and old.hash == source.hash:
            changes.touched.append((old.id, file))
            changes.count_as_before(old)
            continue
        origin = None
        if old is None or old.state != INDEXED:
            origin = origins.take(source, partial(requested.for_file, of_tables))
        if origin is None:
            changes.read.append(source)
        else:
            taken.add(origin)
            changes.moved.append((origin, root_id, file))
    changes.gone = [old for path, old in known.items() if old.id not in taken and has_left(path)]
    return changes


class _Origins:
    """Where the files of a root may have moved from; the files of one content are looked up once, however many."""

    def __init__(self, writer: Writer, root_id: int, has_left: Callable[[str], bool]) -> None:
        self._writer, self._root_id, self._has_left = writer, root_id, has_left
        self._by_content: dict[str, dict[ReadOptions, list[int]]] = {}

    def take(self, source: FileVersion, options: Callable[[ReadOptions], ReadOptions]) -> int | None:
        """The file that has moved here: of the same content, to be read as it was, and no longer where it was.

        It is given once.

        Parameters
        ----------
        options : callable
            The options for the file, given those it was read with before.
        """
        if source.hash not in self._by_content:
            self._by_content[source.hash] = self._left(source.hash)
        for before, files in self._by_content[source.hash].items():
            if files and options(before) == before:
                return files.pop()
        return None

    def _left(self, digest: str) -> dict[ReadOptions, list[int]]:
        """The files of that content that are no longer where they were, by how they were read, the first last."""
        found: dict[ReadOptions, list[int]] = {}
        for file_id, root_id, path, kept, before in reversed(file_rows.same_content(self._writer.connection, digest)):
            here = root_id == self._root_id
            if kept != INDEXED or (self._has_left(path) if here else _has_left(self._writer, root_id, path)):
                found.setdefault(before, []).append(file_id)
        return found


def _has_left(writer: Writer, root_id: int, path: str) -> bool:
    """Whether another root, which is there, holds no such file; False where that cannot be told."""
    root = writer.root_path(root_id)
    if os.path.lexists(root / path):
        return False
    try:
        state(root / path)
    except (FileNotFoundError, NotADirectoryError):
        return os.path.isdir(root)
    except (OSError, UnreadableMotion):
        pass
    return False


def looked_at_again(root: Path, source: FileVersion) -> FileVersion:
    """A file as it is now that has changed since it was looked at.

    Raises
    ------
    OSError, UnreadableMotion
        If it cannot be read; see `File.hash`.
    """
    parts = [File(path, *state(root / path)) for path in (source.file.path, *source.file.companions)]
    file = with_companions(parts[0], parts[1:])
    seen = file.look(root)
    return replace(source, file=file, hash=file.hash(root), seen=seen)


def record(writer: Writer, changes: Changes) -> None:
    """Write down all changes but those that need a file to be read."""
    for file_id, file in changes.touched:
        file_rows.update_time(writer.connection, file_id, file)
    for file_id, root_id, file in changes.moved:
        writer.move(file_id, root_id, file)
    writer.gone(known.id for known in changes.gone)
    for source, reason in changes.refused:
        writer.fail(source, reason)
