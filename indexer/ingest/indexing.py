"""Ingest: scan -> read and retarget -> features -> encode in batches -> commit. Run again, it does what changed."""

from __future__ import annotations

import os
import time
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field
from os import PathLike
from pathlib import Path

from encoders.arguments import checked_flag, checked_path
from encoders.errors import ArgumentError, LibraryError, UnreadableMotion
from encoders.protocol import Encoder
from indexer.argument_checks import (
    checked_encoder,
    checked_jobs,
    checked_joint_map,
    checked_rate,
    checked_up,
)
from indexer.ingest import side_files
from indexer.ingest.changes import Changes, RequestedOptions, compare, looked_at_again, record
from indexer.ingest.encode import encode, encode_captions, use_model
from indexer.ingest.pool import Read, Request, read_all
from indexer.ingest.published_folders import advice, published
from indexer.ingest.reencode import reencode
from indexer.ingest.scan import walk
from indexer.ingest.side_files import SideFileChanges
from indexer.part_names import with_part
from indexer.store.captions import remove_side_files, stated_options
from indexer.store.files import INDEXED, FileVersion
from indexer.store.library_reader import FILE, FOLDER, library_folder
from indexer.store.stored_library import StoredLibrary
from indexer.store.writer import Writer, writing

#: Called with the number of files done, the number to do, and the path of the last one.
Progress = Callable[[int, int, str], None]

#: Stored frames (20 a second) and files in a batch; a long take is a batch of its own.
_BATCH_FRAMES, _BATCH_FILES = 12_000, 64
#: How often a file is read in a run that changes whenever it is.
_READINGS = 3
_NO_FOLDER = "no such folder, so nothing was changed; is its drive connected?"
_TRIED_AGAIN = "; it is tried again at the next run"


@dataclass
class Summary:
    """What a run did.

    Attributes
    ----------
    indexed, unchanged, moved, gone : int
        Files: read and encoded, unchanged, moved, vanished.
    failed : list of (path, reason)
        Files tried in this run that cannot be read.
    seconds : float
        How long it took.
    failed_before : int
        Unchanged files that could not be read when they were last tried.
    warnings : list of str
        What was skipped, and why.
    reading_warnings : list of (path, warning)
        What was left out, mended or taken for granted in the clips that were read.
    interrupted : bool
        Whether Ctrl-C ended the run early; what was committed is kept.
    """

    indexed: int = 0
    unchanged: int = 0
    moved: int = 0
    gone: int = 0
    failed: list[tuple[str, str]] = field(default_factory=list)
    seconds: float = 0.0
    failed_before: int = 0
    warnings: list[str] = field(default_factory=list)
    reading_warnings: list[tuple[str, str]] = field(default_factory=list)
    interrupted: bool = False


@dataclass(frozen=True)
class _Task:
    """A file to be read: its root, and what the library will record of it."""

    root: Path
    source: FileVersion

    @property
    def path(self) -> Path:
        return self.root / self.source.file.path

    def has_changed(self) -> bool:
        """Whether the file was written since its content was looked at, or has vanished."""
        try:
            return self.source.file.look(self.root) != self.source.seen
        except OSError:
            return True


def index(
    roots: str | PathLike[str] | Iterable[str | PathLike[str]],
    *,
    library: str | PathLike[str] | None = None,
    bundle: Encoder | None = None,
    jobs: int | None = None,
    fps: float | None = None,
    joint_map: Mapping[str, str] | None = None,
    up: str | None = None,
    retry: bool = False,
    rebuild: bool = False,
    progress: Progress | None = None,
) -> Summary:
    """Bring the library of one or several folders up to date.

    What is committed is kept: at Ctrl-C the run returns early; killed, it loses the batch in flight.

    Parameters
    ----------
    roots : path or paths
        Folders to index; with `library`, an empty list means those it already has.
    library : path, optional
        The library folder; by default that of the folder: the folder itself where it is a library, else `.motionseek`
        in it. It must be named for several folders.
    bundle : Encoder, optional
        The model; the default one if not given.
    jobs : int, optional
        Processes that read; by default one a core.
    fps : float, optional
        Frame rate of the files, where they state none or a wrong one; that of a captions table takes precedence. It is
        recorded for each file, as is `joint_map`: files read with other options before are read again, and later runs
        need not give them.
    joint_map : mapping, optional
        Target joint to joint name in the files; for those that have all these joints.
    up : str, optional
        The axis that is up in the files, "x", "y", "z", "-x", "-y" or "-z", whatever they say; recorded as is `fps`.
    retry : bool
        Read unchanged files again that could not be read before.
    rebuild : bool
        Encode all clips and captions again from the stored poses, also with another model than before; see `reencode`.
    progress : callable, optional
        See `Progress`.

    Raises
    ------
    ArgumentError
        If an argument is of a wrong type or out of range; nothing has been touched.
    BundleError
        If the model's vectors are not unit vectors of its size.
    LibraryError
        If the folder, or each of several, is missing or cannot be listed, or the library cannot be written or is being
        written by another process.
    BundleMismatch
        If the library holds the vectors of another model and `rebuild` is not given.
    """
    began = time.monotonic()
    bundle, jobs = checked_encoder(bundle), checked_jobs(jobs)
    requested = RequestedOptions(
        checked_rate(fps), checked_joint_map(joint_map), checked_flag("retry", retry), checked_up(up)
    )
    rebuild = checked_flag("rebuild", rebuild)
    if progress is not None and not callable(progress):
        raise ArgumentError(f"progress={progress!r} must be a function")
    place, folders = _places(roots, library)
    if bundle is None:
        from encoders.bundle.bundle import Bundle

        bundle = Bundle.load()
    summary = Summary()
    if rebuild and (place / FILE).is_file():
        summary.failed += reencode(place, bundle, progress=progress)
    with writing(place) as writer:
        model_id = use_model(writer, bundle)
        with writer.batch():
            keys = {writer.root(folder): folder for folder in folders if os.path.isdir(folder)}
        summary.failed += [(str(folder), _NO_FOLDER) for folder in folders if folder not in keys.values()]
        beside: dict[int, SideFileChanges] = {}
        tasks: list[_Task] = []
        for key, folder in keys.items():
            try:
                beside[key], changes = _update(writer, folder, key, requested, summary)
            except LibraryError as error:
                if len(folders) == 1:
                    raise
                summary.failed.append((str(folder), str(error).removeprefix(f"{folder}: ")))
                continue
            tasks += [_Task(folder, source) for source in changes.read]
        for _ in range(_READINGS):
            changed = _read_and_encode(writer, bundle, model_id, tasks, jobs or os.cpu_count() or 1, summary, progress)
            tasks = [] if summary.interrupted else _looked_at_again(changed, summary)
            if not tasks:
                break
        summary.failed += [(str(task.path), f"it changes while it is read{_TRIED_AGAIN}") for task in tasks]
        for key in beside:
            summary.warnings += side_files.unmatched(writer.connection, keys[key], beside[key])
        encode_captions(writer, bundle, model_id)
    with StoredLibrary.open(place, bundle=bundle) as made:
        made.prepare()
        if made.indexes.unsaved:
            summary.warnings.append(
                f"{made.folder / 'vectors'}: cannot be written ({made.indexes.unsaved}), which makes "
                "each search slower; make room and run 'motionseek index' again"
            )
    summary.seconds = time.monotonic() - began
    return summary


def _places(
    roots: str | PathLike[str] | Iterable[str | PathLike[str]], library: str | PathLike[str] | None
) -> tuple[Path, list[Path]]:
    """The library folder and the folders to index."""
    given = _paths(roots)
    if library is None and not given:
        raise ArgumentError("roots=[] needs a folder to index, or library=DIR whose folders are meant")
    if library is None and len(given) != 1:
        raise LibraryError(f"{len(given)} folders need one library; name its folder (library=, --library)")
    place = given[0] / FOLDER if library is None else checked_path("library", library)
    place = library_folder(given[0] if library is None else place) or place
    if not given:
        with StoredLibrary.open(place) as known:
            given = list(known.roots)
    folders = list(dict.fromkeys(Path(folder).resolve() for folder in given))
    if folders and not any(map(os.path.isdir, folders)):
        raise LibraryError(f"{folders[0]}: {_NO_FOLDER}")
    return place.resolve(), folders


def _paths(roots: str | PathLike[str] | Iterable[str | PathLike[str]]) -> list[Path]:
    if isinstance(roots, (str, PathLike)):
        roots = [roots]
    if isinstance(roots, (bytes, Mapping)) or not isinstance(roots, Iterable):
        raise ArgumentError(f"roots={roots!r} must be a folder or a list of folders")
    given = [checked_path("roots", root) for root in roots]
    for path in given:
        if os.path.isfile(path):  # unlike Path.is_file, False for a name that is too long
            raise ArgumentError(f"roots: {path} is a file; index its folder")
    return given


def _request(task: _Task) -> Request[_Task]:
    options = task.source.options
    return Request(task, task.path, options.fps, dict(options.joint_map) or None, options.up)


def _looked_at_again(tasks: list[_Task], summary: Summary) -> list[_Task]:
    """Files that changed while they were read, as they are now."""
    found = []
    for task in tasks:
        try:
            found.append(_Task(task.root, looked_at_again(task.root, task.source)))
        except FileNotFoundError:
            continue  # the next run will find it gone
        except (OSError, UnreadableMotion) as error:
            summary.failed.append((str(task.path), f"{_reason(error)}{_TRIED_AGAIN}"))
    return found


def _reason(error: OSError | UnreadableMotion) -> str:
    return error.reason if isinstance(error, UnreadableMotion) else (error.strerror or str(error)).lower()


def _update(
    writer: Writer, root: Path, root_id: int, requested: RequestedOptions, summary: Summary
) -> tuple[SideFileChanges, Changes]:
    """Walk one folder and record captions, moves and losses; what is to be read is among what is returned."""
    try:
        scan = walk(root)
    except OSError as error:
        raise LibraryError(f"{root}: cannot be listed ({error.strerror}), so nothing was changed") from error
    holds_files = any(folder.files for folder in scan.folders) or scan.unread
    if not holds_files and not writer.folder.is_relative_to(root) and writer.known(root_id):
        raise LibraryError(f"{root}: is empty, so nothing was changed; is its drive connected?")
    motions = {folder.path: folder.motions() for folder in scan.folders}
    found_beside = [pair for folder in scan.folders for pair in folder.side_files(motions[folder.path])]
    sets = published(scan.folders)
    found_beside += sets.texts
    found = [file for files in motions.values() for file in files if file.path not in sets.passed_over]
    with writer.batch():
        beside = side_files.update(
            writer.connection,
            root,
            root_id,
            found_beside,
            sets.lists,
            [file.path for file in found],
            scan.may_hold,
            summary.warnings.append,
        )
        stated = stated_options(writer.connection, root_id, without=beside.vanished)
        changes = compare(writer, root, root_id, scan, found, requested, stated)
        record(writer, changes)
        remove_side_files(writer.connection, beside.vanished)
    summary.unchanged += changes.unchanged
    summary.failed_before += changes.failed_before
    summary.moved += len(changes.moved)
    summary.gone += sum(known.state == INDEXED for known in changes.gone)
    summary.failed += [(str(root / source.file.path), reason) for source, reason in changes.refused]
    summary.failed += scan.failed + [(str(root / path), f"{reason}{_TRIED_AGAIN}") for path, reason in changes.unread]
    summary.warnings += [*scan.warnings, *filter(None, [advice(root)])]
    return beside, changes


def _read_and_encode(
    writer: Writer,
    bundle: Encoder,
    model_id: int,
    tasks: list[_Task],
    jobs: int,
    summary: Summary,
    progress: Progress | None,
) -> list[_Task]:
    """Read and store files; those that changed meanwhile are not stored but returned."""
    changed: list[_Task] = []
    batch: list[tuple[_Task, Read]] = []
    done = 0

    def commit() -> None:
        nonlocal done
        if not batch:
            return
        changed.extend(_commit(writer, bundle, model_id, batch, summary))
        done += len(batch)
        if progress is not None:
            progress(done, len(tasks), str(batch[-1][0].path))
        batch.clear()

    if progress is not None:
        progress(0, len(tasks), "")
    try:
        for task, read in read_all(map(_request, tasks), min(jobs, max(len(tasks), 1))):
            batch.append((task, read))
            if len(batch) >= _BATCH_FILES or sum(read.frames for _, read in batch) >= _BATCH_FRAMES:
                commit()
    except KeyboardInterrupt:
        summary.interrupted = True
    commit()
    return changed


def _commit(
    writer: Writer, bundle: Encoder, model_id: int, batch: list[tuple[_Task, Read]], summary: Summary
) -> list[_Task]:
    """Encode what was read and store it, with what could not be read, as one transaction.

    A file that changed since its content was first looked at is not stored but returned: what was read may be neither
    the old nor the new. Nothing is recorded of one that may be read another time.
    """
    changed = [task for task, read in batch if not read.passes and task.has_changed()]
    batch = [(task, read) for task, read in batch if task not in changed]
    encoded = iter(encode(bundle, [clip.motion for _, read in batch for clip in read.clips]))
    with writer.batch():
        for task, read in batch:
            if read.clips:
                writer.add(task.source, list(zip(read.clips, encoded, strict=False)), model_id)
            elif not read.passes:
                writer.fail(task.source, read.reason)
    for task, read in batch:
        if not read.clips:
            summary.failed.append((str(task.path), f"{read.reason}{_TRIED_AGAIN if read.passes else ''}"))
            continue
        summary.indexed += 1
        for clip in read.clips:
            name = with_part(str(task.path), clip.part)
            summary.reading_warnings += [(name, warning) for warning in clip.reading.warnings]
    return changed
