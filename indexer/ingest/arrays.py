"""A library from arrays: clips that are added and removed by id, without any file.

They lie in a root of their own, `indexer.store.files.ARRAYS_ROOT`, with the id in place of the path. Indexing folders
into the same library leaves them as they are.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path, PurePosixPath
from typing import Any, TypeAlias
from unicodedata import category

import numpy as np
from numpy.typing import ArrayLike

from encoders.arguments import finite_number, is_text, shown
from encoders.errors import ArgumentError, UnknownClip, UnreadableMotion
from encoders.motion import FPS, Motion, joint_array
from encoders.protocol import Encoder
from indexer.argument_checks import checked_rate, checked_up
from indexer.formats.numpy_files.array_layouts import SMPL
from indexer.ingest.caption_files import MAX_TEXT
from indexer.ingest.encode import captions_without_vectors, encode, insert_caption_vectors, use_model
from indexer.read_motion import Reading, ReadMotion
from indexer.rigs.retarget import retarget_with_reading
from indexer.store.captions import CaptionRow
from indexer.store.clips import Caption
from indexer.store.files import ArrayItem
from indexer.store.writer import Writer, writing

#: Frames (20 a second) and clips in a batch.
_BATCH_FRAMES, _BATCH_CLIPS = 12_000, 64
_LONGEST_ID = 500
#: Categories of Unicode: control characters, line and paragraph separators.
_CONTROL = ("Cc", "Zl", "Zp")

_Batch: TypeAlias = list[tuple[ArrayItem, list[CaptionRow], ReadMotion]]


@dataclass(frozen=True)
class NewClip:
    """A clip to add.

    Attributes
    ----------
    id : str
        Its name in the library, such as "walk" or "session_1/walk"; hits give it as their path.
    motion : Motion or array (T, 22, 3)
        A `Motion` is stored as it is, at 20 frames a second. An array is joints in SMPL order in any unit and
        orientation, brought to the target skeleton as a `.npy` file would be.
    captions : sequence of str or Caption
        One string is one caption.
    fps : float, optional
        Frames a second of an array, 20 if not given; a `Motion` has its own.
    up : str, optional
        The axis that is up in an array, one of `UP_AXES`; found by itself if not given.
    """

    id: str
    motion: Motion | ArrayLike
    captions: str | Caption | Sequence[str | Caption] = ()
    fps: float | None = None
    up: str | None = None


def add(folder: Path, items: Iterable[NewClip], encoder: Encoder) -> list[int]:
    """Add clips to the library in `folder`, which is created where there is none; their numbers, in order.

    A clip whose id is there already is replaced, with its captions. Clips are committed in batches; where an item is
    refused, the batches before it stay. A few clips are added all or not at all.

    Raises
    ------
    ArgumentError
        If an id, a caption or a frame rate makes no sense, or an array has another shape or values that are not finite.
    LibraryLocked
        If another process is writing the library.
    LibraryError
        If the library cannot be written.
    BundleMismatch
        If it holds the vectors of another model.
    """
    if isinstance(items, (str, bytes, Mapping)) or not isinstance(items, Iterable):
        raise ArgumentError(f"clips must be a list of NewClip, not {type(items).__name__}")
    numbers: list[int] = []
    with writing(folder) as writer:
        model_id = use_model(writer, encoder)
        for batch in _batches(items):
            numbers += _commit(writer, encoder, model_id, batch)
    return numbers


def remove(folder: Path, ids: Iterable[str]) -> None:
    """Remove clips that were added by `add`, with their captions: all of them or none.

    Raises
    ------
    ArgumentError
        If an id is no string.
    UnknownClip
        If an id names no such clip.
    LibraryLocked
        If another process is writing the library.
    """
    ids = list(ids)
    for id in ids:
        _check_text(id)
    with writing(folder) as writer, writer.batch():
        for id in dict.fromkeys(ids):
            if not writer.remove_array(id):
                raise UnknownClip(f"{id!r}: no clip of that id was added to {folder}")


def to_motion(
    motion: Motion | ArrayLike, fps: float | None = None, *, name: str = "the array", up: str | None = None
) -> ReadMotion:
    """A motion or an array of joints (T, 22, 3) as a motion at 20 frames a second; see `NewClip`.

    Parameters
    ----------
    name : str
        What errors call it.
    up : str, optional
        The axis that is up in an array.

    Raises
    ------
    ArgumentError
        If the array has another shape, values that are not finite, or the shape of no body; if the frame rate is not
        a number, or given for a `Motion` that has another.
    """
    rate, axis = checked_rate(fps, f"{name}: fps"), checked_up(up)
    if isinstance(motion, Motion):
        if axis not in (None, "y"):
            raise ArgumentError(f"{name}: up={up!r}: a Motion is Y up; give up with an array only")
        if rate not in (None, motion.fps):
            raise ArgumentError(
                f"{name}: fps={fps} is not the motion's own {motion.fps:g}; give fps with an array only"
            )
        checked_rate(motion.fps, f"{name}: motion.fps")
        return ReadMotion(motion.resample(FPS), reading=Reading(source_fps=motion.fps, source_frames=len(motion)))
    try:
        joints = joint_array(motion, np.float64)
    except (TypeError, ValueError, RuntimeError) as error:  # RuntimeError: a tensor that cannot become an array
        raise ArgumentError(f"{name}: a Motion or an array of joints (T, 22, 3) is needed; {error}") from None
    try:
        read, reading = retarget_with_reading(SMPL.take(joints, rate).with_up(axis), path=name)
    except UnreadableMotion as error:
        raise ArgumentError(str(error)) from None
    return ReadMotion(read, reading=reading if up is None else replace(reading, up_reason="given"))


def _batches(items: Iterable[NewClip]) -> Iterator[_Batch]:
    batch: _Batch = []
    for item in items:
        if not isinstance(item, NewClip):
            raise ArgumentError(f"clips must be a list of NewClip, not of {type(item).__name__}")
        batch.append((_record(item.id), _rows(item), to_motion(item.motion, item.fps, name=item.id, up=item.up)))
        if len(batch) >= _BATCH_CLIPS or sum(len(read.motion) for *_, read in batch) >= _BATCH_FRAMES:
            yield batch
            batch = []
    if batch:
        yield batch


def _record(id: Any) -> ArrayItem:
    """The record of an id, once that has proved to be one."""
    _check_text(id)
    parts = id.split("/")
    is_plain = id == PurePosixPath(id).as_posix() and not {".", ".."} & set(parts)
    if not is_plain or id.startswith(("/", "#")) or "\\" in id:
        raise ArgumentError(f"id {id!r} must be a path such as 'walk' or 'session_1/walk', and not begin with #")
    if any(category(letter) in _CONTROL for letter in id) or not all(map(_is_name, parts)):
        raise ArgumentError(f"id {id!r} must have no control characters, and no spaces around a name")
    if len(id) > _LONGEST_ID:
        raise ArgumentError(f"id {id[:40]!r}... must be at most {_LONGEST_ID} characters")
    return ArrayItem(id, 0, 0)


def _is_name(part: str) -> bool:
    """Whether a part of an id can be seen and has no spaces around it."""
    return part == part.strip() and any(category(letter)[0] not in "CZ" for letter in part)


def _check_text(id: Any) -> None:
    if not isinstance(id, str):
        raise ArgumentError(f"id {id!r} must be a string")
    if not is_text(id):
        raise ArgumentError(f"id {id[:40]!r} must be valid Unicode")


def _rows(item: NewClip) -> list[CaptionRow]:
    """The captions of an item, without empty ones and repetitions."""
    given = [item.captions] if isinstance(item.captions, (str, Caption)) else item.captions
    if isinstance(given, (bytes, Mapping)) or not isinstance(given, Iterable):
        raise ArgumentError(f"{item.id}: captions must be strings or Captions, not {given!r}")
    return list(dict.fromkeys(row for caption in given for row in _row(item.id, caption)))


def _row(id: str, given: Any) -> Iterator[CaptionRow]:
    caption = Caption(given) if isinstance(given, str) else given
    if not isinstance(caption, Caption) or not isinstance(caption.text, str):
        raise ArgumentError(f"{id}: captions must be strings or Captions, not {given!r}")
    text = " ".join(caption.text.split())
    if len(text) > MAX_TEXT or not is_text(text):
        raise ArgumentError(f"{id}: a caption must be at most {MAX_TEXT} characters of valid Unicode")
    start, end = finite_number(caption.start), finite_number(caption.end)
    is_whole = caption.start is None and caption.end is None
    if not is_whole and (start is None or end is None or not 0 <= start < end):
        raise ArgumentError(
            f"{id}: a caption's start={shown(caption.start)} and end={shown(caption.end)} must be seconds, "
            "the end after the start"
        )
    if text:
        yield CaptionRow(id, text, start, end)


def _commit(writer: Writer, encoder: Encoder, model_id: int, batch: _Batch) -> list[int]:
    """Encode and store a batch, with its captions, as one transaction; the numbers of its clips."""
    vectors = encode(encoder, [read.motion for *_, read in batch])
    with writer.batch():
        numbers = [
            writer.add_array(record, read, rows, encoded, model_id)
            for (record, rows, read), encoded in zip(batch, vectors, strict=True)
        ]
        for part in captions_without_vectors(writer, model_id):
            insert_caption_vectors(writer, encoder, model_id, part)
    return numbers
