"""The motions of a data set as features: arrays of features as they are, all else through a feature kind."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from contextlib import suppress
from functools import cached_property, lru_cache
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from encoders.errors import DatasetError, MissingMotion, NotFinite, UnreadableMotion, WrongFeatureSize, WrongFrameRate
from encoders.features.registry import FeatureKind
from encoders.motion import Motion
from indexer.datasets.timed_captions import CaptionedEntry, TimedCaption
from indexer.formats.table import READABLE
from indexer.ingest.load import load_motion, read_motion

Array = NDArray[np.float32]

_MIRRORED = "M/"
#: Whole motions kept after their features were computed: captions of one motion mostly follow one another.
_CACHED = 4
#: Motions whose frames are counted to learn the frame rate, and how far it may be off: clips of 2 s have few frames.
_COUNTED, _TOLERANCE = 16, 0.08


class MotionFolder:
    """A folder in which `path` of a data set's entry is a file: `path.npy`, or of any format that can be read.

    Parameters
    ----------
    folder : Path
    kind : FeatureKind
        Arrays (T, kind.size) are its features. All else is read as a motion, of which features are computed.
    fps : float, optional
        The frame rate of motions whose files do not say it.

    As in published TMR, features are those of the whole motion, of which clips are slices. A motion under "M/" that is
    not there is the mirrored one without it, except as features. Arrays of joints do not say which axis is up: most of
    them decide for all, since one who crawls looks like one who stands on an axis that is not up.
    """

    def __init__(self, folder: Path, kind: FeatureKind, fps: float | None = None) -> None:
        if not folder.is_dir():
            raise MissingMotion(f"{folder}: no such folder of motions; name it with --motions")
        self.folder, self.kind, self.fps = folder, kind, fps
        self._computed = lru_cache(_CACHED)(self._compute)

    def clip(self, entry: CaptionedEntry, caption: TimedCaption) -> Array:
        """Features (T', F) of the span of a caption, at least one frame: rows int(start fps) to int(end fps).

        Raises
        ------
        MissingMotion, WrongFeatureSize, NotFinite
            If the motion is not there, has other features, or values that are no numbers.
        DatasetError
            If the file cannot be read or ends before the caption starts.
        """
        features, path = self._features(entry.path)
        first, last = int(caption.start * self.kind.fps), int(caption.end * self.kind.fps)
        rows = np.array(features[first : max(last, first + 1)], np.float32)
        if not len(rows):
            seconds = len(features) / self.kind.fps
            raise DatasetError(f"{path}: ends after {seconds:.2f} s, but {entry.key} starts at {caption.start:.2f} s")
        if not np.isfinite(rows).all():
            frame = first + int(np.argwhere(~np.isfinite(rows))[0, 0])
            raise NotFinite(f"{path}: frame {frame} holds values that are no numbers")
        return rows

    def motion(self, entry: CaptionedEntry) -> Motion:
        """The whole motion of an entry; of features the joints that they give.

        Raises
        ------
        MissingMotion, WrongFeatureSize, NotFinite, DatasetError
            See `clip`.
        """
        path, mirrored = self._find(entry.path)
        return self._load(path, mirrored)

    def seconds(self, path: str) -> float:
        """The duration of a whole motion.

        Raises
        ------
        MissingMotion, WrongFeatureSize, NotFinite, DatasetError
            See `clip`.
        """
        file, mirrored = self._find(path)
        if file.suffix == ".npy":
            array = _mapped(file)
            if array.ndim == 2 and array.shape[1] == self.kind.size:
                return len(array) / self.kind.fps
        return self._load(file, mirrored).duration

    def check_rate(self, entries: Sequence[CaptionedEntry]) -> None:
        """Compare the frames of some motions with their durations.

        Raises
        ------
        WrongFrameRate
            If they agree on another frame rate than the features have.
        """
        timed = [entry for entry in entries if entry.duration > 0][:: max(1, len(entries) // _COUNTED)]
        if not timed:
            return
        rates = np.sort([len(self._features(entry.path)[0]) / entry.duration for entry in timed])
        low, rate, high = (float(rate) for rate in np.quantile(rates, (0.25, 0.5, 0.75)))
        agree = high - low <= _TOLERANCE * rate
        if agree and abs(rate - self.kind.fps) > _TOLERANCE * self.kind.fps:
            raise WrongFrameRate(
                f"{self.folder}: motions have {rate:.1f} frames for each second that the annotations state, "
                f"{self.kind.name!r} features have {self.kind.fps:g}; resample them"
                + ("" if self.fps is None else f", or give another frame rate than {self.fps:g}")
            )

    def _features(self, path: str) -> tuple[Array, Path]:
        """The features of a whole motion, perhaps as a view of the file, and the file."""
        file, mirrored = self._find(path)
        if file.suffix == ".npy":
            array = _mapped(file)
            if array.ndim == 2 and array.shape[1] == self.kind.size:
                if mirrored:
                    raise MissingMotion(f"{self.folder / path}.npy: is not there; features cannot be mirrored")
                return array, file
        return self._computed(file, mirrored), file

    def _compute(self, file: Path, mirrored: bool) -> Array:
        return self.kind.compute(self._load(file, mirrored))

    def _load(self, file: Path, mirrored: bool) -> Motion:
        try:
            motion = load_motion(file, fps=self.fps, up=self._up if file.suffix == ".npy" else None)
        except UnreadableMotion as error:
            if file.suffix == ".npy":
                _refuse(file, self.kind, error)
            raise DatasetError(str(error)) from error
        return motion.mirror() if mirrored else motion

    @cached_property
    def _up(self) -> str | None:
        """The axis that is up in most of some arrays of joints; None where none can be read."""
        files = sorted(self.folder.rglob("*.npy"))
        found: Counter[str] = Counter()
        for file in files[:: max(1, len(files) // _COUNTED)]:
            with suppress(UnreadableMotion):
                found[read_motion(str(file), self.fps).reading.up] += 1
        return found.most_common(1)[0][0] if found else None

    def _find(self, path: str) -> tuple[Path, bool]:
        """The file of a path, and whether it is to be mirrored."""
        for name, mirrored in ((path, False), (path.removeprefix(_MIRRORED), True)):
            for ending in (".npy", *READABLE):
                file = self.folder / f"{name}{ending}"
                if file.is_file():
                    return file, mirrored
            if not path.startswith(_MIRRORED):
                break
        raise MissingMotion(f"{self.folder / path}: is not there, neither as .npy nor as any file that can be read")


def _mapped(file: Path) -> Array:
    try:
        array: Array = np.load(file, mmap_mode="r", allow_pickle=False)
    except (OSError, ValueError, EOFError) as error:
        raise DatasetError(f"{file}: no array that can be read ({error})") from error
    if array.dtype.kind not in "fiu":
        raise DatasetError(f"{file}: an array of {array.dtype} is no motion")
    return array


def _refuse(file: Path, kind: FeatureKind, error: UnreadableMotion) -> None:
    """Raise what is wrong with an array that is no motion."""
    array = _mapped(file)
    if not np.isfinite(array).all():
        raise NotFinite(str(error)) from error
    if array.ndim == 2:
        raise WrongFeatureSize(
            f"{file}: has {array.shape[1]} numbers a frame; {kind.name!r} features have {kind.size}"
        ) from error
