"""`motionseek status`: what a library holds."""

from __future__ import annotations

import click

from search.commands import options


@click.command()
@click.option("--failed", is_flag=True, help="List the files that could not be indexed, with the reason.")
@options.library
@options.as_json
def status(failed: bool, folder: str | None, as_json: bool) -> None:
    """Show what the library holds.

    \b
    Examples:
      motionseek status
      motionseek status --failed --library my_mocap
    """
    from search import terminal

    with options.open_library(folder) as library:
        if failed:
            failures = library.failures()
            if as_json:
                terminal.document({"failed": [{"path": path, "reason": reason} for path, reason in failures]})
            else:
                terminal.table(("file", "reason"), failures)
            return
        stats = library.stats()
    if as_json:
        terminal.document(stats)
    else:
        terminal.table(("", ""), [(name.replace("_", " "), shown(value)) for name, value in stats.items()])


def shown(value: object) -> str:
    """A statistic as a person reads it."""
    if isinstance(value, dict):
        return ", ".join(f"{key} {shown(item)}" for key, item in value.items())
    if isinstance(value, list | tuple):
        return ", ".join(shown(item) for item in value)
    return f"{value:,.1f}" if isinstance(value, float) else str(value)
