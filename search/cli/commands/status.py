"""`motionseek status`: statistics of a library."""

from __future__ import annotations

from collections.abc import Callable

import click

from search.cli import options


@click.command()
@click.argument("place", metavar="[FOLDER]", required=False, type=click.Path(exists=True, file_okay=False))
@click.option("--failed", is_flag=True, help="List the files that could not be indexed, with reasons.")
@options.library
@options.as_json
def status(place: str | None, failed: bool, folder: str | None, as_json: bool) -> None:
    """Show statistics of the library of FOLDER.

    Without FOLDER, shows the nearest library here or in a parent folder.

    \b
    Examples:
      motionseek status my_mocap/
      motionseek status --failed
    """
    from search.cli import terminal

    with options.open_library(options.one_of(place, folder)) as library:
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
        return
    rows = [(name.replace("_", " "), shown(value)) for name, value in stats.items() if name not in _MEASURED]
    rows += [(name, measure(stats[key])) for key, (name, measure) in _MEASURED.items() if key in stats]
    terminal.table(("", ""), rows)


def time(seconds: float) -> str:
    """A duration in hours, or in minutes where it is short."""
    return f"{seconds / 3600:.1f} hours" if seconds >= 3600 else f"{seconds / 60:.1f} minutes"


#: Statistics that are shown in other units: key -> name, format.
_MEASURED: dict[str, tuple[str, Callable[[float], str]]] = {
    "seconds": ("motion", time),
    "bytes": ("on disk", lambda size: f"{size / 1e6:.1f} MB"),
}


def shown(value: object) -> str:
    """A statistic as text."""
    if isinstance(value, dict):
        return ", ".join(f"{key} {shown(item)}" for key, item in value.items())
    if isinstance(value, list | tuple):
        return ", ".join(shown(item) for item in value)
    if isinstance(value, bool) or value is None:
        return {True: "yes", False: "no", None: "none"}[value]
    return f"{value:,}" if isinstance(value, int) else str(value)
