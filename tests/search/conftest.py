"""A small indexed folder, with spaces and umlauts in its names, and the command line to ask it."""

from __future__ import annotations

import json
import shutil
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from encoders.motion import Motion
from encoders.skeleton import BONE_LENGTHS, INDEX, PARENTS, RAW_OFFSETS
from search.cli import main
from search.export import bvh_writer


def made_motion(seconds: float, seed: int) -> Motion:
    """A figure that stands, swings its arms and bends its knees, each seed in its own way."""
    rng = np.random.default_rng(seed)
    pose = np.zeros((22, 3))
    for joint in range(1, 22):
        pose[joint] = pose[PARENTS[joint]] + RAW_OFFSETS[joint] * BONE_LENGTHS[joint]
    pose[:, 1] -= pose[:, 1].min()
    t = np.arange(round(seconds * 20)) / 20
    joints = np.repeat(pose[None], len(t), axis=0)
    swing = 0.15 * np.sin(t * rng.uniform(2, 9) + seed)
    for side, sign in (("left", 1), ("right", -1)):
        joints[:, INDEX[f"{side}_elbow"], 2] += sign * swing
        joints[:, INDEX[f"{side}_wrist"], 2] += 2 * sign * swing
        joints[:, INDEX[f"{side}_knee"], 2] += 0.5 * np.abs(swing)
    joints[:, :, 2] += (t * rng.uniform(0, 1.5))[:, None]
    return Motion(joints.astype(np.float32))


@pytest.fixture(scope="session")
def takes(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Motion files as a user has them: two formats, captions, a folder in the folder, one broken file."""
    folder = tmp_path_factory.mktemp("home") / "Größe & Takes"
    (folder / "deep er").mkdir(parents=True)
    for i, seconds in enumerate((2.0, 4.0, 8.0, 20.0)):
        np.save(folder / f"take {i}.npy", made_motion(seconds, i).joints)
    with (folder / "deep er" / "bücken.bvh").open("wb") as file:
        bvh_writer.write(file, made_motion(6.0, 9))
    (folder / "take 1.txt").write_text("a person walks\na man strolls\n", encoding="utf-8")
    (folder / "captions.tsv").write_text(
        "path\ttext\tstart\tend\ntake 3.npy\tbückt sich\t2\t5\ntake 3.npy\twaves\t6\t9\n", encoding="utf-8"
    )
    (folder / "broken.bvh").write_text("HIERARCHY\nROOT", encoding="utf-8")
    return folder


@dataclass
class Ran:
    """What a command did."""

    code: int
    out: str
    err: str

    @property
    def document(self) -> Any:
        return json.loads(self.out)


Run = Callable[..., Ran]


@pytest.fixture
def run(monkeypatch: pytest.MonkeyPatch, tiny_bundle: Path, capsys: pytest.CaptureFixture[str]) -> Run:
    """Run a command in this process, with the tiny model."""
    monkeypatch.setattr("encoders.bundle.bundle.DEFAULT", tiny_bundle)
    monkeypatch.delenv("MOTIONSEEK_LIBRARY", raising=False)

    def command(*arguments: object) -> Ran:
        capsys.readouterr()
        with pytest.raises(SystemExit) as ended:
            main.main([str(argument) for argument in arguments])
        said = capsys.readouterr()
        code = ended.value.code
        return Ran(code if isinstance(code, int) else 0, said.out, said.err)

    return command


@pytest.fixture(scope="session")
def indexed(takes: Path, tiny_bundle: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The takes, indexed with the tiny model. Not to be changed."""
    from encoders.bundle.bundle import Bundle
    from indexer.ingest import indexing

    folder = tmp_path_factory.mktemp("indexed") / takes.name
    shutil.copytree(takes, folder)
    indexing.index(folder, bundle=Bundle.load(tiny_bundle), jobs=1)
    return folder
