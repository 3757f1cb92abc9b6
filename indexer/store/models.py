"""The models of a library: whose vectors are searched, the vectors of a clip, and the exchange of all for new ones.

The changes run inside a batch of the writer.
"""

from __future__ import annotations

import sqlite3
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from encoders.bundle.windows import Windows
from encoders.errors import BundleError, BundleMismatch
from encoders.protocol import Encoder

#: Tables of vectors, and the column that says what each is of.
_OWNERS = {"embeddings": "clip_id", "windows": "clip_id", "text_embeddings": "text_id"}


@dataclass(frozen=True)
class ClipVectors:
    """A clip's unit vector (D,) and its windows."""

    vector: NDArray[np.float16]
    windows: list[Windows]


def check(db: sqlite3.Connection, folder: Path, bundle: Encoder, *, current: bool = True) -> None:
    """See that a model fits the library in `folder`; changes nothing.

    Raises
    ------
    BundleMismatch
        If `current` and the library holds the vectors of another model.
    BundleError
        If it holds vectors of another size of this one.
    """
    held = db.execute(
        "SELECT name, fingerprint FROM models WHERE id = (SELECT value FROM settings WHERE key = 'model')"
    ).fetchone()
    if current and held is not None and held[1] != bundle.fingerprint:
        raise BundleMismatch(
            f"{folder}: made with the model {held[0]} ({held[1][:12]}), not with {bundle.name} "
            f"({bundle.fingerprint[:12]}); index it again with rebuild=True (--rebuild)"
        )
    size = _size(db, bundle)
    if size not in (None, bundle.latent_size):
        raise BundleError(
            f"{bundle.name}: latent_size={bundle.latent_size}, but {folder} has vectors of {size} numbers "
            "of the same fingerprint; give another model another fingerprint"
        )


def is_known(db: sqlite3.Connection, bundle: Encoder) -> bool:
    """Whether the library has used this model before."""
    return _size(db, bundle) is not None


def _size(db: sqlite3.Connection, bundle: Encoder) -> int | None:
    row = db.execute("SELECT size FROM models WHERE fingerprint = ?", (bundle.fingerprint,)).fetchone()
    return None if row is None else int(row[0])


def use(db: sqlite3.Connection, folder: Path, bundle: Encoder) -> int:
    """The id of the model whose vectors are searched. See `check` for errors."""
    check(db, folder, bundle)
    model_id = _id(db, bundle.fingerprint, bundle)
    db.execute("INSERT OR IGNORE INTO settings(key, value) VALUES ('model', ?)", (model_id,))
    return model_id


def _id(db: sqlite3.Connection, fingerprint: str, bundle: Encoder) -> int:
    """The id under a fingerprint, new or known."""
    db.execute(
        "INSERT OR IGNORE INTO models(fingerprint, name, size) VALUES (?, ?, ?)",
        (fingerprint, bundle.name, bundle.latent_size),
    )
    return int(db.execute("SELECT id FROM models WHERE fingerprint = ?", (fingerprint,)).fetchone()[0])


def begin_rebuild(db: sqlite3.Connection, folder: Path, bundle: Encoder) -> int:
    """The id under which vectors are kept that are to take the place of all others; the same until they do."""
    check(db, folder, bundle, current=False)
    return _id(db, f"rebuild {bundle.fingerprint}", bundle)


def finish_rebuild(db: sqlite3.Connection, model_id: int, bundle: Encoder) -> None:
    """Search the vectors of `begin_rebuild` from now on; all others are removed.

    A clip that has none keeps those that the same model has made before.
    """
    same = db.execute("SELECT id FROM models WHERE fingerprint = ?", (bundle.fingerprint,)).fetchone()
    for table, owner in _OWNERS.items():
        if same is not None:
            db.execute(
                f"UPDATE {table} SET model_id = ? WHERE model_id = ? "
                f"AND {owner} NOT IN (SELECT {owner} FROM {table} WHERE model_id = ?)",
                (model_id, same[0], model_id),
            )
        db.execute(f"DELETE FROM {table} WHERE model_id != ?", (model_id,))
    db.execute("DELETE FROM models WHERE id != ?", (model_id,))
    db.execute("UPDATE models SET fingerprint = ? WHERE id = ?", (bundle.fingerprint, model_id))
    db.execute("INSERT OR REPLACE INTO settings(key, value) VALUES ('model', ?)", (model_id,))
    db.execute("UPDATE clips SET generation = (SELECT value FROM settings WHERE key = 'generation')")


def insert_vectors(db: sqlite3.Connection, clip_id: int, model_id: int, vectors: ClipVectors) -> None:
    """Store a clip's vectors under a model; it must have none there."""
    db.execute(
        "INSERT INTO embeddings(clip_id, model_id, vector) VALUES (?, ?, ?)",
        (clip_id, model_id, vectors.vector.tobytes()),
    )
    db.executemany(
        "INSERT INTO windows(clip_id, model_id, length, starts, vectors) VALUES (?, ?, ?, ?, ?)",
        [(clip_id, model_id, w.length, w.starts.tobytes(), w.vectors.tobytes()) for w in vectors.windows],
    )


def replace_vectors(db: sqlite3.Connection, clip_id: int, model_id: int, vectors: ClipVectors) -> None:
    """Store a clip's vectors under a model in place of what there was."""
    for table in ("embeddings", "windows"):
        db.execute(f"DELETE FROM {table} WHERE clip_id = ? AND model_id = ?", (clip_id, model_id))
    insert_vectors(db, clip_id, model_id, vectors)
    db.execute(
        "UPDATE clips SET generation = (SELECT value FROM settings WHERE key = 'generation') WHERE id = ?", (clip_id,)
    )
