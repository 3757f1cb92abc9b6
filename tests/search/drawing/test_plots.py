"""Pictures: drawn, and of what was asked."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from PIL import Image

from search.cli.terminal import strip
from search.drawing.plots import plot_moments, plot_poses
from search.hits import Hit, Step
from search.query.question import Question
from search.source import MotionSource
from tests.search.conftest import made_motion


def _colours(path: Path) -> int:
    with Image.open(path) as image:
        return len(np.unique(np.asarray(image.convert("RGB")).reshape(-1, 3), axis=0))


def test_a_strip_of_poses(tmp_path: Path) -> None:
    strips = [("one", made_motion(3, 0)), ("two $x_1$", made_motion(1, 2))]
    plot_poses(tmp_path / "x.png", [("“kicks”", strips), ("nothing", []), ("again", strips[:1])])
    assert _colours(tmp_path / "x.png") > 50


def test_similarity_over_time_with_steps(tmp_path: Path) -> None:
    source = MotionSource.of_motion(made_motion(8, 0), "take.bvh")
    steps = (Step("walks", 1, 3, 0.5), Step("sits", 4, 6, 0.4))
    hit = Hit(1, "take.bvh", 0.45, "", 1, 6, 8, steps=steps)
    times = np.linspace(0, 8, 80)
    curves = np.stack([np.sin(times), np.cos(times)]).astype(np.float32)
    plot_moments(tmp_path / "x.png", Question(("walks", "sits"), "then"), source, [hit], times, curves)
    assert _colours(tmp_path / "x.png") > 50


def test_a_curve_in_the_terminal_shows_its_peaks() -> None:
    assert strip([0, 0, 0, 1, 0, 0, 0, 0], 4) == "▁█▁▁"
    assert strip([0.3] * 5, 80) == "▁" * 5
    assert len(strip(list(np.linspace(0, 1, 1000)), 60)) == 60
