"""Ingest: scan -> read and retarget -> features -> encode in batches -> commit. Run again, it does what changed."""

from __future__ import annotations

import os
import time
from collections.abc import Iterable, Mapping
from contextlib import closing
from os import PathLike
from pathlib import Path

from encoders.arguments import checked_flag, checked_path
from encoders.errors import ArgumentError, LibraryError
from encoders.protocol import Encoder
from indexer.argument_checks import (
    checked_encoder,
    checked_jobs,
    checked_joint_map,
    checked_rate,
    checked_up,
)
from indexer.ingest import side_files
from indexer.ingest.changes import Changes, RequestedOptions, compare, record
from indexer.ingest.encode import encode_captions, use_model
from indexer.ingest.published_folders import advice, published
from indexer.ingest.reencode import model_of, reencode
from indexer.ingest.scan import walk
from indexer.ingest.side_files import SideFileChanges
from indexer.ingest.storing import TRIED_AGAIN, Progress, Summary, Task, read_and_store
from indexer.shards.in_step import bring_in_step
from indexer.shards.pose_files import PoseFiles
from indexer.shards.shard import Shard
from indexer.store import file_rows
from indexer.store.captions import remove_side_files, stated_options
from indexer.store.files import INDEXED
from indexer.store.library_reader import FILE, FOLDER, library_folder
from indexer.store.stored_library import StoredLibrary
from indexer.store.writer import Writer, writing
from indexer.vectors.milvus.milvus_address import MilvusAddress
from indexer.vectors.milvus.milvus_collection import MilvusCollection

_NO_FOLDER = "no such folder, so nothing was changed; is its drive connected?"


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
    vectors: str | PathLike[str] | None = None,
    poses: str | PathLike[str] | None = None,
    shard: str | None = None,
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
        The model; if not given, that of the library, the shipped one for a new library.
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
        Where no model is given and that of the library is not here any more, with the shipped one.
    vectors : str or path, optional
        A collection of Milvus, "milvus://HOST:PORT/COLLECTION", or a file of milvus-lite, "NAME.db", that is brought in
        step with the library; see `indexer.shards.in_step`.
    poses : str or path, optional
        With `vectors`: a folder, or an address that fsspec knows, into which the poses go; see `PoseFiles`.
    shard : str, optional
        "I/N": only the files of the I-th of N indexers of one archive; see `Shard`. Each needs a library of its own,
        by default one in the folder's `.motionseek/shards`.
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
    part = Shard.of(shard)
    place, folders = _places(roots, library, part)
    if vectors is None and poses is not None:
        raise ArgumentError("poses is for the servers of a collection; give vectors, too")
    collection = None if vectors is None else MilvusAddress.of(vectors)
    if bundle is None:
        bundle = model_of(place, rebuild=rebuild)
    summary = Summary()
    if collection is not None and not collection.is_file:  # before hours of work
        _collection(collection, bundle).close()
    if rebuild and (place / FILE).is_file():
        summary.failed += reencode(place, bundle, progress=progress)
    with writing(place) as writer:
        model_id = use_model(writer, bundle)
        with writer.batch():
            keys = {writer.root(folder): folder for folder in folders if os.path.isdir(folder)}
        summary.failed += [(str(folder), _NO_FOLDER) for folder in folders if folder not in keys.values()]
        beside: dict[int, SideFileChanges] = {}
        tasks: list[Task] = []
        for key, folder in keys.items():
            try:
                beside[key], changes = _update(writer, folder, key, requested, summary, part)
            except LibraryError as error:
                if len(folders) == 1:
                    raise
                summary.failed.append((str(folder), str(error).removeprefix(f"{folder}: ")))
                continue
            tasks += [Task(folder, source) for source in changes.read]
        read_and_store(writer, bundle, model_id, tasks, jobs or os.cpu_count() or 1, summary, progress)
        for key in beside if part.is_whole else ():  # tables name the files of all shards
            summary.warnings += side_files.unmatched(writer.connection, keys[key], beside[key])
        encode_captions(writer, bundle, model_id)
    with StoredLibrary.open(place, bundle=bundle) as made:
        if collection is not None:
            _send(made, bundle, collection, part, poses, summary)
        else:
            made.prepare()
        if made.indexes.unsaved:
            summary.warnings.append(
                f"{made.folder / 'vectors'}: cannot be written ({made.indexes.unsaved}), which makes "
                "each search slower; make room and run 'motionseek index' again"
            )
    summary.seconds = time.monotonic() - began
    return summary


def _send(
    library: StoredLibrary,
    model: Encoder,
    address: MilvusAddress,
    shard: Shard,
    poses: str | PathLike[str] | None,
    summary: Summary,
) -> None:
    """Bring a collection in step; nothing is removed from it after a run that has not seen all files."""
    complete = not summary.interrupted and not any(
        reason.endswith(TRIED_AGAIN) or reason == _NO_FOLDER for _, reason in summary.failed
    )
    place = None if poses is None else PoseFiles(poses)
    with closing(_collection(address, model)) as collection:
        sent = bring_in_step(library, collection, shard, poses=place, complete=complete)
    summary.sent, summary.withdrawn = sent.put, sent.removed
    summary.failed += [(path, f"is not in {address}: {reason}") for path, reason in sent.refused]


def _collection(address: MilvusAddress, model: Encoder) -> MilvusCollection:
    return MilvusCollection(address, create=(model.fingerprint, model.name, model.latent_size))


def _places(
    roots: str | PathLike[str] | Iterable[str | PathLike[str]], library: str | PathLike[str] | None, shard: Shard
) -> tuple[Path, list[Path]]:
    """The library folder and the folders to index."""
    given = _paths(roots)
    if library is None and not given:
        raise ArgumentError("roots=[] needs a folder to index, or library=DIR whose folders are meant")
    if library is None and len(given) != 1:
        raise LibraryError(f"{len(given)} folders need one library; name its folder (library=, --library)")
    if library is None and not shard.is_whole:
        place = given[0] / FOLDER / "shards" / str(shard.number)
    else:
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


def _update(
    writer: Writer, root: Path, root_id: int, requested: RequestedOptions, summary: Summary, shard: Shard
) -> tuple[SideFileChanges, Changes]:
    """Walk one folder and record captions, moves and losses; what is to be read is among what is returned."""
    try:
        scan = walk(root)
    except OSError as error:
        raise LibraryError(f"{root}: cannot be listed ({error.strerror}), so nothing was changed") from error
    holds_files = any(folder.files for folder in scan.folders) or scan.unread
    if not holds_files and not writer.folder.is_relative_to(root) and file_rows.known(writer.connection, root_id):
        raise LibraryError(f"{root}: is empty, so nothing was changed; is its drive connected?")
    motions = {folder.path: [file for file in folder.motions() if shard.has(file.path)] for folder in scan.folders}
    found_beside = [pair for folder in scan.folders for pair in folder.side_files(motions[folder.path])]
    sets = published(scan.folders)
    found_beside += [(file, about) for file, about in sets.texts if any(map(shard.has, about))]
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
    summary.failed += scan.failed + [(str(root / path), f"{reason}{TRIED_AGAIN}") for path, reason in changes.unread]
    summary.warnings += [*scan.warnings, *filter(None, [advice(root)])]
    return beside, changes
