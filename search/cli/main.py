"""The entry point: runs a command and turns exceptions into one line on stderr and an exit code.

Exit codes: 0 success, 1 failure, 2 wrong usage, 130 interrupted, 141 broken pipe.
"""

from __future__ import annotations

import difflib
import io
import os
import re
import sys
import warnings
from importlib import import_module

import click

from encoders.errors import MotionSeekError, MotionSeekWarning, QueryError

#: Command -> its module, which is imported when the command is run; --help lists them in this order.
COMMANDS = {
    "index": "search.cli.commands.index",
    "search": "search.cli.commands.search",
    "moments": "search.cli.commands.moments",
    "describe": "search.cli.commands.describe",
    "similar": "search.cli.commands.similar",
    "segment": "search.cli.commands.segment",
    "export": "search.cli.commands.files.export",
    "compose": "search.cli.commands.files.compose",
    "render": "search.cli.commands.files.render",
    "serve": "search.cli.commands.serve",
    "status": "search.cli.commands.status",
    "check": "search.cli.commands.maintenance",
    "forget": "search.cli.commands.maintenance",
    "list": "search.cli.commands.list",
    "duplicates": "search.cli.commands.duplicates",
    "tag": "search.cli.commands.tag",
    "evaluate": "search.cli.commands.evaluate",
    "model": "search.cli.commands.model.group",
    "judge": "search.cli.commands.generated.judge",
    "generate": "search.cli.commands.generated.generate",
    "demo": "search.cli.commands.demo",
}
#: What other programs call a command.
_SYNONYMS = {
    "find": "search",
    "query": "search",
    "ask": "search",
    "ls": "list",
    "rm": "forget",
    "remove": "forget",
    "delete": "forget",
    "add": "index",
    "scan": "index",
    "update": "index",
    "info": "status",
    "stats": "status",
    "verify": "check",
    "repair": "check",
    "cut": "export",
    "convert": "export",
    "plot": "render",
    "show": "render",
    "play": "serve",
    "web": "serve",
    "label": "describe",
}


class Commands(click.Group):
    """A group that imports its commands lazily and suggests one for a mistyped name."""

    def list_commands(self, ctx: click.Context) -> list[str]:
        return list(COMMANDS)

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:
        if cmd_name not in COMMANDS:
            return None
        command: click.Command = getattr(import_module(COMMANDS[cmd_name]), cmd_name)
        return command

    def resolve_command(
        self, ctx: click.Context, args: list[str]
    ) -> tuple[str | None, click.Command | None, list[str]]:
        name = args[0]
        if name in COMMANDS or name.startswith("-"):
            return super().resolve_command(ctx, args)
        close = [_SYNONYMS[name]] if name in _SYNONYMS else difflib.get_close_matches(name, COMMANDS, n=1)
        hint = f"did you mean '{close[0]}'?" if close else f"the commands are {', '.join(COMMANDS)}"
        raise click.UsageError(f"no command '{name}'; {hint}", ctx)

    def parse_args(self, ctx: click.Context, args: list[str]) -> list[str]:
        try:
            return super().parse_args(ctx, args)
        except click.NoSuchOption as error:
            name = error.option_name
            message = f"no option '{name}' here; options come after the command, as in 'motionseek search ... {name}'"
            raise click.UsageError(message, ctx) from None


@click.group(cls=Commands, context_settings={"help_option_names": ["-h", "--help"], "max_content_width": 100})
@click.version_option(package_name="motionseek", message="%(prog)s %(version)s")
@click.option("--debug", is_flag=True, help="Show the traceback of an error.")
def cli(debug: bool) -> None:
    """The search engine for human motion: search motion capture by describing it in words.

    \b
    Examples:
      motionseek index my_mocap/
      motionseek search "a person limps to the left"
      motionseek moments "sits down" long_take.bvh --plot sits.png
      motionseek describe take_017.bvh
    """


def main(arguments: list[str] | None = None) -> None:
    """Run the command line and exit with its code."""
    given = sys.argv[1:] if arguments is None else arguments
    _open_streams()
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("always", MotionSeekWarning)
            warnings.showwarning = _show_warning
            code = _run([a for a in given if a != "--debug"], debug="--debug" in given)
        sys.stdout.flush()
    except BrokenPipeError:
        # The reader closed the pipe; redirect stdout so that the interpreter's last flush raises nothing, either.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        code = 141
    sys.exit(code)


def _run(arguments: list[str], *, debug: bool) -> int:
    """Run a command; returns the exit code. With `debug`, exceptions propagate."""
    try:
        # Not cli.main: it has its own format for errors and treats a broken pipe as a failure.
        with cli.make_context("motionseek", arguments) as ctx:
            code = cli.invoke(ctx)
        return code if isinstance(code, int) else 0
    except click.exceptions.Exit as ended:
        return ended.exit_code
    except click.exceptions.NoArgsIsHelpError as error:
        click.echo(error.format_message())
        return 0
    except BrokenPipeError:
        raise
    except (KeyboardInterrupt, click.Abort):
        return _fail("motionseek: interrupted", 130)
    except click.ClickException as error:
        return _fail(_usage_line(error), error.exit_code)
    except Exception as error:
        if _was_interrupted(error):
            return _fail("motionseek: interrupted", 130)
        if debug:
            raise
        if isinstance(error, (MotionSeekError, OSError)):
            return _fail(f"motionseek: {_one_line(error)}", 2 if isinstance(error, QueryError) else 1)
        named = f"unexpected {type(error).__name__}: {_one_line(error)}"
        return _fail(f"motionseek: {named}; run again with --debug and report the traceback", 1)


def _was_interrupted(error: BaseException | None) -> bool:
    """Whether an error comes of Ctrl-C: a module that is interrupted in its import raises an error of its own."""
    seen: list[BaseException] = []  # what retries raise may be its own context
    while error is not None and error not in seen:
        if isinstance(error, KeyboardInterrupt):
            return True
        seen.append(error)
        error = error.__cause__ or error.__context__
    return False


def _show_warning(message: Warning | str, category: type[Warning], *place: object, **more: object) -> None:
    """Print a warning in one line to stderr, without the place in the code."""
    click.echo(f"motionseek: {_one_line(message)}", err=True)


def _fail(line: str, code: int) -> int:
    click.echo(line, err=True)
    return code


def _open_streams() -> None:
    """Replace missing standard streams, and escape characters that their encoding lacks."""
    for name in ("stdout", "stderr"):
        stream = getattr(sys, name)
        if stream is None:
            setattr(sys, name, open(os.devnull, "w", encoding="utf-8"))  # noqa: SIM115  open until the process ends
        elif isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="backslashreplace")


def _usage_line(error: click.ClickException) -> str:
    """The error in one line; a usage error refers to --help."""
    ctx: click.Context | None = getattr(error, "ctx", None)
    command = ctx.command_path if ctx else "motionseek"
    message = re.sub(r"(?<=[\w\"')])\.$", "", _one_line(error.format_message()))  # but not the folder "."
    return (
        f"{command}: {message}; see '{command} --help'"
        if isinstance(error, click.UsageError)
        else f"{command}: {message}"
    )


def _one_line(error: object) -> str:
    if isinstance(error, OSError) and error.strerror:
        return f"{error.filename}: {error.strerror.lower()}" if error.filename else error.strerror.lower()
    return " ".join(str(error).split())
