"""SentenceCommand: a command that takes a sentence, and says so where its words come as arguments of their own."""

from __future__ import annotations

from pathlib import Path

import click


class SentenceCommand(click.Command):
    """A command whose arguments are a sentence, and perhaps a clip."""

    def parse_args(self, ctx: click.Context, args: list[str]) -> list[str]:
        ctx.allow_extra_args = True
        extra = super().parse_args(ctx, args)
        if extra:
            arguments = [p.name for p in self.params if isinstance(p, click.Argument) and p.name]
            given = [ctx.params[name] for name in arguments if ctx.params[name]]
            raise click.UsageError(f"put the sentence in quotes: {quoted(ctx, [*given, *extra])}", ctx)
        return extra


def quoted(ctx: click.Context, words: list[str]) -> str:
    """The command line in which words are one sentence; files among them come after it."""
    from indexer.formats.opening import is_file

    files = [word for word in words if is_file(Path(word))]
    sentence = " ".join(word for word in words if word not in files)
    return " ".join([ctx.command_path, f'"{sentence}"', *files])
