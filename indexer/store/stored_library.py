"""The library on disk, as its readers see it: clips, poses, captions, vectors."""

from __future__ import annotations

import os
import sqlite3
import threading
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import closing, contextmanager, suppress
from functools import wraps
from os import PathLike, fspath
from os.path import isfile
from pathlib import Path, PurePosixPath
from types import TracebackType
from typing import TYPE_CHECKING, Any, Concatenate, ParamSpec, TypeVar
from unicodedata import normalize

import numpy as np
from numpy.typing import NDArray

from encoders.arguments import checked_flag, checked_path, is_text, optional_number, shown
from encoders.bundle.windows import Windows
from encoders.errors import (
    ArgumentError,
    BundleMismatch,
    LibraryDamaged,
    LibraryError,
    LibraryNotFound,
    QueryError,
    UnknownClip,
)
from encoders.motion import FPS, Motion
from encoders.protocol import Encoder
from indexer.argument_checks import checked_clip_id, checked_encoder
from indexer.part_names import is_meant, splits
from indexer.read_motion import extent
from indexer.store import captions, poses, schema
from indexer.store.clips import LIVE, Caption, Clip, root_names, select
from indexer.store.files import ARRAYS_ROOT
from indexer.store.stats import stats
from indexer.vectors.library_indexes import CLIPS, WINDOWS, LibraryIndexes

if TYPE_CHECKING:
    from typing_extensions import Self


P = ParamSpec("P")
R = TypeVar("R")
AnyLibrary = TypeVar("AnyLibrary", bound="StoredLibrary")
#: Device, number and time of a file.
FileId = tuple[int, int, int]
CaptionVectors = tuple[list[str], NDArray[np.int64], NDArray[np.float32]]

#: The folder inside an indexed folder, and the file in it that is the truth.
FOLDER = ".motionseek"
FILE = "library.sqlite"

#: Values bound in one statement, and clips read by one.
_VARIABLES, _CHUNK = 500, 1000
#: Errors of a statement that is wrong, or of values that cannot be bound.
_WRONG_STATEMENT = (
    sqlite3.OperationalError, sqlite3.ProgrammingError, sqlite3.InterfaceError, OverflowError, ValueError
)  # fmt: skip
#: The largest integer of SQLite.
_LARGEST_ID = 2**63 - 1
#: Held while a library is made, so that no other thread opens it half made.
_creating = threading.Lock()


def one_snapshot(method: Callable[Concatenate[AnyLibrary, P], R]) -> Callable[Concatenate[AnyLibrary, P], R]:
    """A method of a library all of whose reading is of one snapshot; see `StoredLibrary.reading`."""

    @wraps(method)
    def inside(self: AnyLibrary, /, *args: P.args, **kwargs: P.kwargs) -> R:
        with self.reading():
            return method(self, *args, **kwargs)

    return inside


class StoredLibrary:
    """A library as it lies on disk. Safe to share between threads; what others write is seen at the next call."""

    def __init__(self, folder: Path, *, bundle: Encoder | None = None) -> None:
        self.folder = folder
        self._bundle = bundle
        self._local = threading.local()
        self._closed = False
        self._connections: list[sqlite3.Connection] = []
        self._captions: tuple[tuple[FileId, int], CaptionVectors] | None = None
        self.indexes = LibraryIndexes(folder / "vectors")
        if bundle is not None:
            self._check(bundle)

    @classmethod
    def open(cls, folder: str | PathLike[str], *, bundle: Encoder | None = None, create: bool = False) -> Self:
        """Open the library of an indexed folder, or a library folder itself.

        Parameters
        ----------
        folder : path
        bundle : Encoder, optional
            The model; the default one is loaded when it is first needed.
        create : bool
            Make `folder` itself an empty library folder where it is none yet.

        Raises
        ------
        ArgumentError
            If an argument is of a wrong type.
        LibraryNotFound
            If there is no library.
        LibraryDamaged, LibraryError
            If it cannot be read.
        BundleMismatch
            If `bundle` is not the model whose vectors the library holds.
        """
        given, bundle = checked_path("folder", folder), checked_encoder(bundle)
        with _creating:
            place = library_folder(given)
            if checked_flag("create", create) and place is None:
                place = _create(given)
        if place is None:
            raise LibraryNotFound(
                f"{given}: no library here; make one with motionseek.index or 'motionseek index {given}'"
            )
        return cls(place.resolve(), bundle=bundle)

    def close(self) -> None:
        """Close the files; later calls fail."""
        self._closed = True
        for connection in self._connections:
            connection.close()
        self._connections.clear()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    @property
    def connection(self) -> sqlite3.Connection:
        """This thread's connection; it can only read. A library that was put in place of the first one is opened anew.

        Raises
        ------
        LibraryNotFound
            If the library was removed.
        LibraryError
            If it is closed or cannot be opened.
        """
        if self._closed:
            raise LibraryError(f"{self.folder}: the library is closed")
        found: sqlite3.Connection | None = getattr(self._local, "connection", None)
        if found is not None and found.in_transaction:
            return found
        state = self._file_state()
        if found is not None and self._local.file == _file_id(state, found):
            return found
        if found is not None:
            self._connections.remove(found)
            found.close()
            self._local.connection = None
        found = self._local.connection = schema.connect(self.folder / FILE, writable=False)
        found.create_function("nfc", 1, composed, deterministic=True)
        found.create_function("folded", 1, folded, deterministic=True)
        self._local.file = _file_id(state, found)
        self._connections.append(found)
        return found

    def _file_state(self) -> os.stat_result:
        try:
            return (self.folder / FILE).stat()
        except OSError as error:
            raise LibraryNotFound(f"{self.folder / FILE}: cannot be reached any more ({error.strerror})") from None

    @contextmanager
    def reading(self) -> Iterator[sqlite3.Connection]:
        """One snapshot of the library for all that this thread reads inside; inner ones are part of the outer one.

        Raises
        ------
        LibraryDamaged, LibraryError
            If it cannot be read.
        """
        connection = self.connection
        if connection.in_transaction:
            yield connection
            return
        connection.execute("BEGIN")
        try:
            yield connection
        except sqlite3.DatabaseError as error:
            raise schema.cause(self.folder / FILE, error) from error
        finally:
            with suppress(sqlite3.Error):  # closed meanwhile, or damaged
                connection.execute("ROLLBACK")  # nothing was written

    @property
    def bundle(self) -> Encoder:
        """The model.

        Raises
        ------
        BundleMismatch
            If the default bundle is not the model whose vectors the library holds.
        """
        if self._bundle is None:
            from encoders.bundle.bundle import Bundle

            bundle = Bundle.load()
            self._check(bundle)
            self._bundle = bundle
        return self._bundle

    def _check(self, bundle: Encoder) -> None:
        model = self._model()
        if model is not None and model["fingerprint"] != bundle.fingerprint:
            raise BundleMismatch(
                f"{self.folder}: made with the model {model['name']} ({model['fingerprint'][:12]}), not with "
                f"{bundle.name} ({bundle.fingerprint[:12]}); index it again with rebuild=True (--rebuild)"
            )

    def _model(self) -> dict[str, Any] | None:
        return _one(
            self.connection,
            "SELECT models.* FROM models JOIN settings ON settings.key = 'model' AND settings.value = models.id",
        )

    @property
    def generation(self) -> int:
        """Grows with every batch that is written."""
        row = self.connection.execute("SELECT value FROM settings WHERE key = 'generation'").fetchone()
        return int(row[0])

    @property
    def roots(self) -> list[Path]:
        """The indexed folders."""
        return [root for root, _ in self._folders()]

    @property
    def captions_generation(self) -> int:
        """The generation in which a caption of a clip that was there before last changed; 0 if none ever has."""
        return captions.generation(self.connection)

    @property
    def root_names(self) -> list[str]:
        """The names of the indexed folders, unique in this library, in the order of `roots`."""
        return [name for _, name in self._folders()]

    def _folders(self) -> list[tuple[Path, str]]:
        """The indexed folders with their names; the root of clips added as arrays is none."""
        roots, arrays = self._roots(), (self.folder / ARRAYS_ROOT).resolve()
        names = root_names(roots)
        return [(root, names[key]) for key, root in roots.items() if root != arrays]

    def _roots(self) -> dict[int, Path]:
        """Every root by its id, that of clips added as arrays among them."""
        rows = self.connection.execute("SELECT id, path FROM roots ORDER BY id")
        return {key: (self.folder / path).resolve() for key, path in rows}

    def __len__(self) -> int:
        return int(self.connection.execute(f"SELECT count(*) {LIVE}").fetchone()[0])

    def ids(self, where: str = "", values: Sequence[Any] = ()) -> NDArray[np.int64]:
        """Sorted ids of the clips that meet an SQL condition on the columns of `clips` and `files`, values bound.

        Raises
        ------
        QueryError
            If it is no condition.
        """
        condition = f" AND ({where})" if where else ""
        connection = self.connection
        try:
            rows = connection.execute(f"SELECT clips.id {LIVE}{condition} ORDER BY clips.id", values).fetchall()
        except _WRONG_STATEMENT as error:
            raise QueryError(
                f"where={shown(where)} with values={shown(values)}: no condition on clips ({error})"
            ) from error
        return np.array([row[0] for row in rows], np.int64)

    @one_snapshot
    def clip(self, id: int) -> Clip:
        """One clip.

        Raises
        ------
        UnknownClip
            If there is none of that id.
        """
        found = self.clips_by_id([checked_clip_id(id)])
        if id not in found:
            raise UnknownClip(f"{self.folder}: no clip #{shown(id)}")
        return found[id]

    @one_snapshot
    def clips_by_id(self, ids: Iterable[int]) -> dict[int, Clip]:
        """The clips of these ids that exist, by id."""
        if not isinstance(ids, Iterable):
            raise ArgumentError(f"ids={shown(ids)} must be a list of numbers of clips")
        wanted = [i for i in dict.fromkeys(map(checked_clip_id, ids)) if abs(i) <= _LARGEST_ID]
        found: dict[int, Clip] = {}
        for first in range(0, len(wanted), _VARIABLES):
            part = wanted[first : first + _VARIABLES]
            marks = ",".join("?" * len(part))
            found |= {clip.id: clip for clip in self._select(f"clips.id IN ({marks})", part)}
        return found

    def clips(self) -> Iterator[Clip]:
        """Every clip, in order of its id; read in chunks, so that memory does not grow with the library."""
        last = -1
        while chunk := select(self.connection, self._roots(), "clips.id > ?", [last], limit=_CHUNK):
            yield from chunk
            last = chunk[-1].id

    def _select(self, condition: str, values: Sequence[Any]) -> list[Clip]:
        return select(self.connection, self._roots(), condition, values)

    @one_snapshot
    def find(self, ref: str | PathLike[str]) -> Clip:
        """The clip that is meant; see `matches`.

        Raises
        ------
        UnknownClip
            If no clip or several are meant.
        ArgumentError
            If it is no string or path.
        """
        found = self.matches(ref)
        if len(found) > 1:
            some = ", ".join(f"{self.reference(clip.root_name, clip.path)} (#{clip.id})" for clip in found[:5])
            more = ", ..." if len(found) > 5 else ""
            raise UnknownClip(f"{ref!s}: {len(found)} clips are called so; name one of them: {some}{more}")
        if not found:
            kind = "number" if str(ref)[:1] == "#" and str(ref)[1:].isdecimal() else "path or name"
            raise UnknownClip(f"{ref!s}: no clip of that {kind} in {self.folder}")
        return found[0]

    @one_snapshot
    def matches(self, ref: str | PathLike[str]) -> list[Clip]:
        """The clips that a reference may mean, of the first reading that gives any.

        "#12"; the name of a root and a path in it, where there are several roots; a path in a root; an absolute path;
        a name. Where none is spelt so, the composed and decomposed forms of Unicode are one. A path may name one of
        several clips of a file, as "file#part".
        """
        text = fspath(ref) if isinstance(ref, (str, PathLike)) else None
        if not isinstance(text, str):
            raise ArgumentError(f"ref={ref!r} must be a path, a name or '#number' of a clip")
        if "\0" in text or not is_text(text):
            return []
        if text.startswith("#") and text[1:].isdecimal() and len(text) <= len(str(_LARGEST_ID)):
            return list(self.clips_by_id([int(text[1:])]).values())
        return self._named(text, str, "{}") or ([] if text.isascii() else self._named(text, composed, "nfc({})"))

    def _named(self, text: str, spelt: Callable[[str], str], column: str) -> list[Clip]:
        """As `matches`, of a path or name; paths and columns are compared as spelt in one way."""
        text, roots = spelt(text), self._roots()
        path = PurePosixPath(text.replace("\\", "/"))
        names = root_names(roots) if len(roots) > 1 else {}
        named = {key: PurePosixPath(spelt(name)) for key, name in names.items()}
        below = [(key, path.relative_to(name).as_posix()) for key, name in named.items() if path.is_relative_to(name)]
        return (
            self._at(below, column)
            or self._of_path(path.as_posix(), column)
            or self._at(self.places(text, spelt), column)
            or self._select(f"{column.format('clips.name')} = ?", [text])
        )

    def places(self, path: str | PathLike[str], spelt: Callable[[str], str] = str) -> list[tuple[int, str]]:
        """What a path of the file system is called in the roots: the root's id, and the path in it.

        More than one where a root lies in another, or where links lead from one name of a file to another.

        Parameters
        ----------
        spelt : callable
            How names are spelt that are compared; what is returned is spelt so.
        """
        roots = {spelt(str(root)): key for key, root in self._roots().items()}
        absolute, real = os.path.abspath(path), os.path.realpath(path)
        found = [(above, Path(real)) for above in Path(real).parents]
        if absolute != real:
            found += [(above, Path(absolute)) for above in Path(absolute).parents]
        named = [
            (roots[name], spelt(place.relative_to(above).as_posix()))
            for above, place in found
            if (name := spelt(os.path.realpath(above))) in roots
        ]
        return list(dict.fromkeys(named))

    def _at(self, places: list[tuple[int, str]], column: str) -> list[Clip]:
        """The clips at paths in roots."""
        return [clip for key, place in places for clip in self._of_path(place, column, "files.root_id = ?", key)]

    def _of_path(self, path: str, column: str, condition: str = "1", *values: Any) -> list[Clip]:
        """The clip at a path, all clips of the file there, or the one of them that `file#part` names."""
        for name in ("clips.clip_path", "files.path"):
            if found := self._select(f"{column.format(name)} = ? AND {condition}", [path, *values]):
                return found
        for file, part in splits(path):
            if found := self._select(f"{column.format('files.path')} = ? AND {condition}", [file, *values]):
                return [clip for clip in found if is_meant(part, clip.part, clip.take)]
        return []

    def reference(self, root: str, path: str) -> str:
        """What `find` takes for a clip of a root: the path, after the root's name where there are several roots."""
        return f"{root}/{path}" if root and len(self._roots()) > 1 else path

    def root_references(self) -> list[tuple[int, str]]:
        """What may stand before a path in a root, with the root's id: its place, and its name if there are several."""
        roots = self._roots()
        names = root_names(roots).items() if len(roots) > 1 else ()
        return [*names, *((key, root.as_posix()) for key, root in roots.items())]

    @one_snapshot
    def motion(self, id: int, start: float | None = None, end: float | None = None) -> Motion:
        """The clip's motion, or a span of it in seconds of its file, out of the stored poses.

        Raises
        ------
        UnknownClip
            If there is no such clip.
        LibraryDamaged
            If its stored poses are corrupt or incomplete.
        QueryError
            If the span is empty or begins after the clip ends; `ArgumentError` if `start` or `end` is no number.
        """
        clip = self.clip(id)
        start, end = optional_number("start", start), optional_number("end", end)
        start = max((start or 0.0) - clip.start, 0.0)
        end = clip.duration if end is None else min(end - clip.start, clip.duration)
        if start >= end:
            raise QueryError(
                f"{clip.path}: span {start + clip.start:g} to {end + clip.start:g} s lies outside its "
                f"{extent(clip.start, clip.duration)}; give a start and end inside it, in seconds"
            )
        first = min(round(start * FPS), clip.frames - 1)
        last = max(round(end * FPS), first + 1)
        rows = self.connection.execute(
            "SELECT data FROM poses WHERE clip_id = ? AND chunk BETWEEN ? AND ? ORDER BY chunk",
            (clip.id, first // poses.CHUNK, (last - 1) // poses.CHUNK),
        )
        joints = [poses.unpack(data) for (data,) in rows]
        skipped = first // poses.CHUNK * poses.CHUNK
        if sum(map(len, joints)) < last - skipped:
            raise LibraryDamaged(
                f"{clip.path}: stored poses are incomplete; motionseek check --repair reads the file again"
            )
        return Motion(np.concatenate(joints)[first - skipped : last - skipped], FPS)

    @one_snapshot
    def captions(self, id: int) -> list[Caption]:
        """The captions of a clip, in the order in which they were read.

        Raises
        ------
        UnknownClip
            If there is no such clip.
        """
        id = self.clip(id).id
        rows = self.connection.execute(
            "SELECT texts.text, captions.start, captions.end FROM captions JOIN texts ON texts.id = captions.text_id "
            "WHERE captions.clip_id = ? ORDER BY captions.id",
            (id,),
        )
        return list(dict.fromkeys(Caption(*row) for row in rows))

    @one_snapshot
    def caption_vectors(self) -> CaptionVectors:
        """Every caption of every clip: texts, clip ids (N,), unit vectors (N, D); not to be changed."""
        held, state = self._captions, (self._local.file, self.generation)
        if held is None or held[0] != state:
            held = self._captions = state, self._read_caption_vectors()
        return held[1]

    def _read_caption_vectors(self) -> CaptionVectors:
        rows = self.connection.execute(
            "SELECT DISTINCT texts.text, captions.clip_id, text_embeddings.vector "
            "FROM captions JOIN clips ON clips.id = captions.clip_id "
            "JOIN files ON files.id = clips.file_id AND files.state = 'indexed' "
            "JOIN texts ON texts.id = captions.text_id "
            "JOIN text_embeddings ON text_embeddings.text_id = texts.id AND text_embeddings.model_id = "
            "(SELECT value FROM settings WHERE key = 'model')"
        ).fetchall()
        vectors = np.frombuffer(b"".join(row[2] for row in rows), np.float16)
        size = len(vectors) // len(rows) if rows else self._size()
        return (
            [row[0] for row in rows],
            np.array([row[1] for row in rows], np.int64),
            vectors.reshape(-1, size).astype(np.float32),
        )

    def _size(self) -> int:
        model = self._model()
        return self.bundle.latent_size if model is None else int(model["size"])

    def nearest_clips(
        self, queries: NDArray[np.float32], k: int, *, allowed: NDArray[np.int64] | None = None
    ) -> tuple[NDArray[np.float32], NDArray[np.int64]]:
        """The clips whose vectors are nearest to each query (Q, D): scores and clip ids, each (Q, k), best first.

        `allowed` are the sorted ids to choose from, None for all. Where there are fewer than k the id is -1.
        """
        with self.reading() as connection:
            return self.indexes.current(CLIPS, connection).search(queries, k, allowed=allowed)[:2]

    def nearest_windows(
        self, queries: NDArray[np.float32], k: int, *, allowed: NDArray[np.int64] | None = None
    ) -> tuple[NDArray[np.float32], NDArray[np.int64], NDArray[np.float32], NDArray[np.float32]]:
        """The windows nearest to each query (Q, D): scores, clip ids, starts and ends, each (Q, k).

        Starts and ends are seconds of the motion; those of its file are `Clip.start` later.

        `allowed` are the sorted clip ids to choose from, None for all. Where there are fewer than k the id is -1.
        """
        with self.reading() as connection:
            return self.indexes.current(WINDOWS, connection).search(queries, k, allowed=allowed)

    def prepare(self) -> None:
        """Bring the vector indexes and their files up to date now rather than at the next query."""
        with self.reading() as connection:
            for kind in (CLIPS, WINDOWS):
                self.indexes.current(kind, connection)

    @one_snapshot
    def windows(self, id: int) -> list[Windows]:
        """The windows of a clip, shortest length first."""
        clip = self.clip(id)
        rows = self.connection.execute(
            "SELECT length, starts, vectors FROM windows WHERE clip_id = ? AND model_id = "
            "(SELECT value FROM settings WHERE key = 'model') ORDER BY length",
            (clip.id,),
        )
        return [Windows.of(length, clip.duration, starts, vectors) for length, starts, vectors in rows]

    @one_snapshot
    def failures(self) -> list[tuple[str, str]]:
        """Files that could not be read, with the reason, as of the last time each was tried."""
        roots = self._roots()
        rows = self.connection.execute("SELECT root_id, path, reason FROM files WHERE state = 'failed' ORDER BY path")
        return [(str(roots[root] / path), reason) for root, path, reason in rows]

    @one_snapshot
    def stats(self) -> dict[str, Any]:
        """What the library holds, in numbers; see `indexer.store.stats.stats`."""
        return stats(self.connection, self.folder, self.roots)


def _file_id(state: os.stat_result, connection: sqlite3.Connection) -> FileId:
    """What tells the file that a connection reads from one put in its place, or changed where it must not."""
    may_change = not isinstance(connection, schema.FrozenConnection)
    return state.st_dev, state.st_ino, 0 if may_change else state.st_mtime_ns


def _one(connection: sqlite3.Connection, query: str) -> dict[str, Any] | None:
    cursor = connection.execute(query)
    row = cursor.fetchone()
    return None if row is None else dict(zip([column[0] for column in cursor.description], row, strict=True))


def composed(text: str) -> str:
    """A text with each character in Unicode's composed form, as most keyboards type it; Macs decompose names."""
    return text if text.isascii() else normalize("NFC", text)


def folded(text: str) -> str:
    """A text in composed form, for comparisons that take no notice of case."""
    return composed(text).casefold()


def library_folder(folder: Path) -> Path | None:
    """The library of an indexed folder, else the folder itself if it is a library; None where there is none."""
    return next((place for place in (folder / FOLDER, folder) if isfile(place / FILE)), None)


def _create(folder: Path) -> Path:
    """Make `folder` an empty library."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with closing(schema.connect(folder / FILE, writable=True)) as connection:
            schema.migrate(connection)
    except (OSError, LibraryError) as error:
        raise LibraryError(
            f"{folder}: cannot be written ({error}); keep the library in another folder (library=, --library)"
        ) from error
    return folder
