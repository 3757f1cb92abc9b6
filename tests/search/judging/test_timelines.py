"""Time lines: their files, and the figures of crops."""

from pathlib import Path

import numpy as np
import pytest

from encoders.errors import QueryError
from encoders.motion import Motion
from search.judging.timeline_figures import crop_table, judge_timelines
from search.judging.timeline_files import Prompt, TimelineMotion, read_references, read_timelines
from tests.search.judging.bodies import standing
from tests.search.judging.evaluator import WristEncoder, raising


def test_crops_are_scored_with_their_own_text_and_its_clip() -> None:
    motion = raising("0000", 1.0, frames=101)  # one centimetre a frame
    prompts = (Prompt("raises a hand", 0, 51), Prompt("stands", 40, 101))
    references = {"stands": raising("", 0.0).motion, "raises a hand": raising("", 0.4, 101).motion}
    found, crops = judge_timelines([TimelineMotion(motion, prompts)], references, WristEncoder(), repeats=2)
    assert (crops[0].start, crops[0].end, crops[0].rank) == (0.0, 2.55, 1.0)
    assert crops[0].score_text == pytest.approx(1.0)
    assert crops[0].score_motion == pytest.approx(0.5 + 0.5 * np.cos(0.1))
    assert (crops[1].score_text, crops[1].rank) == (pytest.approx(0.5 + 0.5 * np.cos(0.6)), 2.0)
    figures = {name: one.value for name, one in found.generated.items()}
    assert figures["precision_1"] == 50.0
    assert figures["score_text"] == pytest.approx(np.mean([crop.score_text for crop in crops]))
    # A hand rises by one centimetre at each of the boundaries, 40 and 51.
    assert figures["transition"] == pytest.approx(1 / 22, rel=1e-3)
    assert found.real["score_motion"].value == 1.0
    assert crop_table(crops).splitlines()[0] == "timeline,text,start,end,score_text,score_motion,rank"


def test_a_text_without_a_clip_is_named() -> None:
    line = TimelineMotion(raising("0", 0.0), (Prompt("stands", 0, 20),))
    with pytest.raises(QueryError, match="no reference for 1 texts of the time lines, such as 'stands'"):
        judge_timelines([line], {"raises a hand": raising("", 0.4).motion}, WristEncoder())
    found, crops = judge_timelines([line], None, WristEncoder(), repeats=2)
    assert found.missing["score_motion"] == "no references"
    assert crops[0].score_motion is None


def _saved(folder: Path, *names: str) -> Path:
    folder.mkdir(exist_ok=True)
    for name in names:
        np.save(folder / f"{name}.npy", standing(90) + np.sin(np.arange(90) / 5)[:, None, None] * [0, 0, 0.01])
    return folder


def test_time_lines_have_names_or_an_order_and_begin_at_zero(tmp_path: Path) -> None:
    folder = _saved(tmp_path / "made", "0000", "0001")
    named = "## 0001\nwalks # 1.0 # 3.0 # legs\nwaves # 1.5 # 2.96 # left arm\n\n## 0000\nsits # 0 # 2\n"
    (tmp_path / "lines.txt").write_text(named)
    first, second = read_timelines(tmp_path / "lines.txt", folder)
    assert (first.motion.name, first.prompts) == ("0001", (Prompt("walks", 0, 40), Prompt("waves", 10, 39)))
    assert first.boundaries == [10, 39, 40]
    assert second.prompts == (Prompt("sits", 0, 40),)
    (tmp_path / "lines.txt").write_text("walks # 1.0 # 3.0\n\n\nsits # 0 # 2 # legs\nwaves # 1 # 2 # left arm\n")
    first, second = read_timelines(tmp_path / "lines.txt", folder)
    assert (first.motion.name, len(second.prompts)) == ("0000", 2)


@pytest.mark.parametrize(
    ("lines", "message"),
    [
        ("", "holds no time line"),
        ("## 0000\nwalks # 0 # 1\n", "holds 2 motions for the 1 time lines"),
        ("## 0000\nwalks # 0 # 1\n\n## 0002\nwalks # 0 # 1\n", "no motion '0002'"),
        ("## 0000\nwalks # 0 # 1\n\n## 0000\nwalks # 0 # 1\n", "time line '0000' is there twice"),
        ("a # 0 # 6\nb # 5 # 6 # left arm\n\nc # 0 # 1\n", "0000 ends after 4.50 s, before 'b' begins"),
    ],
)
def test_time_lines_that_do_not_fit_are_refused(tmp_path: Path, lines: str, message: str) -> None:
    folder = _saved(tmp_path / "made", "0000", "0001")
    (tmp_path / "lines.txt").write_text(lines)
    with pytest.raises(QueryError, match=message):
        read_timelines(tmp_path / "lines.txt", folder)


def test_references_are_clips_or_parts_of_clips(tmp_path: Path) -> None:
    _saved(tmp_path / "real", "walk")
    table = tmp_path / "clips.tsv"
    table.write_text("text\tpath\tstart\tend\nwalks\treal/walk.npy\t\t\nstops\treal/walk.npy\t2\t3\n")
    clips = read_references(table)
    assert {text: len(clip) for text, clip in clips.items()} == {"walks": 90, "stops": 20}
    assert isinstance(clips["walks"], Motion)
    table.write_text("text\tpath\tstart\tend\nwalks\treal/walk.npy\t5\t9\n")
    with pytest.raises(QueryError, match=r"clips.tsv: real/walk.npy: span 5 to 4.5 s lies outside"):
        read_references(table)
