"""Progress of work that takes a while, on stderr and only where that is a terminal."""

from __future__ import annotations

import sys
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager

#: Seconds before work is said to go on: most answers are there before.
_PATIENCE = 1.0
#: Seconds between two looks at the clock.
_TICK = 0.25


@contextmanager
def progress_bar(unit: str = "files") -> Iterator[Callable[[int, int, str], None]]:
    """A progress bar with rate and remaining time; call what it yields with what is done, the total and a path."""
    from rich.console import Console
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

    columns = (BarColumn(), MofNCompleteColumn(), TextColumn("{task.fields[rate]}"), TimeRemainingColumn())
    console = Console(stderr=True)
    if not console.is_terminal:
        yield lambda done, total, path: None
        return
    with Progress(*columns, console=console, transient=True) as shown:
        task = shown.add_task("", total=None, rate="")

        def update(done: int, total: int, path: str) -> None:
            speed = shown.tasks[0].speed
            shown.update(task, completed=done, total=total, rate=f"{speed:.1f} {unit}/s" if speed else "")

        yield update


@contextmanager
def working(what: str) -> Iterator[None]:
    """Say after a second what is being done, and for how long; the line is gone when it ends."""
    if not sys.stderr.isatty():
        yield
        return
    ended = threading.Event()
    line = threading.Thread(target=_tell, args=(what, ended), daemon=True)
    line.start()
    try:
        yield
    finally:
        ended.set()
        line.join()


def _tell(what: str, ended: threading.Event) -> None:
    begun = time.monotonic()
    if ended.wait(_PATIENCE):
        return
    while not ended.wait(_TICK):
        print(f"\r{what} ... {time.monotonic() - begun:.0f} s", end="\x1b[K", file=sys.stderr, flush=True)
    print("\r", end="\x1b[K", file=sys.stderr, flush=True)
