"""HumanML3D and KIT-ML in their own folders, as their authors' scripts write them: a file of captions for each motion.

texts/000001.txt                a caption a line: text#tokens#start#end, 0.0#0.0 for the whole motion
new_joint_vecs/000001.npy       its motion as features
new_joints/000001.npy           the same as joints
test.txt                        a split: ids, one a line
"""

from __future__ import annotations

import math
import warnings
from collections.abc import Callable, Iterator
from pathlib import Path

from encoders.errors import DatasetError, MissingMotion, MissingSplit, MotionSeekWarning
from encoders.features.registry import FeatureKind
from indexer.datasets.timed_captions import CaptionedEntry, TimedCaption, read_list
from indexer.ingest.caption_files import read_lines

TEXTS = "texts"
_FEATURES, _JOINTS = "new_joint_vecs", "new_joints"


def has_texts(folder: Path) -> bool:
    """Whether a folder is laid out so."""
    return (folder / TEXTS).is_dir() and any((folder / name).is_dir() for name in (_FEATURES, _JOINTS))


def motions_beside_texts(folder: Path, kind: FeatureKind) -> Path:
    """The folder of motions: features where the model reads these, else joints where they are there."""
    names = (_FEATURES, _JOINTS) if kind.name == "humanml3d" else (_JOINTS, _FEATURES)
    return next(folder / name for name in names if (folder / name).is_dir())


def read_text_entries(folder: Path, split: str, seconds: Callable[[str], float]) -> Iterator[CaptionedEntry]:
    """The motions that a split lists, each with its captions; those without a motion or without captions are left out.

    Both data sets list ids of which some have no motion: their authors' loaders pass over these, too.

    Parameters
    ----------
    seconds : function
        The duration of the motion of an id.

    Raises
    ------
    MissingSplit
        If there is no such list; names those that are there.
    DatasetError
        If an id is none, or a file of captions cannot be read.
    """
    for key in _ids(folder, split):
        if not key.isalnum() or not key.isascii():
            raise DatasetError(f"{folder / split}.txt: {key!r} is no id")
        file = folder / TEXTS / f"{key}.txt"
        try:
            duration = seconds(key)
        except MissingMotion:
            continue
        if file.is_file() and (captions := tuple(_captions(file, duration))):
            yield CaptionedEntry(key, key, duration, captions)


def _ids(folder: Path, split: str) -> list[str]:
    keys = read_list(folder, split)
    if keys is None:
        there = ", ".join(sorted(file.stem for file in folder.glob("*.txt"))) or "none"
        raise MissingSplit(f"{folder}: has no split {split!r} ({split}.txt); there: {there}")
    return keys


def _captions(file: Path, duration: float) -> Iterator[TimedCaption]:
    try:
        rows = read_lines(file, lambda problem: warnings.warn(problem, MotionSeekWarning, stacklevel=2))
    except OSError as error:
        raise DatasetError(f"{file}: cannot be read ({error})") from error
    # A little later, so that the last frame is not lost where seconds become frames again.
    whole = math.nextafter(duration, math.inf)
    for text, start, end in rows:
        yield TimedCaption(text, start or 0.0, whole if end is None else end)
