"""One performance in several rigs, at other rates or mirrored is a stack; motions that are merely alike are none."""

from __future__ import annotations

import shutil
from pathlib import Path

import numpy as np
import pytest

from encoders.bundle.bundle import Bundle
from encoders.motion import Motion
from encoders.skeleton import PARENTS
from indexer.ingest.arrays import NewClip
from search.library import Library
from search.stacks import stacking
from search.stacks.shapes import mirrored, shape_of
from search.stacks.stacking import Copy, asks_side
from tests.search.conftest import Run, made_motion


def other_rig(motion: Motion, seed: int) -> Motion:
    """The same performance by a body of other proportions: each bone longer or shorter, the same directions."""
    lengths = np.random.default_rng(seed).uniform(0.9, 1.1, (22, 1))
    bones = motion.joints - motion.joints[:, PARENTS]
    joints = motion.joints.copy()
    for joint in range(1, 22):
        joints[:, joint] = joints[:, PARENTS[joint]] + bones[:, joint] * lengths[joint]
    return Motion(joints)


@pytest.fixture
def library(tmp_path: Path, tiny_bundle: Path) -> Library:
    library = Library.open(tmp_path / "takes", bundle=Bundle.load(tiny_bundle, threads=1), create=True)
    library.add_many(NewClip(f"take {seed}", made_motion(5, seed)) for seed in range(6))
    return library


def paths(library: Library, stacks: list[tuple[Copy, ...]]) -> list[list[str]]:
    return [[library.clip(c.clip_id).path + (" mirrored" if c.mirrored else "") for c in stack] for stack in stacks]


def test_other_motions_are_no_stack(library: Library) -> None:
    assert library.duplicates() == []


def test_copies_are_found_whatever_the_rig_rate_and_side(library: Library) -> None:
    motion = made_motion(5, 2)
    turn = np.array([[0, 0, 1], [0, 1, 0], [-1, 0, 0]], np.float32)
    copies = {
        "rig": other_rig(motion, 1),
        "rate": Motion(motion.resample(33).joints, 33),
        "shorter": motion.crop(0.0, 4.9),
        "turned": Motion(motion.joints @ turn + 3),
        "flipped": other_rig(motion.mirror(), 2),
    }
    library.add_many(NewClip(name, copy) for name, copy in copies.items())
    library.add("half", motion.crop(0, 2.5))
    (found,) = library.duplicates()
    assert paths(library, [found]) == [["take 2", "rig", "rate", "shorter", "turned", "flipped mirrored"]]


def test_stacks_follow_the_library_and_compute_only_what_changed(
    library: Library, monkeypatch: pytest.MonkeyPatch
) -> None:
    computed = []
    monkeypatch.setattr(stacking, "shape_of", lambda *given: computed.append(1) or shape_of(*given))
    assert library.duplicates() == []
    library.add("flipped", made_motion(5, 1).mirror())
    library.add("again", made_motion(5, 4))
    assert paths(library, library.duplicates()) == [["take 1", "flipped mirrored"], ["take 4", "again"]]
    assert len(computed) == 8
    library.add("take 4", made_motion(5, 9))
    library.remove("take 0")
    assert paths(library, library.duplicates()) == [["take 1", "flipped mirrored"]]
    library.add("take 4", made_motion(5, 4))
    library.add("flipped too", made_motion(5, 1).mirror())
    expected = [["take 1", "flipped mirrored", "flipped too mirrored"], ["take 4", "again"]]
    assert paths(library, library.duplicates()) == expected
    assert len(computed) == 11
    assert paths(library, library.duplicates(path="flipped*")) == [["flipped", "flipped too"]]
    shutil.rmtree(library.folder / "previews")
    assert paths(library, library.duplicates()) == expected


@pytest.mark.parametrize("damage", [b"", b"PK\x03\x04 nothing", b"x" * 5000])
def test_a_damaged_file_of_shapes_is_made_again(library: Library, damage: bytes) -> None:
    library.add("again", made_motion(5, 4))
    expected = library.duplicates()
    (library.folder / "previews" / "shapes.npz").write_bytes(damage)
    assert library.duplicates() == expected != []


def test_copies_of_copies_make_no_chains() -> None:
    from search.stacks.copies import leaders

    pairs = np.array([[0, 1], [1, 2], [3, 4], [2, 4]]), np.array([False, False, True, False])
    lead, flipped = leaders(5, pairs)
    assert lead.tolist() == [0, 0, 2, 3, 2]
    assert flipped.tolist() == [False] * 5


def test_a_mirrored_shape_is_that_of_the_mirrored_motion() -> None:
    motion = made_motion(4, 7)
    expected = shape_of(motion.mirror().joints, motion.duration).vector
    np.testing.assert_allclose(mirrored(shape_of(motion.joints, 4).vector[None])[0], expected, atol=1e-3)


@pytest.mark.parametrize(
    ("text", "expected"),
    [("waves with the LEFT hand", True), ("turns counter-clockwise", True), ("steps leftwards", True),
     ("a person who leaves", False), ("walks upright", False)],
)  # fmt: skip
def test_a_sentence_may_ask_for_a_side(text: str, expected: bool) -> None:
    assert asks_side(text) is expected


def test_stacks_on_the_command_line(indexed: Path, tmp_path: Path, run: Run) -> None:
    folder = Path(shutil.copytree(indexed, tmp_path / "takes"))
    at = ("--library", folder)
    assert "no two clips show one performance" in run("duplicates", *at).err
    np.save(folder / "copy.npy", made_motion(4.0, 1).mirror().joints)
    run("index", folder, "--jobs", "1")
    lines = [line.split("\t") for line in run("duplicates", *at).out.splitlines()]
    assert [(line[0], line[3], line[6]) for line in lines] == [("1", "take 1.npy", ""), ("1", "copy.npy", "mirrored")]
    (extra,) = run("duplicates", "--extra", "--json", *at).document["stacks"]
    assert [(clip["path"], clip["mirrored"]) for clip in extra["clips"]] == [("copy.npy", True)]
