"""SentenceCommand: a command that takes a sentence, and says so where its words come as arguments of their own."""

from __future__ import annotations

import re
import shlex
from itertools import takewhile
from pathlib import Path

import click


class SentenceCommand(click.Command):
    """A command whose arguments are a sentence, and perhaps a clip."""

    def parse_args(self, ctx: click.Context, args: list[str]) -> list[str]:
        ctx.allow_extra_args = True
        given_args = list(args)
        try:
            extra = super().parse_args(ctx, args)
        except (click.NoSuchOption, click.BadParameter):
            if _takes_away(given_args):
                raise click.UsageError(_quoted_minus(ctx, given_args), ctx) from None
            raise
        if extra:
            arguments = [p.name for p in self.params if isinstance(p, click.Argument) and p.name]
            given = [ctx.params[name] for name in arguments if ctx.params[name]]
            raise click.UsageError(_advice(ctx, [*given, *extra]), ctx)
        return extra


def _advice(ctx: click.Context, words: list[str]) -> str:
    """What to type instead of words of which a sentence was wanted: a folder among them is the library's."""
    folders = [word for word in words if Path(word).is_dir()]
    takes_library = any("--library" in parameter.opts for parameter in ctx.command.params)
    if len(folders) != 1 or len(words) == 1 or not takes_library:
        return f"put the sentence in quotes: {quoted(ctx, words)}"
    rest = [word for word in words if word not in folders]
    return f"name the library with --library: {quoted(ctx, rest)} --library {shlex.quote(folders[0])}"


def _takes_away(args: list[str]) -> bool:
    """Whether one of the arguments is a "-word" of a sentence, which is no option."""
    return any(re.match(r"-[^\W\d_]{2}", arg) for arg in args)


def _quoted_minus(ctx: click.Context, args: list[str]) -> str:
    """How a sentence with a "-word" is given, as far as it comes before the options."""
    options = {option for parameter in ctx.command.params for option in parameter.opts}
    sentence = " ".join(takewhile(lambda arg: not arg.startswith("--") and arg not in options, args))
    if sentence.startswith("-"):
        return f'put -- before a sentence that begins with a minus: {ctx.command_path} [OPTIONS] -- "{sentence}"'
    return f'put the sentence in quotes: {ctx.command_path} "{sentence}"'


def quoted(ctx: click.Context, words: list[str]) -> str:
    """The command line in which words are one sentence; files among them come after it."""
    from indexer.formats.opening import is_file

    files = [word for word in words if is_file(Path(word))]
    sentence = " ".join(word for word in words if word not in files)
    return " ".join([ctx.command_path, f'"{sentence}"', *files])
