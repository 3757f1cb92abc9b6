"""`motionseek model`: what it shows, and when it writes no card."""

from __future__ import annotations

import shutil
from pathlib import Path

import numpy as np
import pytest

from encoders.bundle.bundle import Bundle
from encoders.bundle.known_models import load_model
from encoders.skeleton import BONE_LENGTHS, PARENTS, RAW_OFFSETS
from tests.encoders.bundle.conftest import change
from tests.search.conftest import Run


def test_info_shows_the_manifest(run: Run, tiny_bundle: Path) -> None:
    document = run("model", "info", "--json").document
    assert document["fingerprint"] == Bundle.load(tiny_bundle).fingerprint
    assert (document["name"], document["licence"], document["calibrated"]) == ("tiny", "MIT", False)


@pytest.mark.parametrize("alone", ["--real", "--captions"])
def test_real_takes_and_their_captions_are_given_together(run: Run, tmp_path: Path, alone: str) -> None:
    (tmp_path / "captions.jsonl").touch()
    ran = run("model", "card", tmp_path / "x.md", alone, tmp_path / ("" if alone == "--real" else "captions.jsonl"))
    assert (ran.code, ran.out) == (2, "")
    assert "given together" in ran.err
    assert not (tmp_path / "x.md").exists()


def test_no_card_is_overwritten(run: Run, tmp_path: Path) -> None:
    (tmp_path / "x.md").write_text("mine", encoding="utf-8")
    ran = run("model", "card", tmp_path / "x.md")
    assert (ran.code, ran.err.count("\n")) == (1, 1)
    assert "--force" in ran.err
    assert (tmp_path / "x.md").read_text(encoding="utf-8") == "mine"


@pytest.fixture
def other(tiny_bundle: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> str:
    """The name of a second model in the user's folder."""
    monkeypatch.setenv("MOTIONSEEK_MODELS", str(tmp_path / "models"))
    change(Path(shutil.copytree(tiny_bundle, tmp_path / "models" / "other")), max_frames=50)
    return "other"


def test_the_models_that_are_here_are_listed(run: Run, other: str, tmp_path: Path) -> None:
    document = run("model", "list", "--json").document
    assert document["folder"] == str(tmp_path / "models")
    assert [row["name"] for row in document["models"]] == ["default", other]
    assert run("model", "info", "--model", other, "--json").document["max_frames"] == 50


def test_a_library_keeps_to_its_model_until_it_is_moved_to_another(run: Run, other: str, tmp_path: Path) -> None:
    moves = tmp_path / "moves"
    moves.mkdir()
    np.save(moves / "standing.npy", joints_of(80))
    assert run("index", moves, "--model", other, "--jobs", 1).code == 0
    np.save(moves / "walking.npy", joints_of(60))
    assert run("index", moves, "--jobs", 1).code == 0
    found = run("search", "a person stands", "--library", moves, "--json")
    assert (found.code, len(found.document["hits"])) == (0, 2)
    assert run("status", moves, "--json").document["model"] == "tiny"

    refused = run("index", moves, "--model", "default", "--jobs", 1)
    assert (refused.code, "--rebuild" in refused.err) == (1, True)
    (moves / "standing.npy").unlink()  # it is moved from stored poses
    assert run("index", moves, "--rebuild", "--model", "default", "--jobs", 1).code == 0
    shutil.rmtree(tmp_path / "models")
    assert run("search", "a person stands", "--library", moves, "--json").code == 0


def test_a_library_whose_model_is_gone_says_which_and_what_to_do(run: Run, other: str, tmp_path: Path) -> None:
    moves = tmp_path / "moves"
    moves.mkdir()
    np.save(moves / "standing.npy", joints_of(80))
    run("index", moves, "--model", other, "--jobs", 1)
    shutil.rmtree(tmp_path / "models")
    for command in (("search", "stands", "--library", moves), ("index", moves)):
        refused = run(*command)
        assert (refused.code, refused.err.count("\n")) == (1, 1)
        assert "made with the model tiny" in refused.err
        assert "motionseek model list" in refused.err
    assert run("index", moves, "--rebuild", "--jobs", 1).code == 0
    assert run("search", "stands", "--library", moves).code == 0


@pytest.mark.parametrize(
    "command",
    [("describe", "FILE"), ("moments", "a person stands", "FILE"), ("segment", "FILE", "--labels", "stand,walk")],
)
def test_a_file_is_read_by_itself_with_another_model(
    run: Run, other: str, tmp_path: Path, command: tuple[str, ...]
) -> None:
    np.save(tmp_path / "standing.npy", joints_of(80))
    asked = [str(tmp_path / "standing.npy") if word == "FILE" else word for word in command]
    assert run(*asked, "--model", other, "--json").code == 0
    refused = run(*asked, "--model", "nobody")
    assert (refused.code, "no model 'nobody'" in refused.err) == (1, True)
    both = run(*asked, "--model", other, "--library", tmp_path)
    assert (both.code, "cannot be combined" in both.err) == (2, True)


def test_a_bundle_is_calibrated_where_it_lies_and_the_shipped_one_is_not(
    run: Run, other: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    arrays = {"motions": np.eye(24, dtype=np.float16), "words": np.array(["walk"])}
    monkeypatch.setattr("search.evaluate.judged_hits.calibrate_synthetically", lambda bundle, real: arrays)
    before = load_model(other).fingerprint
    for _ in range(2):  # anew, too
        assert run("model", "calibrate", other).code == 0
        calibrated = load_model(other)
        assert calibrated.fingerprint == before
        np.testing.assert_array_equal(calibrated.calibration["motions"], np.eye(24))
    for name in ("default", "nobody"):
        refused = run("model", "calibrate", name)
        assert (refused.code, refused.err.count("\n")) == (1, 1)


def joints_of(frames: int) -> np.ndarray:
    """A body that stands with straight arms, as an array of joints."""
    joints = np.zeros((22, 3))
    for joint, parent in enumerate(PARENTS):
        joints[joint] = 0 if parent < 0 else joints[parent] + RAW_OFFSETS[joint] * BONE_LENGTHS[joint]
    return np.tile(joints - [0, joints[:, 1].min(), 0], (frames, 1, 1))


@pytest.mark.torch
def test_a_published_run_is_imported_searched_with_and_not_overwritten(
    run: Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    pytest.importorskip("torch")
    from tests.encoders import published_layout

    monkeypatch.setenv("MOTIONSEEK_MODELS", str(tmp_path / "models"))
    published = published_layout.write_run(tmp_path / "TMR" / "models" / "tmr_small")
    published_layout.write_statistics(tmp_path / "TMR" / published_layout.STATISTICS)
    language = published_layout.write_language(tmp_path / "distilbert-base-uncased")
    command = ("model", "import", published, "--name", "tmr-small", "--language-model", language)
    done = run(*command)
    assert (done.code, done.out.splitlines()[0].startswith("tmr-small ")) == (0, True)
    again = run(*command)
    assert (again.code, again.err.count("\n"), "--force" in again.err) == (1, 1, True)
    assert run(*command, "--force", "--json").document["fingerprint"].startswith(done.out.split()[1])
    refused = run("model", "import", published, "--name", "../tmr")
    assert (refused.code, "name='../tmr'" in refused.err) == (2, True)

    moves = tmp_path / "moves"
    moves.mkdir()
    np.save(moves / "standing.npy", joints_of(80))
    assert run("index", moves, "--model", "tmr-small", "--jobs", 1).code == 0
    assert len(run("search", "a person stands", "--library", moves, "--json").document["hits"]) == 1
