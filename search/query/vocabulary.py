"""Short descriptions of everyday movement, for motions that nobody has described."""

from __future__ import annotations

from functools import cache
from pathlib import Path


@cache
def vocabulary() -> tuple[str, ...]:
    """The shipped sentences, one movement each."""
    lines = Path(__file__).with_name("vocabulary.txt").read_text(encoding="utf-8").splitlines()
    return tuple(line for line in lines if line)
