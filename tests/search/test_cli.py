"""The command line: what every command promises."""

from __future__ import annotations

import itertools
import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

import click
import pytest

from search.cli import COMMANDS, cli
from tests.search.conftest import Run

HIT = {"rank", "path", "score", "strength", "start", "end", "duration", "caption"}


def _commands(group: click.Group, ctx: click.Context, name: str = "") -> dict[str, click.Command]:
    found = {}
    for sub in group.list_commands(ctx):
        command = group.get_command(ctx, sub)
        assert command is not None
        found[f"{name} {sub}".strip()] = command
        if isinstance(command, click.Group):
            found |= _commands(command, ctx, f"{name} {sub}".strip())
    return found


ALL = _commands(cli, click.Context(cli))
#: Commands whose outcome is no answer but a server, a model or a page.
ENDLESS = {"serve", "model train", "model release", "model card"}


@pytest.mark.parametrize("name", ALL)
def test_every_command_has_help_with_an_example(name: str) -> None:
    text = ALL[name].get_help(click.Context(ALL[name], info_name=name))
    assert "Examples:" in text
    assert f"motionseek {name.split()[0]}" in text
    assert "--json" in text or isinstance(ALL[name], click.Group) or name in ENDLESS


@pytest.mark.parametrize("name", ALL)
def test_every_option_is_explained(name: str) -> None:
    options = [p for p in ALL[name].params if isinstance(p, click.Option)]
    assert [option.opts for option in options if not option.help] == []


def test_a_mistyped_command_gets_a_suggestion(run: Run) -> None:
    ran = run("serach", "a person walks")
    assert ran.code == 2
    assert ran.err.count("\n") == 1
    assert "did you mean 'search'" in ran.err


def test_a_mistyped_option_gets_a_suggestion(run: Run) -> None:
    ran = run("search", "walks", "--min-duratoin", "3")
    assert ran.code == 2
    assert ran.err.count("\n") == 1
    assert "--min-duration" in ran.err


@pytest.mark.parametrize("arguments", [[], ["model"]])
def test_without_a_command_the_help_is_shown(run: Run, arguments: list[str]) -> None:
    ran = run(*arguments)
    assert (ran.code, ran.err) == (0, "")
    assert ran.out.startswith("Usage: motionseek")
    assert ran.out.count("\n") > 10


def test_index_wants_a_folder(takes: Path, run: Run) -> None:
    file = run("index", takes / "take 1.npy")
    assert (file.code, file.err.count("\n")) == (2, 1)
    assert "index its folder" in file.err
    nothing = run("index", takes / "nowhere")
    assert (nothing.code, nothing.err.count("\n")) == (2, 1)
    assert "no folder" in nothing.err


def test_version(run: Run) -> None:
    assert run("--version").out.startswith("motionseek ")


def test_no_library_is_one_line_that_says_what_to_do(run: Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    ran = run("search", "a person walks")
    assert ran.code == 1
    assert ran.out == ""
    assert ran.err.count("\n") == 1
    assert "motionseek index FOLDER" in ran.err


def test_an_error_is_a_traceback_only_with_debug(indexed: Path, run: Run) -> None:
    from encoders.errors import LibraryError
    from search.cli import main

    assert "Traceback" not in run("export", "nothing", "x.npy", "--library", indexed).err
    with pytest.raises(LibraryError):
        main(["--debug", "export", "nothing", "x.npy", "--library", str(indexed)])


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["search", ""], "empty"),
        (["search", "?!"], "empty"),
        (["search", "walks", "-k", "0"], "-k"),
        (["search", "walks", "--min-duration", "5", "--max-duration", "2"], "no clip can be both"),
        (["search"], "SENTENCE"),
        (["moments", "walks", "--plot", "x.png"], "CLIP"),
        (["moments", "walks", "--then", "sits", "--while", "waves", "take 1"], "together"),
        (["export", "take 1", "x.fbx"], ".bvh, .npz, .npy"),
        (["export", "take 1", "x.npy", "--start", "9"], "outside"),
        (["segment", "take 1", "--labels", " , "], "--labels"),
        (["similar", "take 1", "--start", "3", "--end", "2"], "outside"),
        (["similar", "take 1", "--start", "2", "--end", "2.1"], "at least 0.5 s"),
        (["moments", "walks", "take 1", "--plot", "x.gif.mp4"], ".png"),
    ],
)
def test_wrong_usage_exits_with_2_and_one_line(
    indexed: Path, run: Run, monkeypatch: pytest.MonkeyPatch, arguments: list[str], said: str
) -> None:
    monkeypatch.chdir(indexed)
    ran = run(*arguments)
    assert (ran.code, ran.err.count("\n")) == (2, 1), ran.err
    assert said in ran.err


def test_index_reports_what_it_did(takes: Path, run: Run, tmp_path: Path) -> None:
    library = tmp_path / "lib"
    first = run("index", takes, "--library", library, "--json", "--jobs", 1)
    assert first.code == 1  # one file is broken
    assert {"indexed", "unchanged", "moved", "gone", "failed", "seconds"} <= set(first.document)
    assert first.document["indexed"] == 5
    assert [Path(f["path"]).name for f in first.document["failed"]] == ["broken.bvh"]
    again = run("index", takes, "--library", library, "--jobs", 1)
    assert again.code == 0, "nothing failed that was not known to"
    assert again.out.startswith("5 unchanged, 1 failed before (")
    assert "status --failed" in again.err
    retried = run("index", takes, "--library", library, "--jobs", 1, "--retry")
    assert retried.code == 1
    assert retried.out.startswith("5 unchanged, 1 failed (")


def test_index_of_an_empty_folder(run: Run, tmp_path: Path) -> None:
    ran = run("index", tmp_path)
    assert ran.code == 0
    assert "no motion files" in ran.out
    assert run("search", "walks", "--library", tmp_path, "--json").document == {"query": "walks", "hits": []}
    assert "empty" in run("search", "walks", "--library", tmp_path).err


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
    assert set(found) == {"path", "sentences"}
    assert [set(sentence) for sentence in found["sentences"]] == [{"text", "score"}] * 4


def test_moments_of_a_file_that_is_not_indexed(
    takes: Path, run: Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    found = run("moments", "a person walks", takes / "take 3.npy", "--json", "-k", 2).document
    assert set(found) == {"query", "hits", "curve"}
    assert len(found["curve"]["times"]) == len(found["curve"]["similarity"]["a person walks"])


def test_a_file_is_no_sentence_wherever_it_stands(takes: Path, run: Run, tmp_path: Path) -> None:
    file = takes / "take 1.npy"
    swapped = run("moments", file, "a person walks", "--json", "-k", 1)
    assert swapped.document == run("moments", "a person walks", file, "--json", "-k", 1).document
    alone = run("moments", file)
    assert alone.code == 2
    assert "what to look for" in alone.err
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


def test_status(indexed: Path, run: Run) -> None:
    assert run("status", "--library", indexed, "--json").document["clips"] == 5
    failed = run("status", "--failed", "--library", indexed, "--json").document["failed"]
    assert [Path(f["path"]).name for f in failed] == ["broken.bvh"]


def test_status_takes_a_folder(indexed: Path, run: Run, tmp_path: Path) -> None:
    assert run("status", indexed, "--json").document["clips"] == 5
    assert run("status", indexed / ".motionseek", "--json").document["clips"] == 5
    both = run("status", indexed, "--library", indexed)
    assert (both.code, both.err.count("\n")) == (2, 1)
    none = run("status", tmp_path)
    assert (none.code, none.err.count("\n")) == (1, 1)
    assert f"motionseek index {tmp_path}" in none.err


@pytest.mark.parametrize("command", ["describe", "similar", "moments", "export", "segment"])
@pytest.mark.parametrize(
    ("ref", "said"),
    [
        ("deep er", "this is a folder; name a file in it"),
        ("tak 1", "no such file; did you mean take 1.npy"),
        ("xyz.bvh", "no such file"),
        ("2", "did you mean '#2'?"),
        ("#77", "no clip #77"),
    ],
)
def test_what_names_no_clip_says_what_to_do(
    indexed: Path, run: Run, monkeypatch: pytest.MonkeyPatch, command: str, ref: str, said: str
) -> None:
    monkeypatch.chdir(indexed)
    arguments = {"moments": ["walks", ref], "export": [ref, "x.npz"]}.get(command, [ref])
    ran = run(command, *arguments)
    assert (ran.code, ran.err.count("\n")) == (1, 1), ran.err
    assert said in ran.err


def test_without_a_library_a_file_must_be_there(run: Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    assert "no such file" in run("describe", "walk.bvh").err
    assert "this is a folder" in run("describe", ".").err


def test_an_exported_archive_is_a_clip_again(
    indexed: Path, run: Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("search.evidence.WINDOW_MARGIN", 0.0)  # all scores of a model of random weights lie within it
    run("export", "take 3", tmp_path / "cut.npz", "--start", 2, "--end", 5, "--library", indexed)
    cut = (tmp_path / "cut.npz", "--start", 0)  # of a cut, also what is like a part of a clip
    assert run("similar", *cut, "--library", indexed, "--json", "-k", 1).document["hits"][0]["path"] == "take 3.npy"
    assert run("index", tmp_path, "--json", "--jobs", 1).document["indexed"] == 1


def test_model_info(run: Run) -> None:
    assert {"name", "fingerprint", "licence", "latent_size"} <= set(run("model", "info", "--json").document)


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
    assert all(len(line.split("\t")) == 7 for line in lines)


def test_the_library_is_the_nearest_one_upward(
    indexed: Path, run: Run, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.chdir(indexed / "deep er")
    assert run("status", "--json").document["clips"] == 5
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("MOTIONSEEK_LIBRARY", str(indexed))
    assert run("status", "--json").document["clips"] == 5


def _python(*arguments: str, **more: str) -> subprocess.CompletedProcess[str]:
    environment = {**os.environ, **more}
    return subprocess.run([sys.executable, *arguments], capture_output=True, text=True, env=environment, check=False)


BLOCKED = """
import sys
class Block:
    def find_spec(self, name, path=None, target=None):
        if name.split(".")[0] == "torch":
            raise ImportError(f"{name} is blocked")
sys.meta_path.insert(0, Block())
import json, encoders.bundle, pathlib
encoders.bundle.DEFAULT = pathlib.Path(sys.argv[1])
from search.cli import main
for arguments in json.loads(sys.argv[2]):
    try:
        main(arguments)
    except SystemExit as ended:
        assert ended.code == 0, (arguments, ended.code)
assert "torch" not in sys.modules
"""


def test_no_command_loads_torch(indexed: Path, tiny_bundle: Path, tmp_path: Path) -> None:
    library = ["--library", str(indexed)]
    ran = [
        ["index", str(tmp_path / "none")],
        ["search", "a person walks", *library],
        ["moments", "a person walks", "take 3", "--plot", str(tmp_path / "x.png"), *library],
        ["describe", "take 3", *library],
        ["similar", "take 3", *library],
        ["segment", "take 3", "--labels", "walk", *library],
        ["export", "take 3", str(tmp_path / "x.bvh"), *library],
        ["render", "take 3", str(tmp_path / "x.gif"), "--size", "64", *library],
        ["status", *library],
        ["model", "info"],
    ]
    (tmp_path / "none").mkdir()
    done = _python("-c", BLOCKED, str(tiny_bundle), json.dumps(ran))
    assert done.returncode == 0, done.stderr
    assert {arguments[0] for arguments in ran} | {"demo"} | ENDLESS >= set(COMMANDS) - {"evaluate"}


def test_help_needs_no_heavy_import() -> None:
    code = (
        "import sys; from search.cli import main\n"
        "try: main(['--help'])\n"
        "except SystemExit: pass\n"
        "print(sorted({'numpy', 'onnxruntime', 'faiss', 'rich', 'torch', 'matplotlib'} & set(sys.modules)))"
    )
    assert _python("-c", code).stdout.splitlines()[-1] == "[]"


@pytest.mark.skipif(os.name == "nt", reason="closes a stream as shells do")
def test_a_process_without_stdout_is_no_error(indexed: Path) -> None:
    script = "import sys; from search.cli import main; main(sys.argv[1:])"
    command = [sys.executable, "-c", script, "status", str(indexed)]
    done = subprocess.run(["sh", "-c", 'exec "$@" >&-', "sh", *command], capture_output=True, text=True, check=False)
    assert (done.returncode, done.stderr) == (0, "")


def test_a_name_that_the_encoding_lacks_is_printed_in_ascii(indexed: Path, tiny_bundle: Path) -> None:
    script = "import sys; from search.cli import main; main(sys.argv[1:])"
    done = _python("-c", script, "status", str(indexed), PYTHONIOENCODING="ascii")
    assert done.returncode == 0, done.stderr
    assert "Gr\\xf6\\xdfe" in done.stdout


@pytest.mark.parametrize("arguments", [["status"], ["search", "--help"]])
def test_a_reader_that_goes_away_is_no_error(indexed: Path, arguments: list[str]) -> None:
    script = "import sys; from search.cli import main; main(sys.argv[1:])"
    process = subprocess.Popen(
        [sys.executable, "-c", script, *arguments, "--library", str(indexed)],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )
    assert process.stdout is not None
    process.stdout.close()
    assert process.stderr is not None
    with process.stderr as err:
        assert err.read() == ""
    assert process.wait() == 141


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
