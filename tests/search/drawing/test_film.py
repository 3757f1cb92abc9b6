"""A motion as a picture: what is drawn, how often, and that nothing is lost."""

from __future__ import annotations

import builtins
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image

from encoders.errors import MissingProgram, QueryError
from encoders.motion import Motion
from search.drawing import film
from search.drawing.film import write_picture
from search.drawing.raster import FLOOR, Stage
from tests.search.conftest import Run, made_motion

_ORANGE = np.array([221, 90, 34])


def _where(picture: np.ndarray) -> np.ndarray:
    """Which pixels show something else than the floor."""
    return np.abs(picture.astype(int) - FLOOR).max(axis=-1) > 30


def test_the_figure_stands_in_the_middle_with_its_left_in_orange() -> None:
    picture = Stage(made_motion(2, 0), 200, 200).draw(0)
    rows, columns = np.nonzero(_where(picture))
    assert abs(columns.mean() - 100) < 12
    assert rows.max() - rows.min() > 120
    orange = np.abs(picture / np.maximum(picture.max(axis=-1, keepdims=True), 1) - _ORANGE / 221).max(axis=-1) < 0.1
    assert 200 < orange.sum() < 4000
    assert np.nonzero(orange)[1].mean() > 100  # a viewer in front has the figure's left on the right


def test_what_is_nearer_hides_what_is_behind() -> None:
    motion = made_motion(1, 0)
    turned = Motion(motion.joints * np.array([-1, 1, -1], np.float32))  # the camera turns with it
    assert np.abs(Stage(motion, 120, 120).draw(5).astype(int) - Stage(turned, 120, 120).draw(5)).mean() < 1


def test_the_camera_follows_a_figure_that_walks_away() -> None:
    joints = made_motion(4, 1).joints.copy()
    joints[..., 0] += np.linspace(0, 30, len(joints))[:, None]
    stage = Stage(Motion(joints), 120, 120)
    assert all(abs(np.nonzero(_where(stage.draw(f)))[1].mean() - 60) < 15 for f in (0, 40, 79))


def test_a_strip_has_a_pose_a_quarter_second_and_nine_at_most(tmp_path: Path) -> None:
    assert write_picture(made_motion(8, 0), tmp_path / "a.png", size=120) == 9
    assert write_picture(made_motion(0.8, 0), tmp_path / "b.png", size=120) == 3
    assert write_picture(made_motion(0.05, 0), tmp_path / "c.png", size=120) == 1
    with Image.open(tmp_path / "a.png") as long, Image.open(tmp_path / "b.png") as short:
        assert long.width == 3 * short.width
        assert long.height < 140


def test_a_gif_moves_at_the_rate_asked_for(tmp_path: Path) -> None:
    assert write_picture(made_motion(2, 0), tmp_path / "a.gif", size=80, fps=10) == 20
    with Image.open(tmp_path / "a.gif") as image:
        assert (image.n_frames, image.size, image.info["duration"], image.info["loop"]) == (20, (80, 80), 100, 0)
        first = np.asarray(image.convert("RGB")).astype(int)
        image.seek(9)
        assert np.abs(np.asarray(image.convert("RGB")) - first).max() > 60


def test_a_gif_too_long_to_be_held_says_what_to_do(tmp_path: Path) -> None:
    with pytest.raises(QueryError, match="a start and an end"):
        write_picture(made_motion(61, 0), tmp_path / "a.gif")
    assert list(tmp_path.iterdir()) == []


def test_an_mp4_is_one_that_players_know(tmp_path: Path) -> None:
    pytest.importorskip("imageio_ffmpeg")
    assert write_picture(made_motion(1, 0), tmp_path / "a.mp4", size=81, fps=10) == 10
    data = (tmp_path / "a.mp4").read_bytes()
    assert data[4:8] == b"ftyp"
    assert b"avc1" in data
    assert data.index(b"moov") < data.index(b"mdat")  # plays before it is loaded


def test_without_ffmpeg_it_says_what_to_install(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    real = builtins.__import__

    def without(name: str, *rest: Any) -> Any:
        if name == "imageio_ffmpeg":
            raise ImportError(name)
        return real(name, *rest)

    monkeypatch.setattr(film, "which", lambda _: None)
    monkeypatch.setattr(builtins, "__import__", without)
    with pytest.raises(MissingProgram, match="pip install imageio-ffmpeg"):
        write_picture(made_motion(1, 0), tmp_path / "a.mp4")
    assert list(tmp_path.iterdir()) == []


def test_an_ffmpeg_that_fails_is_quoted(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    broken = tmp_path / "ffmpeg"
    broken.write_text("#!/bin/sh\necho no such encoder >&2\nexit 1\n")
    broken.chmod(0o755)
    monkeypatch.setattr(film, "which", lambda _: str(broken))
    with pytest.raises(QueryError, match="no such encoder"):
        write_picture(made_motion(1, 0), tmp_path / "a.mp4", size=80)
    assert not (tmp_path / "a.mp4").exists()


def test_the_command_draws_a_cut_and_never_overwrites(indexed: Path, run: Run, tmp_path: Path) -> None:
    out = tmp_path / "x.gif"
    arguments = ("render", "take 2", out, "--library", indexed, "--size", 64, "--json")
    assert run(*arguments, "--start", 1, "--end", 2.5).document["frames"] == 30
    before = out.read_bytes()
    ran = run(*arguments)
    assert (ran.code, out.read_bytes()) == (1, before)
    assert "--force" in ran.err
    assert run(*arguments, "--force", "--end", 1).document["frames"] == 20


def test_the_command_draws_a_file_that_no_library_holds(
    takes: Path, run: Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    assert "8 poses" in run("render", takes / "take 0.npy", "x.png", "--size", 100).out


def test_an_unknown_ending_is_named_with_the_three_that_are_known(indexed: Path, run: Run) -> None:
    ran = run("render", "take 2", "x.webm", "--library", indexed)
    assert ran.code == 2
    assert ".png, .gif, .mp4" in ran.err
