"""The packages depend on one another in one direction, and searching never needs torch."""

from __future__ import annotations

import ast
import subprocess
import sys
from collections.abc import Iterator
from functools import cache
from pathlib import Path

import pytest

from tests.conftest import ROOT

#: Package -> those it may import.
MAY_IMPORT = {
    "encoders": {"encoders"},
    "indexer": {"encoders", "indexer"},
    "search": {"encoders", "indexer", "search"},
}
#: Where torch may be imported; nothing else may import these at its top.
TRAINING = ("encoders.tmr", "search.release")
FUNCTIONS = (ast.FunctionDef, ast.AsyncFunctionDef)

FILES = sorted(path for package in MAY_IMPORT for path in (ROOT / package).rglob("*.py"))


def module_of(path: Path) -> str:
    return ".".join(path.relative_to(ROOT).with_suffix("").parts).removesuffix(".__init__")


def names(tree: ast.AST, *, inside_functions: bool) -> Iterator[str]:
    """Full names of what a tree imports; of `if TYPE_CHECKING` nothing, for it is never run."""
    for node in ast.iter_child_nodes(tree):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, "imports are absolute"
            yield from (f"{node.module}.{alias.name}" for alias in node.names)
        elif isinstance(node, ast.If) and ast.unparse(node.test) == "TYPE_CHECKING":
            continue
        elif isinstance(node, (ast.stmt, ast.excepthandler)) and (inside_functions or not isinstance(node, FUNCTIONS)):
            yield from names(node, inside_functions=inside_functions)


@cache
def imported(path: Path, *, inside_functions: bool) -> tuple[str, ...]:
    return tuple(names(ast.parse(path.read_text(encoding="utf-8")), inside_functions=inside_functions))


def within(name: str, packages: tuple[str, ...]) -> bool:
    return any(name == package or name.startswith(package + ".") for package in packages)


@pytest.mark.parametrize("package", MAY_IMPORT)
def test_nothing_imports_upward(package: str) -> None:
    ours = {*MAY_IMPORT, "motionseek", "tests", "benchmarks"}
    wrong = [
        f"{module_of(path)} imports {name}"
        for path in FILES
        if module_of(path).split(".")[0] == package
        for name in imported(path, inside_functions=True)
        if name.split(".")[0] in ours - MAY_IMPORT[package]
    ]
    assert wrong == []


def test_only_training_imports_torch() -> None:
    wrong = [
        f"{module_of(path)} imports {name}"
        for path in FILES
        if not within(module_of(path), TRAINING)
        for name in imported(path, inside_functions=True)
        if name.split(".")[0] in {"torch", "safetensors", "onnx"}
    ]
    assert wrong == []


def test_what_needs_torch_is_imported_only_when_it_is_wanted() -> None:
    wrong = [
        f"{module_of(path)} imports {name}"
        for path in FILES
        if not within(module_of(path), TRAINING)
        for name in imported(path, inside_functions=False)
        if within(name, TRAINING)
    ]
    assert wrong == []


IMPORT_ALL = """
import sys, importlib
class Block:
    def find_spec(self, name, path=None, target=None):
        if name.split(".")[0] in {"torch", "onnx", "safetensors"}:
            raise ImportError(f"{name} is blocked")
sys.meta_path.insert(0, Block())
for name in sys.argv[1:]:
    importlib.import_module(name)
"""


@pytest.mark.slow
def test_every_module_but_those_of_training_imports_where_torch_is_missing() -> None:
    modules = ["motionseek", *(module_of(path) for path in FILES if not within(module_of(path), TRAINING))]
    done = subprocess.run(
        [sys.executable, "-c", IMPORT_ALL, *modules], cwd=ROOT, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
