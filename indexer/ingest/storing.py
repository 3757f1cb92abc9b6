"""Files are read, encoded and committed in batches, and those that change meanwhile are read again."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path

from encoders.errors import UnreadableMotion
from encoders.protocol import Encoder
from indexer.ingest.changes import looked_at_again
from indexer.ingest.encode import encode
from indexer.ingest.pool import Read, Request, read_all
from indexer.part_names import with_part
from indexer.store.files import FileVersion
from indexer.store.writer import Writer

#: Called with the number of files read, the number to read, and the path of the last one.
Progress = Callable[[int, int, str], None]

#: Stored frames (20 a second) and files in a batch; a long take is a batch of its own.
_BATCH_FRAMES, _BATCH_FILES = 12_000, 64
#: How often a file is read in a run that changes whenever it is.
_READINGS = 3
#: What is added to a reason that may pass.
TRIED_AGAIN = "; it is tried again at the next run"


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
    sent, withdrawn : int
        Clips put into a collection of Milvus, and removed from it.
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
    sent: int = 0
    withdrawn: int = 0


@dataclass(frozen=True)
class Task:
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


def read_and_store(
    writer: Writer,
    bundle: Encoder,
    model_id: int,
    tasks: list[Task],
    jobs: int,
    summary: Summary,
    progress: Progress | None,
) -> None:
    """Read files in so many processes, and encode and store their motions; the summary says what came of it.

    At Ctrl-C what has been read is stored, and `summary.interrupted` is set.
    """
    for _ in range(_READINGS):
        changed = _read_and_encode(writer, bundle, model_id, tasks, jobs, summary, progress)
        tasks = [] if summary.interrupted else _looked_at_again(changed, summary)
        if not tasks:
            return
    summary.failed += [(str(task.path), f"it changes while it is read{TRIED_AGAIN}") for task in tasks]


def _read_and_encode(
    writer: Writer,
    bundle: Encoder,
    model_id: int,
    tasks: list[Task],
    jobs: int,
    summary: Summary,
    progress: Progress | None,
) -> list[Task]:
    """Read and store files; those that changed meanwhile are not stored but returned."""
    changed: list[Task] = []
    batch: list[tuple[Task, Read]] = []

    def commit() -> None:
        if batch:
            changed.extend(_commit(writer, bundle, model_id, batch, summary))
            batch.clear()

    if progress is not None:
        progress(0, len(tasks), "")
    try:
        for done, (task, read) in enumerate(read_all(map(_request, tasks), min(jobs, max(len(tasks), 1))), start=1):
            batch.append((task, read))
            if progress is not None:
                progress(done, len(tasks), str(task.path))
            if len(batch) >= _BATCH_FILES or sum(read.frames for _, read in batch) >= _BATCH_FRAMES:
                commit()
    except KeyboardInterrupt:
        summary.interrupted = True
    commit()
    return changed


def _commit(
    writer: Writer, bundle: Encoder, model_id: int, batch: list[tuple[Task, Read]], summary: Summary
) -> list[Task]:
    """Encode what was read and store it, with what could not be read, as one transaction.

    A file that changed since its content was first looked at is not stored but returned: what was read may be neither
    the old nor the new. Nothing is recorded of one that may be read another time. One that crashes is tried again once.
    """
    changed = [task for task, read in batch if not read.passes and task.has_changed()]
    batch = [(task, read) for task, read in batch if task not in changed]
    encoded = iter(encode(bundle, [clip.motion for _, read in batch for clip in read.clips]))
    again = {task for task, read in batch if read.passes}
    with writer.batch():
        for task, read in batch:
            if read.clips:
                writer.add(task.source, list(zip(read.clips, encoded, strict=False)), model_id)
            elif not read.passes and writer.fail(task.source, read.reason, doubted=read.doubted):
                again.add(task)
    for task, read in batch:
        if not read.clips:
            summary.failed.append((str(task.path), f"{read.reason}{TRIED_AGAIN if task in again else ''}"))
            continue
        summary.indexed += 1
        for clip in read.clips:
            name = with_part(str(task.path), clip.part)
            summary.reading_warnings += [(name, warning) for warning in clip.reading.warnings]
    return changed


def _request(task: Task) -> Request[Task]:
    options = task.source.options
    return Request(task, task.path, options.fps, dict(options.joint_map) or None, options.up)


def _looked_at_again(tasks: list[Task], summary: Summary) -> list[Task]:
    """Files that changed while they were read, as they are now."""
    found = []
    for task in tasks:
        try:
            found.append(Task(task.root, looked_at_again(task.root, task.source)))
        except FileNotFoundError:
            continue  # the next run will find it gone
        except (OSError, UnreadableMotion) as error:
            summary.failed.append((str(task.path), f"{_reason(error)}{TRIED_AGAIN}"))
    return found


def _reason(error: OSError | UnreadableMotion) -> str:
    return error.reason if isinstance(error, UnreadableMotion) else (error.strerror or str(error)).lower()
