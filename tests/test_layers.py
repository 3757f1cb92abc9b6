"""The rooms: their order, no import cycles, one name for one thing; and searching never needs torch."""

from __future__ import annotations

import ast
import subprocess
import sys
from collections import Counter, defaultdict
from collections.abc import Iterator
from functools import cache
from pathlib import Path

import pytest

from tests.conftest import ROOT

#: Package -> its rooms, lowest first. A room imports only lower ones and those of lower packages.
ROOMS = {
    "encoders": (
        "errors arguments extensions skeleton geometry english drawing motion features protocol bundle metrics "
        "corpus tmr".split()
    ),
    "indexer": (
        "take argument_checks part_names read_motion formats rigs vectors store shards ingest maintenance "
        "datasets".split()
    ),
    "search": (
        "spans hits source references translation query ranking moments stacks documents export drawing plausibility "
        "compose abilities library distant_library milvus_library places standalone map evaluate judging generation "
        "release server cli".split()
    ),
}
#: The rooms of the corpus in the same way.
CORPUS = "scene engine heldout actions language composition".split()
PACKAGES = tuple(ROOMS)
ORDER = {
    f"{package}.{room}": (PACKAGES.index(package), rooms.index(room))
    for package, rooms in ROOMS.items()
    for room in rooms
}

#: Where torch may be imported; nothing else may import these at its top.
TRAINING = ("encoders.tmr", "search.release")
#: Modules named after their command or their route, which may be called like what they serve.
NAMED_AFTER_THEIR_TASK = ("search.cli.commands", "search.server.routes")
#: A folder holds at most so many modules, those below aside.
MOST_MODULES = 16
FAMILIES = ("encoders.corpus.actions",)

FUNCTIONS = (ast.FunctionDef, ast.AsyncFunctionDef)


def module_of(path: Path) -> str:
    return ".".join(path.relative_to(ROOT).with_suffix("").parts).removesuffix(".__init__")


FILES = {module_of(path): path for package in PACKAGES for path in sorted((ROOT / package).rglob("*.py"))}
FOLDERS = {module: path for module, path in FILES.items() if path.stem == "__init__"}
MODULES = {module: path for module, path in FILES.items() if path.stem != "__init__"}


@cache
def parsed(path: Path) -> ast.Module:
    return ast.parse(path.read_text(encoding="utf-8"))


def room_of(module: str) -> str:
    return ".".join(module.split(".")[:2])


def within(name: str, packages: tuple[str, ...]) -> bool:
    return any(name == package or name.startswith(package + ".") for package in packages)


def named(node: ast.AST) -> list[str]:
    """Full names of what one statement imports."""
    if isinstance(node, ast.Import):
        return [alias.name for alias in node.names]
    if isinstance(node, ast.ImportFrom):
        assert node.level == 0, "imports are absolute"
        return [f"{node.module}.{alias.name}" for alias in node.names]
    return []


@cache
def imported(path: Path) -> tuple[str, ...]:
    """Everything a file imports: at its top, inside functions, and under TYPE_CHECKING."""
    return tuple(name for node in ast.walk(parsed(path)) for name in named(node))


def at_the_top(tree: ast.AST) -> Iterator[str]:
    """What a file imports when it is itself imported: nothing of functions or of `if TYPE_CHECKING`."""
    for node in ast.iter_child_nodes(tree):
        yield from named(node)
        if isinstance(node, ast.If) and ast.unparse(node.test) == "TYPE_CHECKING":
            continue
        if isinstance(node, (ast.stmt, ast.excepthandler)) and not isinstance(node, FUNCTIONS):
            yield from at_the_top(node)


def module_named(name: str) -> str | None:
    """The module of ours that a full name is in: of `search.hits.Hit` it is `search.hits`."""
    while name not in FILES and "." in name:
        name = name.rpartition(".")[0]
    return name if name in FILES else None


@cache
def graph() -> dict[str, set[str]]:
    """Module -> the modules of ours that it imports, anywhere in its text."""
    return {
        module: {found for name in imported(path) if (found := module_named(name))} - {module}
        for module, path in FILES.items()
    }


def cycles(edges: dict[str, set[str]]) -> set[tuple[str, ...]]:
    """Sorted groups of nodes that reach one another (strongly connected components of more than one, Tarjan 1972)."""
    index: dict[str, int] = {}
    low: dict[str, int] = {}
    stack: list[str] = []
    found = set()

    def visit(node: str) -> None:
        index[node] = low[node] = len(index)
        stack.append(node)
        for other in sorted(edges[node]):
            if other not in index:
                visit(other)
                low[node] = min(low[node], low[other])
            elif other in stack:
                low[node] = min(low[node], index[other])
        if low[node] == index[node]:
            group = [stack.pop()]
            while group[-1] != node:
                group.append(stack.pop())
            if len(group) > 1:
                found.add(tuple(sorted(group)))

    for node in edges:
        if node not in index:
            visit(node)
    return found


def test_cycles_are_found() -> None:
    assert cycles({"a": {"b"}, "b": {"c"}, "c": {"a"}, "d": {"a", "e"}, "e": {"d"}, "f": {"a"}}) == {
        ("a", "b", "c"),
        ("d", "e"),
    }


def test_no_modules_import_each_other() -> None:
    assert cycles(graph()) == set()


def test_every_room_has_its_place_in_the_order() -> None:
    rooms = {room_of(module) for module in FILES} - set(PACKAGES)
    assert rooms - ORDER.keys() == set()


def test_rooms_import_only_lower_ones() -> None:
    upward = defaultdict(list)
    for module, others in graph().items():
        for other in others:
            rooms = room_of(module), room_of(other)
            if rooms[0] != rooms[1] and ORDER.get(rooms[1], (9, 9)) > ORDER.get(rooms[0], (-1, -1)):
                upward[rooms].append(f"{module} imports {other}")
    assert upward == {}


def test_rooms_of_the_corpus_import_only_lower_ones() -> None:
    def place(module: str) -> int:
        return CORPUS.index(module.split(".")[2])

    inside = {m: {o for o in others if within(o, ("encoders.corpus",))} for m, others in graph().items()}
    assert [
        f"{module} imports {other}"
        for module, others in inside.items()
        for other in others
        if within(module, ("encoders.corpus",)) and place(other) > place(module)
    ] == []


def test_packages_import_nothing_of_the_public_face_or_of_the_tests() -> None:
    outside = {"motionseek", "motionseek_main", "tests", "benchmarks"}
    wrong = [
        f"{module} imports {name}"
        for module, path in FILES.items()
        for name in imported(path)
        if name.split(".")[0] in outside
    ]
    assert wrong == []


def test_every_folder_says_what_lives_in_it_and_nothing_more() -> None:
    """One line that ends in a full stop; no imports, so that no name has two homes."""
    silent = [
        module
        for module, path in FOLDERS.items()
        if not (ast.get_docstring(parsed(path)) or "").split("\n")[0].endswith(".")
    ]
    assert silent == []
    assert [module for module, path in FOLDERS.items() if len(parsed(path).body) > 1] == []


def test_every_folder_of_modules_is_a_package() -> None:
    assert [module for module in MODULES if module.rpartition(".")[0] not in FOLDERS] == []


def test_no_two_modules_have_one_name() -> None:
    counted = Counter(module.split(".")[-1] for module in MODULES if not within(module, NAMED_AFTER_THEIR_TASK))
    assert [name for name, count in counted.items() if count > 1] == []


def test_no_two_public_classes_have_one_name() -> None:
    where = defaultdict(list)
    for module, path in MODULES.items():
        for node in parsed(path).body:
            if isinstance(node, ast.ClassDef) and not node.name.startswith("_"):
                where[node.name].append(module)
    assert {name: modules for name, modules in where.items() if len(modules) > 1} == {}


def test_no_folder_holds_too_many_modules() -> None:
    counted = Counter(module.rpartition(".")[0] for module in MODULES)
    assert {folder: count for folder, count in counted.items() if count > MOST_MODULES and folder not in FAMILIES} == {}


def test_only_training_imports_torch() -> None:
    wrong = [
        f"{module} imports {name}"
        for module, path in FILES.items()
        if not within(module, TRAINING)
        for name in imported(path)
        if name.split(".")[0] in {"torch", "safetensors", "onnx"}
    ]
    assert wrong == []


def test_what_needs_torch_is_imported_only_when_it_is_wanted() -> None:
    wrong = [
        f"{module} imports {name}"
        for module, path in FILES.items()
        if not within(module, TRAINING)
        for name in at_the_top(parsed(path))
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
    modules = ["motionseek", *(module for module in FILES if not within(module, TRAINING))]
    done = subprocess.run(
        [sys.executable, "-c", IMPORT_ALL, *modules], cwd=ROOT, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
