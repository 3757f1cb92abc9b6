"""The code blocks of a document, and a folder in which they run."""

from __future__ import annotations

import os
import re
import shlex
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import click
import pytest

from search.cli.main import cli, main
from tests.conftest import ROOT

PAGES = (ROOT / "README.md", ROOT / "CONTRIBUTING.md", ROOT / "CHANGELOG.md", *sorted((ROOT / "docs").glob("*.md")))
LANGUAGES = {"bash", "python", "json", "js", "text"}

#: Commands of documents that are parsed and not run, and why.
ONLY_PARSED = {
    "serve": "runs until it is ended",
    "evaluate": "asks for a labelled archive, or for minutes",
    "generate": "needs a model with a decoder",
    "model decoder": "needs torch, and an hour",
    "judge": "asks for motions of a generator",
    "model train": "needs torch, and hours",
    "model release": "needs finished runs",
    "model import": "needs a published run",
    "model calibrate": "takes minutes",
    "model card": "takes minutes",
    "index --fps": "would read every file again, at a wrong rate",
    "index --joint-map": "needs a rig of unknown names",
}
#: Programs other than `motionseek`, and why they are not run.
NOT_RUN = {
    "pip": "installs; `.ci/run` installs the wheel",
    "make": "sets up an environment; `.ci/run` runs the targets",
    ".venv/bin/python": "runs the tests",
}


@dataclass(frozen=True)
class Block:
    """A fenced code block: where it begins, its language, its text."""

    page: Path
    line: int
    language: str
    text: str

    def __str__(self) -> str:
        return f"{self.page.relative_to(ROOT)}:{self.line}"


def blocks(page: Path) -> list[Block]:
    text = page.read_text(encoding="utf-8")
    return [
        Block(page, text.count("\n", 0, found.start()) + 1, found[1], found[2])
        for found in re.finditer(r"^```(.*)\n((?:.*\n)*?)```$", text, re.MULTILINE)
    ]


def command_lines(block: Block) -> Iterator[list[str]]:
    """The arguments of each command; of a pipe its first. Variables set in the block are expanded."""
    variables: dict[str, str] = {}
    text = ""
    for line in block.text.replace("\\\n", " ").splitlines():
        text += line + "\n"
        try:
            words = shlex.split(text, comments=True)
        except ValueError:  # a quotation goes on in the next line
            continue
        text = ""
        name, is_assignment, value = words[0].partition("=") if words else ("", "", "")
        if is_assignment:
            variables[f"${name}"] = value
        elif words:
            command = [part for word in words for part in (variables[word].split() if word in variables else [word])]
            yield command[: command.index("|")] if "|" in command else command
    assert text == "", f"{block}: a quotation without end"


def is_only_parsed(arguments: list[str]) -> bool:
    """Whether the command, with all its words, is in the list."""
    return any(set(words.split()) <= set(arguments[1:]) for words in ONLY_PARSED)


def parse(arguments: list[str]) -> None:
    """Refuse commands and options that do not exist; whether files do is not looked at."""
    command: click.Command = cli
    names = arguments[1:]
    context = click.Context(cli)
    while isinstance(command, click.Group):
        found = command.get_command(context, names[0])
        assert found is not None, f"no command {names[0]}"
        command, names = found, names[1:]
    command.make_parser(click.Context(command)).parse_args(names)


def run_commands(block: Block) -> None:
    """Run the commands of a block in the working directory, which `cd` changes."""
    for arguments in command_lines(block):
        program = arguments[0]
        if program == "cd":
            os.chdir(arguments[1])
        elif program == "motionseek" and is_only_parsed(arguments):
            parse(arguments)
        elif program == "motionseek":
            with pytest.raises(SystemExit) as ended:
                main(arguments[1:])
            assert not ended.value.code, f"{block}: {shlex.join(arguments)} ended with {ended.value.code}"
        else:
            assert program in NOT_RUN, f"{block}: {program} is no program that documents run"


def run_page(page: Path, folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Run the blocks of a page in their order: commands where the last `cd` led, Python in the folder itself."""
    monkeypatch.delenv("MOTIONSEEK_LIBRARY", raising=False)
    monkeypatch.chdir(folder)
    shell, names = Path.cwd(), {"__name__": "__main__"}
    for block in blocks(page):
        if block.language == "bash":
            os.chdir(shell)
            run_commands(block)
            shell = Path.cwd()
        elif block.language == "python":
            os.chdir(folder)
            exec(compile(block.text, str(block), "exec"), names)
