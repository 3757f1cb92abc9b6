"""HumanML3D and KIT-ML as published: one clip a motion, captions with spans, statistics passed over, splits."""

from __future__ import annotations

import shutil
from pathlib import Path

import numpy as np
import pytest

from encoders.features.humanml3d import joints_to_features
from indexer.ingest.indexing import index
from indexer.ingest.storing import Summary
from indexer.store.library_reader import FOLDER
from indexer.store.stored_library import Caption, StoredLibrary
from search.query.filters import Filters
from tests.indexer.bodies import KIT, body, in_order
from tests.indexer.folders import SmallBundle, moving

TEXTS = {
    "000001": "a person walks.#a/DET person/NOUN walk/VERB#0.0#0.0\na person stops.#a/DET#0.5#1.5\n",
    "000002": "someone waves.#someone/NOUN#nan#nan\n",
    "M000001": "a person walks back.#a/DET#0.0#0.0\n",
    "000009": "a motion that is not here.#a/DET#0.0#0.0\n",
}
ALL = [f"new_joints/{id}.npy" for id in ("000001", "000002", "M000001")]


@pytest.fixture
def humanml3d(tmp_path: Path) -> Path:
    place = tmp_path / "HumanML3D"
    for folder in ("new_joints", "new_joint_vecs", "texts"):
        (place / folder).mkdir(parents=True)
    for seed, id in enumerate(("000001", "000002", "M000001")):
        joints = moving(seed)
        np.save(place / "new_joints" / f"{id}.npy", joints[:-1].astype(np.float32))
        np.save(place / "new_joint_vecs" / f"{id}.npy", joints_to_features(joints))
    for id, text in TEXTS.items():
        (place / "texts" / f"{id}.txt").write_text(text)
    for name in ("Mean", "Std"):
        np.save(place / f"{name}.npy", np.ones(263, np.float32))
    (place / "train.txt").write_text("000001\nM000001\n000009\n")
    (place / "test.txt").write_text("000002")
    (place / "all.txt").write_text("000001\n000002\nM000001\n")
    (place / "README.txt").write_text("HumanML3D\n\nread me first: 000001\n")
    return place


def run(root: Path) -> Summary:
    return index(root, bundle=SmallBundle(), jobs=1)


def clips(root: Path, **filters: object) -> list[str]:
    with StoredLibrary.open(root) as library:
        ids = Filters.of(filters).ids(library)
        found = library.clips_by_id(library.ids() if ids is None else ids)
        return sorted(clip.path for clip in found.values())


def captions(root: Path, name: str) -> list[Caption]:
    with StoredLibrary.open(root, bundle=SmallBundle()) as library:
        return library.captions(library.find(name).id)


def test_each_motion_is_one_clip_with_its_captions(humanml3d: Path) -> None:
    summary = run(humanml3d)
    assert (summary.indexed, summary.failed, summary.warnings) == (3, [], [])
    assert clips(humanml3d) == ALL
    assert captions(humanml3d, "000001") == [Caption("a person walks."), Caption("a person stops.", 0.5, 1.5)]
    assert captions(humanml3d, "000002") == [Caption("someone waves.")]
    assert captions(humanml3d, "M000001") == [Caption("a person walks back.")]


def test_splits_are_filters(humanml3d: Path) -> None:
    run(humanml3d)
    assert clips(humanml3d, split="test") == ALL[1:2]
    assert clips(humanml3d, split="train") == [ALL[0], ALL[2]]
    assert clips(humanml3d, split="all", path="*M0*") == ALL[2:]
    with StoredLibrary.open(humanml3d) as library:
        said = Filters(split="val").why_none(library)
        assert said == "no clip passes split='val'; there are all, test, train"
    (humanml3d / "test.txt").write_text("000001\n")
    (humanml3d / "all.txt").unlink()
    assert run(humanml3d).unchanged == 3
    assert (clips(humanml3d, split="test"), clips(humanml3d, split="all")) == (ALL[:1], [])


def test_the_next_run_finds_all_unchanged(humanml3d: Path) -> None:
    run(humanml3d)
    summary = run(humanml3d)
    assert (summary.indexed, summary.unchanged, summary.gone, summary.warnings) == (0, 3, 0, [])


def test_where_there_are_features_alone_they_are_the_clips_until_the_joints_are_there(humanml3d: Path) -> None:
    shutil.move(humanml3d / "new_joints", humanml3d.parent / "kept")
    assert run(humanml3d).failed == []
    assert clips(humanml3d, split="test") == ["new_joint_vecs/000002.npy"]
    assert len(captions(humanml3d, "000001")) == 2
    shutil.move(humanml3d.parent / "kept", humanml3d / "new_joints")
    summary = run(humanml3d)
    assert (summary.indexed, summary.gone, summary.failed, summary.warnings) == (3, 3, [], [])
    assert clips(humanml3d, split="test") == ["new_joints/000002.npy"]
    assert len(captions(humanml3d, "000001")) == 2


def test_a_folder_above_does_as_well(humanml3d: Path) -> None:
    root = humanml3d.parent
    assert run(root).failed == []
    assert clips(root, split="test") == ["HumanML3D/new_joints/000002.npy"]
    assert len(captions(root, "000001")) == 2


def test_the_folder_of_motions_alone_is_indexed_with_a_word_about_the_captions(humanml3d: Path) -> None:
    summary = run(humanml3d / "new_joints")
    assert summary.indexed == 3
    assert summary.warnings == [
        f"{humanml3d / 'new_joints'}: the captions of its motions lie beside it; index {humanml3d} to have them"
    ]


def test_kit_ml_is_read_at_its_own_rate(tmp_path: Path) -> None:
    place = tmp_path / "KIT-ML"
    for folder in ("new_joints", "texts", "checkpoint/meta"):
        (place / folder).mkdir(parents=True)
    np.save(place / "new_joints" / "00002.npy", in_order(body(), KIT) * 1000)
    np.save(place / "checkpoint" / "meta" / "mean.npy", np.ones(251))
    (place / "texts" / "00002.txt").write_text("a human walks.#a/DET#0.0#0.0\n")
    summary = run(place)
    assert (summary.indexed, summary.failed) == (1, [])
    with StoredLibrary.open(place, bundle=SmallBundle()) as library:
        clip = library.find("00002")
        assert clip.duration == pytest.approx(40 / 12.5, abs=0.1)
        assert library.captions(clip.id) == [Caption("a human walks.")]


def test_elsewhere_a_motion_may_be_called_mean(tmp_path: Path) -> None:
    np.save(tmp_path / "mean.npy", moving(0))
    assert run(tmp_path).indexed == 1
    assert (tmp_path / FOLDER).is_dir()
