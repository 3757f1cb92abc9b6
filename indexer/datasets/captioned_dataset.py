"""A data set as TMR publishes them: annotations, splits, a folder of motions, perhaps embeddings and statistics.

    annotations/humanml3d/annotations.json           see `timed_captions`
    annotations/humanml3d/splits/train.txt           keys, one a line; nsim_test.txt: the dissimilar subset
    annotations/humanml3d/token_embeddings/          see `text_embeddings`
    annotations/humanml3d/sent_embeddings/
    motions/guoh3dfeats/CMU/13/13_18_poses.npy       see `motion_folder`
    stats/humanml3d/guoh3dfeats/{mean,std}.pt        statistics of the features

A folder with `annotations.json` alone, its motions in `motions/` or named apart, is a data set, too; so are BABEL's
`train.json` and `val.json`, each of which is a split, and HumanML3D and KIT-ML in their own folders: see
`captioned_texts`.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from encoders.errors import DatasetError, MissingMotion, MissingSplit
from encoders.features.registry import FeatureKind
from indexer.datasets.captioned_texts import has_texts, motions_beside_texts, read_text_entries
from indexer.datasets.motion_folder import MotionFolder
from indexer.datasets.timed_captions import CaptionedEntry, read_annotations, read_keys

ANNOTATIONS = "annotations.json"
_BABEL_SPLITS = ("train", "val")
#: Captions to train and validate on are about spans of so many seconds, as published.
SHORTEST, LONGEST = 2.0, 10.0
#: Names of folders of motions for each feature kind, in TMR's repository and here.
_MOTION_FOLDERS = {"humanml3d": ("guoh3dfeats", "humanml3d")}


@dataclass(frozen=True)
class CaptionedDataset:
    """A data set that has been found; `open` finds one.

    Attributes
    ----------
    folder : Path
        Where the annotations lie.
    motions : MotionFolder
    stats : Path or None
        A folder with statistics of the features, if there is one where they are published.
    """

    folder: Path
    motions: MotionFolder
    stats: Path | None

    @classmethod
    def open(
        cls, place: Path, kind: FeatureKind, *, motions: Path | None = None, fps: float | None = None
    ) -> CaptionedDataset:
        """Find the parts of the data set at a place: the folder of annotations, or the one above all its parts.

        Parameters
        ----------
        kind : FeatureKind
            What the model reads.
        motions : Path, optional
            The folder of motions.
        fps : float, optional
            The frame rate of motions whose files do not say it.

        Raises
        ------
        DatasetError
            If there is none, or several.
        MissingMotion
            If the folder of motions is not there, or there are several.
        """
        folder = _annotations_folder(place)
        roots = (folder, folder.parent.parent)
        found = motions or _motion_folder(folder, roots, kind)
        stats = (root / "stats" / folder.name / found.name for root in (*roots, folder.parent.parent.parent))
        return cls(folder, MotionFolder(found, kind, fps), next((path for path in stats if path.is_dir()), None))

    @property
    def name(self) -> str:
        """What people call it: the name of its folder."""
        return self.folder.resolve().name

    def split(self, name: str, *, all_durations: bool | None = None) -> list[CaptionedEntry]:
        """The entries of a split in the order of its list; keys without annotations are left out, as published.

        Parameters
        ----------
        all_durations : bool, optional
            Whether captions of all durations count, or only those about 2 to 10 s. As published, all count in splits
            that have "test" in their name.

        Raises
        ------
        MissingSplit
            If there is no such split, or nothing is left of it.
        DatasetError
            See `read_annotations`.
        """
        keep = "test" in name if all_durations is None else all_durations
        entries = [entry if keep else _timed(entry) for entry in self._entries(name)]
        entries = [entry for entry in entries if entry.captions]
        if not entries:
            raise MissingSplit(f"{self.folder}: no motion of the split {name!r} has a caption that counts")
        return entries

    def has_split(self, name: str) -> bool:
        """Whether there is a list of that split."""
        return (self.folder / "splits" / f"{name}.txt").is_file()

    def _entries(self, split: str) -> Iterator[CaptionedEntry]:
        if has_texts(self.folder):
            yield from read_text_entries(self.folder, split, self.motions.seconds)
            return
        if not (self.folder / ANNOTATIONS).is_file():
            if split not in _BABEL_SPLITS or not (self.folder / f"{split}.json").is_file():
                raise MissingSplit(f"{self.folder}: has no split {split!r} ({split}.json)")
            yield from read_annotations(self.folder / f"{split}.json").values()
            return
        keys = read_keys(self.folder, split)
        annotated = read_annotations(self.folder / ANNOTATIONS)
        yield from (annotated[key] for key in keys if key in annotated)


def is_dataset(place: Path) -> bool:
    """Whether a data set lies at a place."""
    try:
        _annotations_folder(place)
    except DatasetError:
        return False
    return True


def _timed(entry: CaptionedEntry) -> CaptionedEntry:
    """The entry with its captions about 2 to 10 s."""
    return replace(entry, captions=tuple(c for c in entry.captions if SHORTEST <= c.duration <= LONGEST))


def _annotations_folder(place: Path) -> Path:
    inside = sorted((place / "annotations").glob("*/")) if (place / "annotations").is_dir() else []
    found = [folder for folder in (place, *inside) if _has_annotations(folder)]
    if not found:
        raise DatasetError(
            f"{place}: holds no data set ({ANNOTATIONS}, annotations/NAME/{ANNOTATIONS}, BABEL's train.json and "
            "val.json, or HumanML3D's texts/ and new_joint_vecs/); see docs/published_models.md"
        )
    if len(found) > 1:
        raise DatasetError(f"{place}: holds several data sets; name one: {', '.join(map(str, found))}")
    return found[0]


def _has_annotations(folder: Path) -> bool:
    if has_texts(folder):
        return True
    return (folder / ANNOTATIONS).is_file() or any((folder / f"{split}.json").is_file() for split in _BABEL_SPLITS)


def _motion_folder(folder: Path, roots: Sequence[Path], kind: FeatureKind) -> Path:
    """The folder of motions of annotations in `folder`."""
    if has_texts(folder):
        return motions_beside_texts(folder, kind)
    if (folder / "motions").is_dir():
        return folder / "motions"
    inside = [path for root in roots[1:] for path in sorted((root / "motions").glob("*/"))]
    known = [path for path in inside if path.name in _MOTION_FOLDERS.get(kind.name, (kind.name,))]
    found = known or inside
    if len(found) != 1:
        what = f"several folders of motions ({', '.join(p.name for p in found)})" if found else "no folder of motions"
        raise MissingMotion(f"{folder}: {what} beside it, in {roots[-1] / 'motions'}; name one with --motions")
    return found[0]
