"""Asking on the command line: what is found, how it is shown, and where its library is looked for."""

from __future__ import annotations

import itertools
import shutil
from pathlib import Path

import pytest

from tests.search.conftest import Run

HIT = {"rank", "path", "score", "strength", "start", "end", "duration", "caption", "clip", "root"}
HIT |= {"source_fps", "first_frame", "last_frame", "stale", "matched", "starred", "tags", "collections"}


@pytest.mark.parametrize("command", ["search", "moments"])
def test_answers_as_json(indexed: Path, run: Run, command: str) -> None:
    found = run(command, "a person walks", "--library", indexed, "--json", "-k", 3).document
    assert found["query"] == "a person walks"
    assert len(found["hits"]) == 3
    for rank, hit in enumerate(found["hits"], start=1):
        assert set(hit) == HIT
        assert hit["rank"] == rank
        assert (indexed / hit["path"]).is_file()
        assert 0 <= hit["start"] < hit["end"] <= hit["duration"]


def test_similar_as_json_leaves_the_clip_itself_out(indexed: Path, run: Run) -> None:
    found = run("similar", "take 2", "--library", indexed, "--json").document
    assert found["query"] == "take 2"
    assert {hit["path"] for hit in found["hits"]} == {
        "take 0.npy", "take 1.npy", "take 3.npy", "deep er/bücken.bvh"
    }  # fmt: skip


def test_similar_moments_of_a_cut(indexed: Path, run: Run) -> None:
    arguments = [
        "similar",
        "take 3.npy",
        "--start",
        2,
        "--end",
        5,
        "--moments",
        "--library",
        indexed,
        "--json",
        "-k",
        2,
    ]
    assert {hit["path"] for hit in run(*arguments).document["hits"]}.isdisjoint({"take 3.npy"})


def test_describe_as_json(indexed: Path, run: Run) -> None:
    found = run("describe", "take 1.npy", "--library", indexed, "--json", "-k", 4).document
    assert set(found) == {"path", "sentences", "stale"}
    assert [set(sentence) for sentence in found["sentences"]] == [{"text", "score", "strength"}] * 4


def test_moments_of_a_file_that_is_not_indexed(
    takes: Path, run: Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    found = run("moments", "a person walks", takes / "take 3.npy", "--json", "-k", 2).document
    assert set(found) == {"query", "language", "hits", "curve"}
    assert len(found["curve"]["times"]) == len(found["curve"]["similarity"]["a person walks"])


def test_one_argument_beside_steps_is_the_sentence_unless_it_names_a_clip(indexed: Path, run: Run) -> None:
    library = ["--library", indexed, "--json", "-k", 2]
    stated = run("moments", "walks, then waves", *library).document
    assert run("moments", "walks", "--then", "waves", *library).document["hits"] == stated["hits"]
    both = run("moments", "walks", "--while", "waves", "--while", "turns", *library).document
    assert both["sentences"] == ["walks", "waves", "turns"]
    in_clip = run("moments", "take 3", "--then", "walks", "--then", "waves", *library).document
    assert "curve" in in_clip
    assert in_clip["sentences"] == ["walks", "waves"]
    missing = run("moments", "missing.bvh", "--then", "walks", "--then", "waves", *library)
    assert "missing.bvh" in missing.err


def test_filters_beside_a_clip_are_refused(indexed: Path, run: Run) -> None:
    for option in (["--path", "x*"], ["--min-duration", 3], ["--uncaptioned"]):
        refused = run("moments", "walks", "take 3", *option, "--library", indexed)
        assert refused.code == 2
        assert "filters choose clips" in refused.err


def test_clips_of_several_roots_are_named_with_their_root(
    tmp_path: Path, takes: Path, run: Run, monkeypatch: pytest.MonkeyPatch
) -> None:
    for root in ("ra", "rb"):
        (tmp_path / root / "take").mkdir(parents=True)
        shutil.copy(takes / "take 1.npy", tmp_path / root / "take" / "x.npy")
    shutil.copy(takes / "take 3.npy", tmp_path / "rb" / "take" / "x.npy")
    monkeypatch.chdir(tmp_path)
    assert run("index", "ra", "rb", "--library", "lib").code == 0
    library = ["--library", "lib"]
    for command in (["search", "walks"], ["moments", "walks"]):
        named = {line.split("\t")[5] for line in run(*command, *library).out.splitlines()}
        assert named == {"ra/take/x.npy", "rb/take/x.npy"}
    for name in ("ra/take/x.npy", "rb/take/x.npy"):
        (found,) = run("similar", name, *library, "--json").document["hits"]
        assert f"{found['root']}/{found['path']}" != name
        (moment,) = run("moments", "walks", name, *library, "-k", 1).out.splitlines()
        assert moment.split("\t")[5] == name
        assert run("describe", name, *library).code == 0
    for ambiguous in ("take/x.npy", "x"):
        error = run("describe", ambiguous, *library).err
        assert error.count("\n") == 1
        assert "ra/take/x.npy (#" in error
        assert "did you mean" not in error
        assert "no such file" not in error
    assert "did you mean ra/take/x.npy or rb/take/x.npy" in run("describe", "take/y.npy", *library).err


def test_a_file_is_no_sentence_wherever_it_stands(takes: Path, run: Run, tmp_path: Path) -> None:
    file = takes / "take 1.npy"
    swapped = run("moments", file, "a person walks", "--json", "-k", 1)
    assert swapped.document == run("moments", "a person walks", file, "--json", "-k", 1).document
    alone = run("moments", file)
    assert alone.code == 2
    assert "give a sentence" in alone.err
    assert "both files" in run("moments", file, takes / "take 2.npy").err


@pytest.mark.parametrize(("ending", "begins"), [(".jpg", b"\xff\xd8"), (".png", b"\x89PNG"), (".svg", b"<?xml")])
def test_a_picture_is_what_its_name_says(ending: str, begins: bytes, takes: Path, run: Run, tmp_path: Path) -> None:
    out = tmp_path / f"curve{ending}"
    assert run("moments", "a person walks", takes / "take 1.npy", "--plot", out).code == 0
    assert out.read_bytes().startswith(begins)


def test_steps_are_shown_with_their_spans(indexed: Path, run: Run) -> None:
    found = run("moments", "walks, then sits down", "take 3", "--library", indexed, "--json").document
    assert found["sentences"] == ["walks", "sits down"]
    first, second = found["hits"][0]["steps"]
    assert first["end"] <= second["start"] + 1e-6
    explicit = run("moments", "--then", "walks", "--then", "sits down", "take 3", "--library", indexed, "--json")
    assert explicit.document["hits"] == found["hits"]
    whole = run("moments", "walks, then sits down", "take 3", "--no-split", "--library", indexed, "--json").document
    assert "steps" not in whole["hits"][0]


def test_things_at_once_need_no_sentence_before_them(indexed: Path, run: Run) -> None:
    alone = run("moments", "--while", "walks", "--while", "waves", "take 3", "--library", indexed, "--json").document
    assert alone == run("moments", "walks", "take 3", "--while", "waves", "--library", indexed, "--json").document
    assert alone["sentences"] == ["walks", "waves"]


def test_steps_in_the_whole_library(indexed: Path, run: Run) -> None:
    found = run("moments", "walks, then sits down", "--library", indexed, "--json", "-k", 2).document
    assert all(len(hit["steps"]) == 2 for hit in found["hits"])


def test_steps_that_a_take_is_too_short_for_can_be_asked_for_as_one(indexed: Path, run: Run, tmp_path: Path) -> None:
    short = tmp_path / "short.npy"
    assert run("export", "take 3", short, "--end", 1.2, "--library", indexed).code == 0
    for steps, advised in [(["runs and then jumps"], True), (["--then", "runs", "--then", "jumps"], False)]:
        assert ("--no-split" in run("moments", *steps, short, "--library", indexed).err) is advised
    assert run("moments", "runs and then jumps", short, "--no-split", "--library", indexed).out


def test_composing_says_for_what_the_library_holds_no_good_match(
    indexed: Path, run: Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    from search.hits import Hits

    out = ["-o", tmp_path / "made.npz", "--force", "--library", indexed]
    sentences = ["--then", "walks -left", 2, "--then", "qxzv", 2]
    monkeypatch.setattr(Hits, "nothing_matches", False)
    assert "no good match" not in run("compose", *sentences, *out).err
    monkeypatch.setattr(Hits, "nothing_matches", True)
    said = run("compose", *sentences, *out).err
    assert "qxzv: no good match; it is shown by what is nearest" in said


def test_composing_says_that_a_time_line_that_begins_later_was_moved(indexed: Path, run: Run, tmp_path: Path) -> None:
    lines, out = tmp_path / "lines.txt", ["-o", tmp_path / "made.npz", "--force", "--library", indexed]
    lines.write_text("walks # 100 # 102\n", "utf-8")
    assert "nothing happens before 100 s" in run("compose", lines, *out).err
    lines.write_text("walks # 0.01 # 2\n", "utf-8")
    assert "nothing happens" not in run("compose", lines, *out).err


def test_segments_cover_the_take(indexed: Path, run: Run, tmp_path: Path) -> None:
    out = tmp_path / "labels.tsv"
    ran = run("segment", "take 3", "--labels", "walk, sit down", "--library", indexed, "-o", out, "--json")
    segments = ran.document["segments"]
    assert segments[0]["start"] == 0
    assert segments[-1]["end"] == 20
    assert all(a["end"] == b["start"] for a, b in itertools.pairwise(segments))
    assert out.read_text(encoding="utf-8").splitlines()[0] == "start\tend\tlabel\tscore"


def test_nothing_is_overwritten_without_force(indexed: Path, run: Run, tmp_path: Path) -> None:
    out = tmp_path / "cut.npy"
    out.write_text("mine")
    for arguments in (["export", "take 3", out], ["moments", "walks", "take 3", "--plot", out]):
        ran = run(*arguments, "--library", indexed)
        assert (ran.code, ran.err.count("\n")) == (1, 1)
        assert "--force" in ran.err
    assert out.read_text() == "mine"
    assert run("export", "take 3", out, "--force", "--library", indexed).code == 0


def test_filters(indexed: Path, run: Run) -> None:
    def paths(*filters: object) -> set[str]:
        found = run("search", "walks", "--library", indexed, "--json", *filters).document
        return {hit["path"] for hit in found["hits"]}

    assert paths("--min-duration", 7) == {"take 2.npy", "take 3.npy"}
    assert paths("--max-duration", 3) == {"take 0.npy"}
    assert paths("--path", "deep er/*") == paths("--format", "bvh") == {"deep er/bücken.bvh"}
    assert paths("--captioned") == {"take 1.npy", "take 3.npy"}
    assert paths("--path", "'; DROP TABLE clips; --") == set()
    assert len(paths("--uncaptioned")) == 3


def test_the_caption_of_a_hit_is_that_of_its_span(indexed: Path, run: Run) -> None:
    found = run("moments", "walks", "take 3", "--library", indexed, "--json", "-k", 20).document["hits"]
    for hit in found:
        spoken = {"bückt sich": (2, 5), "waves": (6, 9)}
        if hit["caption"]:
            start, end = spoken[hit["caption"]]
            assert hit["start"] < end
            assert hit["end"] > start


def test_piped_answers_are_lines_with_tabs(indexed: Path, run: Run) -> None:
    lines = run("search", "a person walks", "--library", indexed).out.splitlines()
    assert len(lines) == 5
    assert all(len(line.split("\t")) == 8 for line in lines)


def test_the_library_is_the_nearest_one_upward(
    indexed: Path, run: Run, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.chdir(indexed / "deep er")
    assert run("status", "--json").document["clips"] == 5
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("MOTIONSEEK_LIBRARY", str(indexed))
    assert run("status", "--json").document["clips"] == 5


def test_a_file_is_read_at_the_rate_its_library_was_told_of_unless_another_is_given(
    takes: Path, run: Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    mine, eight_seconds = tmp_path / "mine", "take 2.npy"
    mine.mkdir()
    shutil.copy(takes / eight_seconds, mine)
    shutil.copy(takes / eight_seconds, tmp_path / "copy.npy")
    assert run("index", mine, "--fps", 10, "--jobs", 1).code == 0
    monkeypatch.chdir(tmp_path)
    library = ("--library", mine)
    for asked in ((mine / eight_seconds, *library), ("copy.npy", *library), (mine / eight_seconds,)):
        for given, seconds in (((), 16), (("--fps", 40), 4)):
            close = pytest.approx(seconds, abs=0.1)
            assert run("segment", *asked, *given, "--json").document["segments"][-1]["end"] == close
            assert run("moments", "walks", *asked, *given, "--json").document["hits"][0]["duration"] == close
            late = run("describe", *asked, *given, "--start", 10)
            assert late.code == (0 if seconds == 16 else 2)
    assert run("similar", eight_seconds, "--start", 10, *library, "--json").code == 0
    assert "outside" in run("similar", eight_seconds, "--start", 10, "--fps", 40, *library).err
    assert run("moments", "walks", "--fps", 40, *library).code == 2
