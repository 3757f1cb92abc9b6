"""Readers whose file has turned on them."""

from __future__ import annotations

import os
import time

from encoders.motion import Motion
from search.server.sandboxed_reader import _limit


def hangs(path: str, fps: float | None, joint_map: dict[str, str] | None) -> tuple[Motion, str]:
    """Never comes back."""
    time.sleep(60)
    raise AssertionError


def crashes(path: str, fps: float | None, joint_map: dict[str, str] | None) -> tuple[Motion, str]:
    """Ends at once."""
    os.abort()


def eats(path: str, fps: float | None, joint_map: dict[str, str] | None) -> tuple[Motion, str]:
    """Takes all the memory it can get."""
    _limit()
    bytearray(1 << 40)
    raise AssertionError
