"""Ingest: scan -> read and retarget -> features -> encode in batches -> commit. Run again, it does what changed."""

from __future__ import annotations

import json
import time
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from hashlib import blake2b
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING

from encoders.errors import LibraryError, UnreadableMotion
from encoders.motion import Motion
from indexer import load_motion
from indexer.encode import encode
from indexer.library import FOLDER, Library
from indexer.readers import READABLE
from indexer.scan import MOTION_LIKE, SKELETONS, content_hash, walk
from indexer.writer import GONE, INDEXED, Known, Source, Writer, writing

if TYPE_CHECKING:
    from encoders.bundle import Bundle

#: Called with how many files are done, how many there are to do, and the path of the last one.
Progress = Callable[[int, int, str], None]

#: Stored frames (20 a second) and clips a batch holds at most; one long take may be a batch of its own.
_BATCH_FRAMES, _BATCH_CLIPS = 40_000, 64

#: Changes when a file would be read differently than before, so that all are read again.
_READING = 1


@dataclass
class Summary:
    """What a run did.

    Attributes
    ----------
    indexed, unchanged, moved, gone : int
        Files: read and encoded, as they were, found elsewhere, vanished.
    failed : list of (path, reason)
        Files tried in this run that cannot be read.
    failed_before : int
        Files among the unchanged that could not be read last time either.
    warnings : list of str
        What was passed over.
    interrupted : bool
        Whether the run was ended early; what was done is kept.
    """

    indexed: int = 0
    unchanged: int = 0
    moved: int = 0
    gone: int = 0
    failed: list[tuple[str, str]] = field(default_factory=list)
    seconds: float = 0.0
    failed_before: int = 0
    warnings: list[str] = field(default_factory=list)
    interrupted: bool = False


@dataclass(frozen=True)
class _Task:
    """A file to be read."""

    root: Path
    source: Source
    fps: float | None

    @property
    def path(self) -> Path:
        return self.root / self.source.file.path


def index(
    roots: str | PathLike[str] | Iterable[str | PathLike[str]],
    *,
    library: str | PathLike[str] | None = None,
    bundle: Bundle | None = None,
    jobs: int | None = None,
    fps: float | None = None,
    joint_map: Mapping[str, str] | None = None,
    retry: bool = False,
    progress: Progress | None = None,
) -> Summary:
    """Bring the library of one or several folders up to date.

    Parameters
    ----------
    roots : path or paths
        Folders to index.
    library : path, optional
        The library folder; by default `.motionseek` in the folder, so it must be named for several.
    bundle : Bundle, optional
        The model; the default one if not given.
    jobs : int, optional
        Worker processes that read; by default one a core.
    fps : float, optional
        Frame rate of files that name none or a wrong one.
    joint_map : mapping, optional
        Target joint to joint name in the files.
    retry : bool
        Read files again that failed before, though they have not changed.
    progress : callable, optional
        See `Progress`.

    Raises
    ------
    LibraryError
        If a folder is missing, or the library cannot be written or is being written by another process.
    BundleMismatch
        If the library holds the vectors of another model.
    """
    began = time.monotonic()
    folders = _folders(roots)
    place = _place(folders, library)
    if bundle is None:
        from encoders.bundle import Bundle

        bundle = Bundle.load()
    summary = Summary()
    with writing(place) as writer:
        with writer.batch():
            model_id = writer.use_model(bundle)
            keys = {folder: writer.root(folder) for folder in folders}
        tasks: list[_Task] = []
        vanished: list[Known] = []
        map_ = dict(joint_map or {})
        for folder, key in keys.items():
            tasks += _compare(writer, folder, key, fps, map_, retry, summary, vanished)
        with writer.batch():
            writer.gone(known.id for known in vanished)
        summary.gone = sum(known.state == INDEXED for known in vanished)
        done = 0
        for batch in _batches(_read(tasks, map_)):
            good = [(task, read) for task, read in batch if isinstance(read, Motion)]
            encoded = encode(bundle, [motion for _, motion in good])
            with writer.batch():
                for (task, motion), vectors in zip(good, encoded, strict=True):
                    writer.add(task.source, motion, "", vectors, model_id)
                for task, read in batch:
                    if not isinstance(read, Motion):
                        writer.fail(task.source, read)
                        summary.failed.append((str(task.path), read))
            summary.indexed += len(good)
            done += len(batch)
            if progress is not None:
                progress(done, len(tasks), str(batch[-1][0].path))
    with Library.open(place, bundle=bundle) as made:
        made.prepare()
    summary.seconds = time.monotonic() - began
    return summary


def _folders(roots: str | PathLike[str] | Iterable[str | PathLike[str]]) -> list[Path]:
    given = [roots] if isinstance(roots, (str, PathLike)) else list(roots)
    folders = list(dict.fromkeys(Path(folder).resolve() for folder in given))
    for folder in folders:
        if not folder.is_dir():
            raise LibraryError(f"{folder}: no such folder; nothing is changed (is its drive there?)")
    return folders


def _place(folders: list[Path], library: str | PathLike[str] | None) -> Path:
    if library is not None:
        return Path(library).resolve()
    if len(folders) != 1:
        raise LibraryError(f"{len(folders)} folders need one library; name it with --library DIR")
    return folders[0] / FOLDER


def _compare(
    writer: Writer,
    root: Path,
    root_id: int,
    fps: float | None,
    joint_map: Mapping[str, str],
    retry: bool,
    summary: Summary,
    vanished: list[Known],
) -> list[_Task]:
    """What is to be read; what is where it was or has moved is noted at once."""
    recipe = _recipe(fps, joint_map)
    known = writer.known(root_id)
    tasks = []
    for file in walk(root, summary.warnings.append):
        if file.ending in SKELETONS or (file.ending not in READABLE and file.ending not in MOTION_LIKE):
            continue
        old = known.pop(file.path, None)
        if old is not None and old.recipe == recipe and not (retry and old.state != INDEXED):
            same = (old.size, old.mtime_ns) == (file.size, file.mtime_ns)
            if same or content_hash([root / file.path]) == old.hash:
                if not same:
                    with writer.batch():
                        writer.touch(old.id, file)
                summary.unchanged += 1
                summary.failed_before += old.state != INDEXED
                continue
        digest = content_hash([root / file.path])
        source = Source(root_id, file, digest, recipe)
        if old is None:
            moved = [row for row in writer.same_content(digest, recipe) if row[3] == GONE or row[2] in known]
            if moved:
                with writer.batch():
                    writer.move(moved[0][0], root_id, file)
                known.pop(moved[0][2], None)
                summary.moved += 1
                continue
        tasks.append(_Task(root, source, fps))
    vanished += known.values()
    return tasks


def _recipe(fps: float | None, joint_map: Mapping[str, str]) -> str:
    said = json.dumps([_READING, fps, sorted(joint_map.items())])
    return blake2b(said.encode(), digest_size=8).hexdigest()


def _read(tasks: Iterable[_Task], joint_map: dict[str, str]) -> Iterator[tuple[_Task, Motion | str]]:
    for task in tasks:
        try:
            yield task, load_motion(task.path, fps=task.fps, joint_map=joint_map or None)
        except UnreadableMotion as error:
            yield task, error.reason


def _batches(read: Iterable[tuple[_Task, Motion | str]]) -> Iterator[list[tuple[_Task, Motion | str]]]:
    batch: list[tuple[_Task, Motion | str]] = []
    frames = 0
    for item in read:
        batch.append(item)
        frames += len(item[1]) if isinstance(item[1], Motion) else 0
        if frames >= _BATCH_FRAMES or len(batch) >= _BATCH_CLIPS:
            yield batch
            batch, frames = [], 0
    if batch:
        yield batch
