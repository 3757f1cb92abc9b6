"""An installed motionseek: what the wheel holds, and what is said where other software hides a package of ours."""

from __future__ import annotations

import subprocess
import sys
import zipfile
from pathlib import Path

import pytest

from tests.conftest import ROOT

COMMAND = "import sys; sys.argv[0] = 'motionseek'; from motionseek_main import main; main()"
#: What the wheel holds beside Python modules: folder -> endings.
DATA = {
    "encoders": {"py.typed"},
    "encoders/bundle/default": {".json", ".onnx", ".npz"},
    "encoders/corpus/heldout": {".json"},
    "encoders/corpus/language/phrases": {".json"},
    "encoders/drawing": {".js"},
    "indexer": {"py.typed"},
    "indexer/rigs": {".json"},
    "search": {"py.typed"},
    "search/demo_data": {".amc", ".asf", ".bvh", ".json", ".tsv", ".txt"},
    "search/evaluate/data": {".txt"},
    "search/page": {".css", ".html", ".js", ".svg"},
    "search/page/vendor/inter": {".txt", ".woff2"},
    "search/page/vendor/three": {".js", ".txt"},
    "search/query": {".txt"},
    "search/translation": {".npz"},
    "search/translation/lexicon": {".txt"},
}


def run_python(code: str, *arguments: str, first: Path, cwd: Path) -> subprocess.CompletedProcess[str]:
    """Run code with `first` before motionseek on the import path."""
    return subprocess.run(
        [sys.executable, "-c", code, *arguments],
        env={"PYTHONPATH": f"{first}:{ROOT}", "PATH": ""},
        cwd=cwd,
        capture_output=True,
        text=True,
        check=False,
    )


def hide(name: str, kind: str, folder: Path) -> Path:
    """Write another package or module of this name; return its file."""
    path = folder / name / "__init__.py" if kind == "package" else folder / f"{name}.py"
    path.parent.mkdir(exist_ok=True)
    path.write_text("raise RuntimeError('other code was run')\n")
    return path


@pytest.mark.parametrize("kind", ["package", "module"])
@pytest.mark.parametrize("name", ["encoders", "indexer", "search"])
def test_a_hidden_package_is_named_in_one_line(name: str, kind: str, tmp_path: Path) -> None:
    path = hide(name, kind, tmp_path)
    command = run_python(COMMAND, "status", first=tmp_path, cwd=tmp_path)
    imported = run_python("import motionseek", first=tmp_path, cwd=tmp_path)
    line = (
        f"motionseek's package '{name}' is hidden by {path}, which comes first on the import path; "
        "rename or move that, or install motionseek in a virtual environment of its own"
    )
    assert (command.returncode, command.stderr) == (1, f"motionseek: {line}\n")
    assert imported.returncode == 1
    assert imported.stderr.splitlines()[-1] == f"ImportError: {line}"


def test_a_package_of_that_name_that_is_already_imported_is_named_too(tmp_path: Path) -> None:
    path = tmp_path / "search.py"
    path.write_text("")
    code = f"import sys; sys.path.insert(0, {str(tmp_path)!r}); import search; sys.path.pop(0); import motionseek"
    imported = run_python(code, first=ROOT, cwd=ROOT)
    assert imported.stderr.splitlines()[-1].startswith(
        f"ImportError: motionseek's package 'search' is hidden by {path}"
    )


def test_a_module_without_file_or_spec_is_named_too() -> None:
    for made in ("types.ModuleType('search')", "types.SimpleNamespace()"):
        code = f"import sys, types; sys.modules['search'] = {made}; import motionseek"
        imported = run_python(code, first=ROOT, cwd=ROOT)
        assert imported.stderr.splitlines()[-1].startswith(
            "ImportError: motionseek's package 'search' is hidden by <search>"
        )


def test_a_folder_without_init_hides_nothing(tmp_path: Path) -> None:
    for name in ("encoders", "indexer", "search"):
        (tmp_path / name).mkdir()
        (tmp_path / name / "notes.py").touch()
    imported = run_python("import motionseek; print(motionseek.Library.__name__)", first=tmp_path, cwd=tmp_path)
    assert (imported.stdout, imported.stderr) == ("Library\n", "")


def test_a_missing_package_is_named(tmp_path: Path) -> None:
    (tmp_path / "motionseek_main.py").write_text((ROOT / "motionseek_main.py").read_text())
    command = subprocess.run(
        [sys.executable, "-S", "-c", COMMAND], cwd=tmp_path, env={}, capture_output=True, text=True, check=False
    )
    line = f"motionseek: the package 'encoders' is missing from {tmp_path}; install motionseek again\n"
    assert (command.returncode, command.stderr) == (1, line)


def test_the_command_starts_without_heavy_imports() -> None:
    code = f"import sys\ntry:\n    sys.argv[1:] = ['--help']; {COMMAND.split('; ', 1)[1]}\nexcept SystemExit: pass\n"
    heavy = "print(sorted({'numpy', 'onnxruntime', 'faiss', 'rich', 'torch', 'matplotlib'} & set(sys.modules)))"
    assert run_python(code + heavy, first=ROOT, cwd=ROOT).stdout.splitlines()[-1] == "[]"


@pytest.fixture(scope="module")
def wheel_files(tmp_path_factory: pytest.TempPathFactory) -> list[str]:
    """The names of the files that hatchling puts into the wheel."""
    builder = pytest.importorskip("hatchling.builders.wheel", reason="hatchling is not installed")
    folder = tmp_path_factory.mktemp("wheel")
    (wheel,) = builder.WheelBuilder(str(ROOT)).build(directory=str(folder), versions=["standard"])
    return zipfile.ZipFile(wheel).namelist()


def test_the_wheel_holds_every_module_and_data_file_and_nothing_else(wheel_files: list[str]) -> None:
    held = {name for name in wheel_files if ".dist-info/" not in name}
    modules = {"motionseek.py", "motionseek_main.py"}
    wanted = modules | {
        path.relative_to(ROOT).as_posix()
        for package in ("encoders", "indexer", "search")
        for path in (ROOT / package).rglob("*.py")
    }
    wanted |= {
        path.relative_to(ROOT).as_posix()
        for folder, endings in DATA.items()
        for path in (ROOT / folder).iterdir()
        if path.suffix in endings or path.name in endings
    }
    assert held == wanted
