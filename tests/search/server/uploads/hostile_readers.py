"""Readers of files that hang, crash or exhaust memory."""

from __future__ import annotations

import os
import time

from encoders.motion import Motion
from search.server.uploads.sandboxed_reader import limit_resources


def hangs(path: str, fps: float | None, joint_map: dict[str, str] | None) -> tuple[Motion, str]:
    """Never returns."""
    time.sleep(60)
    raise AssertionError


def crashes(path: str, fps: float | None, joint_map: dict[str, str] | None) -> tuple[Motion, str]:
    """Aborts the process."""
    os.abort()


def eats(path: str, fps: float | None, joint_map: dict[str, str] | None) -> tuple[Motion, str]:
    """Allocates more memory than the limit."""
    limit_resources()
    bytearray(1 << 40)
    raise AssertionError
