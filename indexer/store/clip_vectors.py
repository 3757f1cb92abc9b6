"""The vectors of a clip under a model, and how they are stored."""

from __future__ import annotations

import sqlite3
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from encoders.bundle.windows import Windows


@dataclass(frozen=True)
class ClipVectors:
    """A clip's unit vector (D,) and its windows."""

    vector: NDArray[np.float16]
    windows: list[Windows]


def insert(db: sqlite3.Connection, clip_id: int, model_id: int, vectors: ClipVectors) -> None:
    """Store a clip's vectors under a model; it must have none there."""
    db.execute(
        "INSERT INTO embeddings(clip_id, model_id, vector) VALUES (?, ?, ?)",
        (clip_id, model_id, vectors.vector.tobytes()),
    )
    db.executemany(
        "INSERT INTO windows(clip_id, model_id, length, starts, vectors) VALUES (?, ?, ?, ?, ?)",
        [(clip_id, model_id, w.length, w.starts.tobytes(), w.vectors.tobytes()) for w in vectors.windows],
    )
