"""A large library simulated around a small real one, and queries to it.

Every clip is a real one, its vectors moved a little, so that the windows a clip has, and how alike they are, are real.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

from indexer.store import schema
from indexer.store.files import INDEXED
from indexer.store.library_reader import FILE
from indexer.store.read_options import ReadOptions
from indexer.store.stored_library import StoredLibrary
from indexer.vectors.library_indexes import CLIPS
from search.query.vocabulary import vocabulary

MANNERS = (
    "", "slowly", "quickly", "carefully", "happily", "angrily", "like an old man", "while looking around", "twice",
    "three times", "to the left", "to the right", "forward", "backwards", "and stops", "and turns around",
    "with the left hand", "with the right hand", "in a circle", "again and again",
)  # fmt: skip
_BATCH = 2000
_CAPTIONED = 0.3


def simulate(folder: Path, around: Path, count: int, noise: float, seed: int = 0, *, poses: bool = False) -> None:
    """Write a library of `count` clips that resemble those of another one, in the library's own format.

    With `poses` they have the poses of the real ones, else none.
    """
    rng = np.random.default_rng(seed)
    with StoredLibrary.open(around) as real:
        clips = [(clip, real.windows(clip.id)) for clip in real.clips_by_id(real.ids().tolist()).values()]
        with real.reading() as connection:
            rows = real.indexes.current(CLIPS, connection).rows
            chunks: dict[int, list[tuple[int, bytes]]] = {}
            for owner, chunk, data in connection.execute("SELECT clip_id, chunk, data FROM poses") if poses else ():
                chunks.setdefault(owner, []).append((chunk, data))
        whole = dict(zip(rows.owners.tolist(), rows.vectors, strict=True))
        model = real._model()
    assert model is not None
    StoredLibrary.open(folder, create=True).close()
    sentences = all_sentences()
    db = schema.connect(folder / FILE, writable=True)

    def moved(vectors: np.ndarray, by: np.ndarray) -> bytes:
        near = vectors.astype(np.float32) + by + noise / 2 / 16 * rng.standard_normal(vectors.shape, np.float32)
        return (near / np.linalg.norm(near, axis=-1, keepdims=True)).astype(np.float16).tobytes()

    with schema.transaction(db):
        db.execute("INSERT INTO roots(id, path) VALUES (1, '..')")
        db.execute(
            "INSERT INTO models(id, fingerprint, name, size) VALUES (1, ?, ?, ?)",
            (model["fingerprint"], model["name"], model["size"]),
        )
        db.execute("INSERT INTO settings VALUES ('model', 1)")
        db.execute("UPDATE settings SET value = 1 WHERE key = 'generation'")
        db.execute(
            "INSERT OR REPLACE INTO generations VALUES (1, ?)", (seed + 1,)
        )  # else no index is taken for its own
        db.executemany("INSERT INTO texts(id, text) VALUES (?, ?)", enumerate(sentences, 1))
    for first in range(0, count, _BATCH):
        with schema.transaction(db):
            for i in range(first + 1, min(first + _BATCH, count) + 1):
                clip, windows = clips[rng.integers(len(clips))]
                by = noise / 16 * rng.standard_normal(model["size"], np.float32)
                path = f"take {i // 1000:03}/{clip.name} {i}.bvh"
                db.execute(
                    "INSERT INTO files(id, root_id, path, size, mtime_ns, hash, recipe, state, reason) "
                    "VALUES (?, 1, ?, 0, 0, ?, ?, ?, NULL)",
                    (i, path, str(i), ReadOptions().text(), INDEXED),
                )
                values = (i, i, path, clip.format, clip.rig, clip.fps, clip.frames, clip.duration, clip.added, path)
                db.execute(
                    "INSERT INTO clips(id, file_id, name, format, rig, fps, frames, duration, added, clip_path, "
                    "generation) VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?, ?, 1)",
                    values,
                )
                db.execute(
                    "INSERT INTO embeddings(clip_id, model_id, vector) VALUES (?, 1, ?)", (i, moved(whole[clip.id], by))
                )
                db.executemany(
                    "INSERT INTO windows(clip_id, model_id, length, starts, vectors) VALUES (?, 1, ?, ?, ?)",
                    [(i, w.length, w.starts.tobytes(), moved(w.vectors, by)) for w in windows],
                )
                db.executemany(
                    "INSERT INTO poses(clip_id, chunk, data) VALUES (?, ?, ?)",
                    [(i, chunk, data) for chunk, data in chunks.get(clip.id, ())],
                )
                if rng.random() < _CAPTIONED:
                    text = int(rng.integers(len(sentences))) + 1
                    db.execute("INSERT INTO captions(clip_id, text_id) VALUES (?, ?)", (i, text))
    db.close()


def all_sentences() -> list[str]:
    """Some thousand distinct sentences, shuffled."""
    sentences = list(dict.fromkeys(f"{sentence} {manner}".strip() for sentence in vocabulary() for manner in MANNERS))
    return [str(sentence) for sentence in np.random.default_rng(1).permutation(sentences)]


def asked(count: int, seed: int) -> list[str]:
    """Queries drawn by Zipf's law: the n-th most frequent with a probability proportional to 1 / n."""
    sentences = all_sentences()
    chance = 1 / np.arange(1, len(sentences) + 1)
    drawn = np.random.default_rng(seed).choice(len(sentences), count, p=chance / chance.sum())
    return [sentences[i] for i in drawn]
