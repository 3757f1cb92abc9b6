"""Compositions of a small library: what every one of them holds to, in Python and at the command line."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import motionseek
from motionseek import Interval, Timeline
from search.compose.timeline import Pin
from tests.search.conftest import Run, made_motion

LINE = Timeline.of(
    [Interval("walks", 0, 3), Interval("sits down", 3, 5.5), Interval("waves with the right hand", 1, 2.5)]
)


@pytest.fixture(scope="module")
def library(tmp_path_factory: pytest.TempPathFactory, tiny_bundle: Path) -> motionseek.Library:
    """Not to be changed."""
    bundle = motionseek.Bundle.load(tiny_bundle, threads=1)
    library = motionseek.open(tmp_path_factory.mktemp("arrays"), bundle=bundle, create=True)
    library.add_many([motionseek.NewClip(f"clip {i}", made_motion(2 + i, i)) for i in range(6)])
    return library


def test_a_composition_has_the_time_lines_seconds_and_says_what_shows_each(library: motionseek.Library) -> None:
    (made,) = library.compose(LINE)
    assert made.motion.duration == 5.5
    assert [one.interval.text for one in made.chosen] == [one.text for one in LINE.intervals]
    assert made.joins[-1] == 3.0 or 3.0 in made.joins
    for one in made.chosen:
        assert 0 <= one.tmr_score <= 1
        assert 0 <= one.candidate.start < one.candidate.end <= one.candidate.source.duration
        assert 0.79 < one.candidate.rate < 1.26


def test_samples_differ_and_a_seed_repeats_them(library: motionseek.Library) -> None:
    first, second, third = library.compose(LINE, samples=3, seed=4)
    again = library.compose(LINE, samples=3, seed=4)
    assert [one.motion for one in again] == [first.motion, second.motion, third.motion]
    assert first.motion == library.compose(LINE)[0].motion
    assert len({one.motion for one in (first, second, third)}) == 3


def test_a_motion_before_stays_as_it_is(library: motionseek.Library) -> None:
    before = made_motion(2, 7)
    (made,) = library.compose(Timeline.of_steps([("walks", 3)]), after=before)
    assert made.motion.duration == 5
    untouched = made.motion.joints[:25]
    assert np.abs(untouched - before.joints[:25]).max() < 0.03  # resting feet are held still
    assert 2.0 in made.joins


def test_filters_choose_what_it_is_made_of(library: motionseek.Library) -> None:
    (made,) = library.compose(LINE, path="clip 5")
    assert {one.candidate.source.path for one in made.chosen} == {"clip 5"}
    with pytest.raises(motionseek.QueryError, match=r"'walks' \(0 to 3 s\): there is no clip that could show it"):
        library.compose(LINE, min_duration=100)


def test_clips_of_one_frame_show_nothing(tiny_bundle: Path, tmp_path: Path) -> None:
    bundle = motionseek.Bundle.load(tiny_bundle, threads=1)
    with motionseek.open(tmp_path, bundle=bundle, create=True) as library:
        still = motionseek.Motion(made_motion(1, 1).joints[:1])
        library.add("pose", still)
        with pytest.raises(motionseek.QueryError, match="there is no clip that could show it"):
            library.compose(Timeline.of_steps([("walks", 3)]))
        library.add("take", made_motion(3, 1))
        (made,) = library.compose(Timeline.of_steps([("walks", 3)]), after=still)
        assert {one.candidate.source.path for one in made.chosen} == {"take"}
        assert len(made.motion) == 61


def test_a_pinned_clip_shows_its_sentence(library: motionseek.Library) -> None:
    (made,) = library.compose(LINE)
    other = made.offered[0][-1]
    at = other.source.start + (other.start + other.end) / 2
    first, *rest = LINE.intervals
    (again,) = library.compose(Timeline.of([replace(first, pin=Pin(other.source.clip_id, at)), *rest]))
    shown = again.chosen[0].candidate
    assert (shown.source.path, shown.start, shown.end) == (other.source.path, other.start, other.end)
    with pytest.raises(motionseek.QueryError, match="the library has no clip #999"):
        library.compose(Timeline.of([Interval("walks", 0, 2, pin=Pin(999, 0.0))]))


@pytest.mark.parametrize("given", [{"samples": 0}, {"seed": -1}, {"seed": 0.5}, {"transition": 0}, {"transition": 99}])
def test_values_out_of_range_are_refused(library: motionseek.Library, given: dict) -> None:
    with pytest.raises(motionseek.ArgumentError, match=next(iter(given))):
        library.compose(LINE, **given)


def test_the_command_writes_motion_and_report(run: Run, indexed: Path, tmp_path: Path) -> None:
    out = tmp_path / "scène.bvh"
    steps = ("--then", "walks", 2, "--then", "sits", 2, "--while", "waves with the left hand", 1, 3)
    ran = run("compose", *steps, "-o", out, "--samples", 2, "--json", "--library", indexed)
    assert ran.code == 0, ran.err
    files = sorted(path.name for path in tmp_path.iterdir())
    assert files == ["scène-2.bvh", "scène-2.json", "scène.bvh", "scène.json"]
    intervals = ran.document["compositions"][0]["intervals"]
    assert [one["parts"] for one in intervals][1] == ["left arm"]
    assert {"path", "root", "clip", "source_start", "source_end", "tmr_score"} <= set(intervals[0])
    assert {1.0, 2.0, 3.0} <= {one["at"] for one in ran.document["compositions"][0]["transitions"]}
    assert 0 <= ran.document["compositions"][0]["sliding"] <= 100
    assert abs(motionseek.load(out).duration - 4) < 0.1
    assert run("compose", *steps, "-o", out, "--library", indexed).code == 1  # it is there already


def test_the_command_reads_time_lines_and_asks_which(run: Run, indexed: Path, tmp_path: Path) -> None:
    lines = tmp_path / "lines.txt"
    lines.write_text("## a\nwalks # 0 # 2\n\n## b\nsits # 0 # 1\n", encoding="utf-8")
    ran = run("compose", lines, "-o", tmp_path / "x.npz", "--library", indexed)
    assert ran.code == 2
    assert "2 time lines; name one with --name, such as --name a or b" in ran.err
    assert run("compose", lines, "--name", "b", "-o", tmp_path / "x.npz", "--library", indexed).code == 0
    assert motionseek.load(tmp_path / "x.npz").duration == 1
    assert run("compose", lines, "-o", tmp_path / "x.fbx", "--library", indexed).code == 2
    assert run("compose", "-o", tmp_path / "y.bvh", "--library", indexed).code == 2
