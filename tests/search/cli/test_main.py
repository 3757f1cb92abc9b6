"""The command line: what every command promises."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import click
import numpy as np
import pytest

from encoders.errors import MotionSeekError
from search.cli.main import COMMANDS, cli
from tests.search.conftest import Run


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
ENDLESS = {"serve", "model train", "model decoder", "model release", "model card", "model import", "model calibrate"}


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
    from search.cli.main import main

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
        (["moments", "walks", "--then", "sits", "--while", "waves", "take 1"], "exclude each other"),
        (["export", "take 1", "x.fbx"], ".bvh, .npz, .npy, .glb"),
        (["export", "take 1", "x.npy", "--start", "9"], "outside"),
        (["export", "take 1", "x.npy", "--fps", "60"], "write a .npz"),
        (["segment", "take 1", "--labels", " , "], "--labels"),
        (["similar", "take 1", "--start", "3", "--end", "2"], "end=2 must be after start=3"),
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
    assert run("search", "walks", "--library", tmp_path, "--json").document == {
        "query": "walks",
        "language": None,
        "hits": [],
    }
    assert "empty" in run("search", "walks", "--library", tmp_path).err


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
        ("#77", "no clip of that number"),
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


def test_an_exported_archive_is_a_clip_again(indexed: Path, run: Run, tmp_path: Path) -> None:
    run("export", "take 3", tmp_path / "cut.npz", "--start", 2, "--end", 5, "--library", indexed)
    cut = (tmp_path / "cut.npz", "--start", 0)  # of a cut, also what is like a part of a clip
    assert run("similar", *cut, "--library", indexed, "--json", "-k", 1).document["hits"][0]["path"] == "take 3.npy"
    assert run("index", tmp_path, "--json", "--jobs", 1).document["indexed"] == 1


def test_model_info(run: Run) -> None:
    assert {"name", "fingerprint", "licence", "latent_size"} <= set(run("model", "info", "--json").document)


def _python(*arguments: str, **more: str) -> subprocess.CompletedProcess[str]:
    environment = {**os.environ, **more}
    return subprocess.run([sys.executable, *arguments], capture_output=True, text=True, env=environment, check=False)


BLOCKED = """
import sys
import time
class Block:
    def find_spec(self, name, path=None, target=None):
        if name.split(".")[0] == "torch":
            raise ImportError(f"{name} is blocked")
sys.meta_path.insert(0, Block())
import json, encoders.bundle.bundle, pathlib
encoders.bundle.bundle.DEFAULT = pathlib.Path(sys.argv[1])
from search.cli.main import main
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
        ["duplicates", *library],
        ["compose", "--then", "walks", "2", "-o", str(tmp_path / "y.bvh"), *library],
        ["list", *library],
        ["tag", *library],
        ["duplicates", *library],
        ["check", *library],
        ["forget", "--gone", *library],
        ["model", "info"],
    ]
    (tmp_path / "none").mkdir()
    done = _python("-c", BLOCKED, str(tiny_bundle), json.dumps(ran))
    assert done.returncode == 0, done.stderr
    assert {arguments[0] for arguments in ran} | {"demo"} | ENDLESS >= set(COMMANDS) - {"evaluate", "judge", "generate"}


def test_help_needs_no_heavy_import() -> None:
    code = (
        "import sys; from search.cli.main import main\n"
        "try: main(['--help'])\n"
        "except SystemExit: pass\n"
        "print(sorted({'numpy', 'onnxruntime', 'faiss', 'rich', 'torch', 'matplotlib'} & set(sys.modules)))"
    )
    assert _python("-c", code).stdout.splitlines()[-1] == "[]"


def test_search_imports_nothing_that_reads_writes_or_composes_motions(indexed: Path, tiny_bundle: Path) -> None:
    code = (
        "import sys, pathlib, encoders.bundle.bundle\n"
        "encoders.bundle.bundle.DEFAULT = pathlib.Path(sys.argv[1])\n"
        "from search.cli.main import main\n"
        "try: main(['search', 'a person walks', '--json', '--library', sys.argv[2]])\n"
        "except SystemExit as ended: assert ended.code == 0\n"
        "heavy = ['sqlite_utils', 'pandas', 'importlib.metadata', 'indexer.formats.bvh', 'indexer.formats.fbx', "
        "'indexer.rigs', 'indexer.ingest.arrays', 'search.compose.composition', 'search.export', 'search.drawing']\n"
        "print([name for name in heavy if name in sys.modules])"
    )
    done = _python("-c", code, str(tiny_bundle), str(indexed))
    assert done.stdout.splitlines()[-1] == "[]", done.stderr


@pytest.mark.skipif(os.name == "nt", reason="closes a stream as shells do")
def test_a_process_without_stdout_is_no_error(indexed: Path) -> None:
    script = "import sys; from search.cli.main import main; main(sys.argv[1:])"
    command = [sys.executable, "-c", script, "status", str(indexed)]
    done = subprocess.run(["sh", "-c", 'exec "$@" >&-', "sh", *command], capture_output=True, text=True, check=False)
    assert (done.returncode, done.stderr) == (0, "")


def test_a_name_that_the_encoding_lacks_is_printed_in_ascii(indexed: Path, tiny_bundle: Path) -> None:
    script = "import sys; from search.cli.main import main; main(sys.argv[1:])"
    done = _python("-c", script, "status", str(indexed), PYTHONIOENCODING="ascii")
    assert done.returncode == 0, done.stderr
    assert "Gr\\xf6\\xdfe" in done.stdout


@pytest.mark.parametrize("arguments", [["status"], ["search", "--help"]])
def test_a_reader_that_goes_away_is_no_error(indexed: Path, arguments: list[str]) -> None:
    script = "import sys; from search.cli.main import main; main(sys.argv[1:])"
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


@pytest.mark.parametrize(
    ("arguments", "advice"),
    [
        (["search", "walk", "forward"], 'motionseek search "walk forward"'),
        (["search", "walk", "forward", "-k", "3"], 'motionseek search "walk forward"'),
        (["moments", "walk", "forward", "take.npy"], 'motionseek moments "walk forward" take.npy'),
        (["search", "a person walks", "the takes"], "motionseek search \"a person walks\" --library 'the takes'"),
        (["search", "walks", "."], 'motionseek search "walks" --library .;'),
        (["search", "walks", ".."], 'motionseek search "walks" --library ..;'),
        (["search", "the takes", "walks"], "motionseek search \"walks\" --library 'the takes'"),
        (["moments", "not there.bvh"], '"not there.bvh": there is no such file'),
        (["--json", "search", "walks"], "options come after the command"),
        (["find", "a person walks"], "did you mean 'search'?"),
        (["search", "walks", "--min-duration", "nan"], "'--min-duration': nan is no finite number"),
        (["search", "walks", "--max-duration", "inf"], "'--max-duration': inf is no finite number"),
        (["search", "walks", "-k", "1.5"], "'-k': '1.5' is not a valid whole number"),
        (["index", ".", "--fps", "nan"], "'--fps': nan is no finite number"),
        (["describe", "x.bvh", "--start", "1e999"], "'--start': 1e999 is no finite number"),
    ],
)
def test_wrong_usage_gets_the_advice_that_fits(
    run: Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, arguments: list[str], advice: str
) -> None:
    (tmp_path / "take.npy").touch()
    (tmp_path / "the takes").mkdir()
    monkeypatch.chdir(tmp_path)
    ran = run(*arguments)
    assert ran.code == 2
    assert advice in ran.err
    assert ran.err.count("\n") == 1


def test_an_error_that_is_its_own_context_is_one_line(run: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    """As the errors of clients that try again are; what looks along the chain must come to its end."""

    def fails(*given: object, **options: object) -> None:
        error, other = MotionSeekError("no answer"), ValueError()
        error.__context__, other.__context__ = other, error
        raise error

    monkeypatch.setattr("search.cli.options.open_library", fails)
    ran = run("search", "walks")
    assert (ran.code, ran.err) == (1, "motionseek: no answer\n")


@pytest.mark.skipif(os.name == "nt", reason="signals")
@pytest.mark.parametrize("delay", [0.05, 0.1, 0.25])
def test_an_interrupt_is_one_line_at_any_time(delay: float, tmp_path: Path) -> None:
    np.save(tmp_path / "take.npy", np.zeros((100_000, 22, 3), np.float32))
    program = "import motionseek_main as m; m.hidden_package = lambda: print('begun', flush=True); m.main()"
    process = subprocess.Popen(
        [sys.executable, "-c", program, "describe", str(tmp_path / "take.npy")],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )
    assert process.stdout is not None
    process.stdout.readline()
    time.sleep(delay)
    process.send_signal(signal.SIGINT)
    _, err = process.communicate(timeout=60)
    assert process.returncode == 130
    assert err == "motionseek: interrupted\n"
