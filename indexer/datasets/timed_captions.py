"""Sentences about spans of motions: `annotations.json` as TMR's data sets have it, and BABEL's own files.

    {"000001": {"path": "CMU/13/13_18_poses", "duration": 7.3,
                "annotations": [{"seg_id": "000001_0", "text": "a man boxes", "start": 0.0, "end": 7.3}]}}

BABEL (Punnakkal et al., CVPR 2021) has labels of the whole sequence and of spans in its `train.json` and `val.json`;
they become the same, in that order.
"""

from __future__ import annotations

import json
import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path, PurePosixPath
from typing import Any

from encoders.errors import DatasetError, MissingSplit

#: A file of annotations is at most so large; HumanML3D's has 12 MB, BABEL's 60.
_MAX_BYTES = 1 << 30


@dataclass(frozen=True)
class TimedCaption:
    """A sentence about a span (seconds) of a motion."""

    text: str
    start: float
    end: float

    @property
    def duration(self) -> float:
        """Seconds."""
        return self.end - self.start


@dataclass(frozen=True)
class CaptionedEntry:
    """A motion of a data set with its sentences.

    Attributes
    ----------
    key : str
        As the lists of splits name it.
    path : str
        Where its motion lies in the folder of motions, without an ending; parts divided by "/".
    duration : float
        Of the whole motion, in seconds.
    captions : tuple of TimedCaption
        In the order of the file; for BABEL those of the whole sequence come first.
    """

    key: str
    path: str
    duration: float
    captions: tuple[TimedCaption, ...]


def read_annotations(path: Path) -> dict[str, CaptionedEntry]:
    """The motions of a file of annotations by their keys; those without a sentence are left out.

    Raises
    ------
    DatasetError
        If it cannot be read, is of another layout, or a path leads out of the folder of motions.
    """
    try:
        if path.stat().st_size > _MAX_BYTES:
            raise DatasetError(f"{path}: is larger than {_MAX_BYTES >> 30} GB, too large for annotations")
        values = json.loads(path.read_text("utf-8"))
    except (OSError, ValueError) as error:
        raise DatasetError(f"{path}: cannot be read as annotations ({_reason(error)})") from error
    if not isinstance(values, dict):
        raise DatasetError(f'{path}: must be one JSON object, {{key: {{"path", "duration", "annotations"}}}}')
    entries = (_entry(path, key, value) for key, value in values.items())
    return {entry.key: entry for entry in entries if entry.captions}


def read_keys(folder: Path, split: str) -> list[str]:
    """The keys that `splits/SPLIT.txt` of a folder lists, one a line, each once.

    Raises
    ------
    MissingSplit
        If there is no such list; names those that are there.
    """
    keys = read_list(folder / "splits", split)
    if keys is None:
        there = ", ".join(sorted(file.stem for file in (folder / "splits").glob("*.txt"))) or "none"
        raise MissingSplit(f"{folder}: has no split {split!r} (splits/{split}.txt); there: {there}")
    return keys


def read_list(folder: Path, split: str) -> list[str] | None:
    """The keys that `SPLIT.txt` in a folder lists, each once; None where there is no such file.

    Raises
    ------
    DatasetError
        If it cannot be read.
    """
    path = folder / f"{split}.txt"
    if split != PurePosixPath(split).name:
        return None
    try:
        lines = path.read_text("utf-8").splitlines()
    except FileNotFoundError:
        return None
    except (OSError, ValueError) as error:
        raise DatasetError(f"{path}: cannot be read as a list of keys ({_reason(error)})") from error
    return list(dict.fromkeys(line.strip() for line in lines if line.strip()))


def _entry(file: Path, key: str, value: Any) -> CaptionedEntry:
    try:
        is_babel = "feat_p" in value
        duration = _seconds(value["dur" if is_babel else "duration"])
        path = value["feat_p" if is_babel else "path"]
        captions = tuple(_babel(value, duration) if is_babel else map(_caption, value["annotations"]))
    except (KeyError, TypeError, ValueError, AttributeError) as error:
        raise DatasetError(f"{file}: {key!r} is no annotated motion ({_reason(error)})") from error
    if is_babel:  # the first folder is named as its archive: KIT/KIT/348/walk_poses.npz
        path = PurePosixPath(path).with_suffix("").as_posix().partition("/")[2]
    if not path or PurePosixPath(path).is_absolute() or {"..", "."} & set(path.split("/")) or set(path) & set("\\:\0"):
        raise DatasetError(f"{file}: the path {path!r} of {key!r} leads out of the folder of motions")
    return CaptionedEntry(key, path, duration, captions)


def _caption(value: Mapping[str, Any]) -> TimedCaption:
    text = value["text"]
    if not isinstance(text, str) or not text.strip():
        raise ValueError(f"text={text!r} is no sentence")
    caption = TimedCaption(text, _seconds(value["start"]), _seconds(value["end"]))
    if caption.end < caption.start:
        raise ValueError(f"{text!r} ends at {caption.end:g} s, before it starts at {caption.start:g} s")
    return caption


def _babel(value: Mapping[str, Any], duration: float) -> Iterator[TimedCaption]:
    """The raw labels of a sequence of BABEL."""
    for label in (value.get("seq_ann") or {}).get("labels") or ():
        yield _caption({"text": label["raw_label"], "start": 0.0, "end": duration})
    for label in (value.get("frame_ann") or {}).get("labels") or ():
        yield _caption({"text": label["raw_label"], "start": label["start_t"], "end": label["end_t"]})


def _seconds(value: Any) -> float:
    if isinstance(value, bool) or not isinstance(value, (int, float)) or not math.isfinite(value) or value < 0:
        raise ValueError(f"{value!r} are no seconds")
    return float(value)


def _reason(error: Exception) -> str:
    if isinstance(error, KeyError):
        return f"{error} is missing"
    return getattr(error, "strerror", None) or str(error)
