"""The motions to be judged: those of a folder, and what a table says of each."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from os.path import splitext
from pathlib import Path

from encoders.errors import QueryError
from encoders.motion import Motion
from indexer.datasets.archive_tables import TableRow, read_columns
from indexer.formats.table import READABLE
from indexer.ingest.load import read_motion

#: What a table may say of a motion beside its path.
COLUMNS = ("text", "label", "reference", "transitions")
#: Names that an error lists.
_NAMED = 3


@dataclass(frozen=True)
class JudgedMotion:
    """A motion and what it should be.

    Attributes
    ----------
    name : str
        Its path in the folder, without ending.
    text, label, reference : str
        The sentence and the action that it was generated for, and the name of the real motion it should be like; empty
        where nobody says.
    transitions : tuple of int
        Frames at which one action ends and the next begins.
    """

    name: str
    motion: Motion
    text: str = ""
    label: str = ""
    reference: str = ""
    transitions: tuple[int, ...] = ()


def read_folder(folder: Path, described: Path | None = None) -> list[JudgedMotion]:
    """Every motion of a folder and its subfolders, in the order of their names.

    Parameters
    ----------
    described : Path, optional
        A table with the columns path and any of `COLUMNS` (transitions in seconds, parted by spaces), or a folder with
        NAME.txt for each motion NAME, whose first line up to a `#` is its sentence, as HumanML3D has them. Every
        motion of one must be there in the other.

    Raises
    ------
    QueryError
        If there is no motion, motions and descriptions do not match, or a description cannot be read.
    UnreadableMotion
        If a file holds no motion that can be read, or numbers that are none.
    """
    files = {path.relative_to(folder).with_suffix("").as_posix(): path for path in _motion_files(folder)}
    if not files:
        raise QueryError(f"{folder}: no motion in this folder; files end in {', '.join(sorted(READABLE))}")
    rows = {} if described is None else _descriptions(described, files)
    return [_read(name, path, rows.get(name, {}), described) for name, path in files.items()]


def _motion_files(folder: Path) -> Iterator[Path]:
    for path in sorted(folder.rglob("*")):
        hidden = any(part.startswith(".") for part in path.relative_to(folder).parts)
        if path.suffix.lower() in READABLE and not hidden and path.is_file():
            yield path


def _descriptions(described: Path, files: Mapping[str, Path]) -> dict[str, TableRow]:
    """Name -> what is said of it."""
    if described.is_dir():
        return {name: {"text": _first_sentence(described / f"{name}.txt")} for name in files}
    rows: dict[str, TableRow] = {}
    for row in read_columns(described, ("path",)):
        path = Path(row["path"]).as_posix()
        name = path if path in files else splitext(path)[0]
        if name in rows:
            raise QueryError(f"{described}: has two rows for {row['path']}")
        rows[name] = row
    surplus, missing = [name for name in rows if name not in files], [name for name in files if name not in rows]
    if surplus:
        raise QueryError(f"{described}: {_list(surplus)} of {len(rows)} rows are no motion of the folder")
    if missing:
        raise QueryError(f"{described}: has no row for {_list(missing)} of the folder's {len(files)} motions")
    known = [column for column in COLUMNS if column in next(iter(rows.values()))]
    if not known:
        raise QueryError(f"{described}: says nothing of the motions; it needs a column {', '.join(COLUMNS)}")
    return rows


def _first_sentence(path: Path) -> str:
    try:
        lines = path.read_text("utf-8-sig").splitlines()
    except (OSError, UnicodeDecodeError) as error:
        raise QueryError(f"{path}: no text for this motion ({error})") from error
    sentences = [line.split("#")[0].strip() for line in lines]
    if not any(sentences):
        raise QueryError(f"{path}: holds no sentence")
    return next(filter(None, sentences))


def _read(name: str, path: Path, row: Mapping[str, str | None], described: Path | None) -> JudgedMotion:
    read = read_motion(str(path))
    said = {column: (row.get(column) or "").strip() for column in COLUMNS}
    for column in ("text", "label"):
        if column in row and not said[column]:
            raise QueryError(f"{described}: the {column} of {name} is missing")
    reference = Path(said["reference"]).as_posix() if said["reference"] else ""
    frames = tuple(_frames(said["transitions"], read.motion, read.reading.start, f"{described}: {name}"))
    return JudgedMotion(name, read.motion, said["text"], said["label"], reference, frames)


def _frames(times: str, motion: Motion, start: float, place: str) -> Iterator[int]:
    """Times in seconds of a file as frames of its motion."""
    for word in times.replace(",", " ").split():
        try:
            frame = round((float(word) - start) * motion.fps)
        except (ValueError, OverflowError):
            raise QueryError(f"{place}: {word!r} is no time in seconds") from None
        if not 0 < frame < len(motion):
            raise QueryError(f"{place}: a transition at {word} s lies outside its {motion.duration:.2f} s")
        yield frame


def paired(generated: Sequence[JudgedMotion], real: Sequence[JudgedMotion]) -> list[int] | None:
    """For each generated motion the place of its reference; None where no motion has one.

    The reference is that of the table, else the real motion of the same name.

    Raises
    ------
    QueryError
        If some motions have a reference and some have none, or one that a table names is not there.
    """
    places = {motion.name: i for i, motion in enumerate(real)}
    found: list[int | None] = []
    for motion in generated:
        wanted = motion.reference or motion.name
        found.append(places.get(wanted, places.get(splitext(wanted)[0])))
        if motion.reference and found[-1] is None:
            raise QueryError(f"{motion.name}: its reference {motion.reference} is not among the {len(real)} references")
    missing = [motion.name for motion, place in zip(generated, found, strict=True) if place is None]
    if len(missing) == len(generated):
        return None
    if missing:
        raise QueryError(
            f"no reference for {_list(missing)} of {len(generated)} motions; names must be equal, "
            "or a table's column 'reference' must state them"
        )
    return [place for place in found if place is not None]


def _list(names: Sequence[str]) -> str:
    """How many names, and the first of them."""
    more = f" and {len(names) - _NAMED} more" if len(names) > _NAMED else ""
    return f"{len(names)} ({', '.join(names[:_NAMED])}{more})"
