"""A library in numbers."""

from __future__ import annotations

import sqlite3
from pathlib import Path
from typing import Any

from indexer.store.clips import LIVE
from indexer.vectors.faiss_index import kind_of


def stats(db: sqlite3.Connection, folder: Path, roots: list[Path]) -> dict[str, Any]:
    """Counts of clips, their seconds, windows and captions, of files failed, gone or with warnings; and the model."""
    clips, seconds = db.execute(f"SELECT count(*), total(clips.duration) {LIVE}").fetchone()
    states = dict(db.execute("SELECT state, count(*) FROM files GROUP BY state").fetchall())
    model = db.execute(
        "SELECT id, name, fingerprint FROM models WHERE id = (SELECT value FROM settings WHERE key = 'model')"
    ).fetchone()
    gone = (  # a clip that was forgotten has no poses
        "SELECT count(*) FROM files WHERE state = 'gone' AND id IN "
        "(SELECT file_id FROM clips WHERE id IN (SELECT clip_id FROM poses))"
    )
    live = f"(SELECT clips.id {LIVE})"
    captions = f"SELECT count(*) FROM captions WHERE text_id IS NOT NULL AND clip_id IN {live}"
    windows = f"SELECT total(length(starts)) / 4 FROM windows WHERE model_id = ? AND clip_id IN {live}"
    window_count = int(db.execute(windows, (model[0],)).fetchone()[0]) if model else 0
    return {
        "folder": str(folder),
        "roots": [str(root) for root in roots],
        "clips": clips,
        "seconds": round(seconds, 3),
        "windows": window_count,
        "vector_index": {"clips": kind_of(clips), "windows": kind_of(window_count)},
        "captions": db.execute(captions).fetchone()[0],
        "failed": states.get("failed", 0),
        "gone": db.execute(gone).fetchone()[0],
        "with_warnings": db.execute(
            f"SELECT count(DISTINCT clips.file_id) {LIVE} AND clips.warnings != '[]'"
        ).fetchone()[0],
        "formats": _counted(db, "format"),
        "rigs": _counted(db, "rig"),
        "model": model[1] if model else None,
        "fingerprint": model[2] if model else None,
        "generation": db.execute("SELECT value FROM settings WHERE key = 'generation'").fetchone()[0],
        "bytes": sum(map(_size, folder.rglob("*"))),
    }


def _size(path: Path) -> int:
    try:
        return path.stat().st_size if path.is_file() else 0
    except FileNotFoundError:  # replaced by a writer since it was listed
        return 0


def _counted(db: sqlite3.Connection, column: str) -> dict[str, int]:
    """Clips by a column's value, the most frequent first."""
    return dict(db.execute(f"SELECT clips.{column}, count(*) {LIVE} GROUP BY 1 ORDER BY count(*) DESC, 1").fetchall())
