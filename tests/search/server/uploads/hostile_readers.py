"""Readers of files that hang, crash or exhaust memory."""

from __future__ import annotations

import os
import time

from indexer.read_motion import ReadMotion
from search.server.uploads.sandboxed_reader import limit_resources


def hangs(path: str, fps: float | None, joint_map: dict[str, str] | None, up: str | None) -> list[ReadMotion]:
    """Never returns."""
    time.sleep(60)
    raise AssertionError


def crashes(path: str, fps: float | None, joint_map: dict[str, str] | None, up: str | None) -> list[ReadMotion]:
    """Aborts the process."""
    os.abort()


def eats(path: str, fps: float | None, joint_map: dict[str, str] | None, up: str | None) -> list[ReadMotion]:
    """Allocates more memory than the limit."""
    limit_resources()
    bytearray(1 << 40)
    raise AssertionError
