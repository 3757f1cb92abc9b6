"""Time lines: what is read, what the words tell, and what is refused."""

from __future__ import annotations

from pathlib import Path

import pytest

from encoders.errors import QueryError
from search.compose.body_parts import ALL, PARTS, parts_of
from search.compose.timeline import Interval, Timeline, read_timelines

RIGHT = frozenset({"right arm"})


@pytest.fixture
def written(tmp_path: Path):
    def write(text: str, name: str = "lines.txt") -> Path:
        (tmp_path / name).write_text(text, "utf-8")
        return tmp_path / name

    return write


def test_the_published_form_is_read(written) -> None:
    path = written(
        "## 0000\nwalk backwards # 0.5 # 4 # legs\nwave # 1 # 3 # left hand\n\n"
        "## 0001\nsit down # 0 # 2\nstand up # 2 # 4\n"
    )
    first, second = read_timelines(path)
    assert (first.name, first.moved) == ("0000", 0.5)
    assert first.intervals == (
        Interval("walk backwards", 0.0, 3.5, frozenset({"legs"})),
        Interval("wave", 0.5, 2.5, frozenset({"left arm"})),
    )
    assert [one.parts for one in second.intervals] == [ALL, ALL]
    assert second.duration == 4


def test_names_are_optional_and_json_says_the_same(written) -> None:
    text = "walks # 0 # 3\nsits # 3 # 5\n\nruns # 0 # 2\n"
    rows = '[{"text": "walks", "start": 0, "end": 3}, {"text": "sits", "start": 3, "end": 5}]'
    in_text, in_json = read_timelines(written(text)), read_timelines(written(f'{{"1": {rows}}}', "lines.json"))
    assert len(in_text) == 2
    assert in_text[0].intervals == in_json[0].intervals
    assert read_timelines(written(rows, "one.json"))[0].intervals == in_json[0].intervals


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        ("", "holds no time line"),
        ("walks\n", "line 1: 'walks' is no 'sentence # start # end'"),
        ("walks # a # 3\n", "line 1"),
        ("walks # 3 # 1\n", "must end after it starts"),
        ("walks # -1 # 1\n", "start at 0 s or later"),
        ("walks # 0 # 3 # wing\n", "'wing' is no body part; parts are legs"),
        ("walks # 0 # 0.1\n", "last 0.5 s at least"),
        ("walks # 0 # 3\nsits # 5 # 7\n", "nothing happens from 3 to 5 s"),
        ("walks # 0 # nan\n", "must end after it starts"),
        ("walks # 0 # 1e9\n", "longer than 600 s"),
        ("walks # 0 # 3\nruns # 1 # 4\n", "both need"),
        ("waves # 0 # 3 # left arm\nclaps # 1 # 4 # left arm # right arm\n", "both need left arm"),
    ],
)
def test_a_time_line_that_makes_no_sense_is_refused(written, text: str, reason: str) -> None:
    with pytest.raises(QueryError, match=reason):
        read_timelines(written(text))


def test_a_file_that_is_none_is_refused(tmp_path: Path, written) -> None:
    with pytest.raises(QueryError, match="cannot be read"):
        read_timelines(tmp_path / "none.txt")
    with pytest.raises(QueryError, match="no JSON"):
        read_timelines(written("{", "broken.json"))
    with pytest.raises(QueryError, match="lacks text, start and end"):
        read_timelines(written('[{"text": "walks"}]', "rows.json"))


@pytest.mark.parametrize(
    ("sentence", "parts"),
    [
        ("walks in a circle", ALL),
        ("waves with the left hand", frozenset({"left arm"})),
        ("raises the right arm", RIGHT),
        ("throws a ball", RIGHT),
        ("raises both arms", frozenset({"left arm", "right arm"})),
        ("nods", frozenset({"head"})),
        ("turns the head", frozenset({"head"})),
        ("bows", frozenset({"spine", "head"})),
        ("kicks with the left foot", ALL),
    ],
)
def test_words_tell_the_body_parts(sentence: str, parts: frozenset[str]) -> None:
    assert parts_of(sentence) == parts


def test_a_sentence_of_the_whole_body_leaves_to_others_what_they_name() -> None:
    line = Timeline.of([Interval("walks", 0, 4), Interval("waves with the right hand", 1, 3)])
    assert [one.parts for one in line.intervals] == [ALL - RIGHT, RIGHT]


def test_in_each_cut_the_legs_lead_and_fewer_parts_override() -> None:
    line = Timeline.of(
        [
            Interval("bows", 0, 4, frozenset({"spine", "head"})),
            Interval("walks", 1, 6, frozenset({"legs", "left arm"})),
            Interval("waves", 2, 3, RIGHT),
        ]
    )
    cuts = line.cuts()
    assert [(cut.start, cut.end) for cut in cuts] == [(0, 1), (1, 2), (2, 3), (3, 4), (4, 6)]
    names = [[one.text for one in line.intervals][cut.base] for cut in cuts]
    assert names == ["bows", "walks", "walks", "walks", "walks"]
    owners = {part: line.intervals[owner].text for part, owner in cuts[2].owners.items()}
    assert owners == {
        "legs": "walks", "left arm": "walks", "spine": "bows", "head": "bows", "right arm": "waves"
    }  # fmt: skip
    assert set(cuts[0].owners) == set(PARTS)
