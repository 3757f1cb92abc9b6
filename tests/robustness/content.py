"""What a library holds and answers, to compare two of them."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from encoders.protocol import Encoder
from indexer.ingest import indexing
from indexer.store.library_reader import FOLDER
from indexer.store.marks import marks_table
from indexer.store.marks.marks_table import COLLECTION, STAR, TAG
from indexer.store.stored_library import StoredLibrary
from indexer.store.writer import writing
from tests.indexer.folders import SmallBundle, write

#: The captions of a folder, as a table, and after it was changed.
TABLE = "path,text\ntake 2.npy,someone runs\ntake 3.npy,a person walks\n"


def make(folder: Path, clips: int = 8) -> Path:
    """Index a folder of takes with captions; one is longer than a chunk of poses."""
    for seed in range(clips):
        write(folder / f"take {seed}.npy", seed, seconds=12.0 if seed == 3 else 4.0)
    (folder / "take 1.txt").write_text("a person walks\n")
    (folder / "captions.csv").write_text(TABLE)
    indexing.index(folder, bundle=SmallBundle(), jobs=1)
    with writing(folder / FOLDER) as writer, writer.batch():
        for kind, name, ids in ((STAR, "", (1, 5)), (TAG, "fight", (2, 5)), (COLLECTION, "reel", (3,))):
            marks_table.add(writer.connection, ids, kind, name)
    return folder


def change(folder: Path) -> None:
    """Add, change, move and remove takes and captions, as a day's work does."""
    for seed in range(8, 13):
        write(folder / f"take {seed}.npy", seed)
    write(folder / "take 0.npy", 50, seconds=5.0)
    (folder / "set").mkdir()
    (folder / "take 4.npy").rename(folder / "set" / "take 4.npy")
    (folder / "take 5.npy").unlink()
    (folder / "take 1.txt").write_text("a person limps\n")
    (folder / "captions.csv").write_text(TABLE.replace("runs", "jumps") + "take 9.npy,he sits down\n")


def content(folder: Path, bundle: Encoder) -> dict[str, Any]:
    """All that a user sees, by the clips' paths: captions, poses, vectors, and the answers to some questions.

    Numbers of clips and generations are left out: a run that was cut off gives others.
    """
    rng = np.random.default_rng(1)
    queries = rng.standard_normal((3, bundle.latent_size)).astype(np.float32)
    queries /= np.linalg.norm(queries, axis=1, keepdims=True)
    with StoredLibrary.open(folder, bundle=bundle) as library, library.reading():
        clips = {clip.id: clip for clip in library.clips()}
        texts, owners, rows = library.caption_vectors()
        found = {
            "captions": sorted((c.path, [x.document() for x in library.captions(c.id)]) for c in clips.values()),
            "marks": {clip.path: library.marks(clip.id).document() for clip in clips.values()},
            "poses": {clip.path: library.motion(clip.id).joints for clip in clips.values()},
            "nearest": [[clips[i].path for i in row] for row in library.nearest_clips(queries, 1)[1].tolist()],
            "best": library.nearest_windows(queries, 5)[0],  # of windows alike, any may come first
            "caption vectors": {(text, clips[i].path): row for text, i, row in zip(texts, owners, rows, strict=True)},
        }
        for clip in clips.values():
            for windows in library.windows(clip.id):
                found[f"{clip.path}, {windows.length:g} s"] = np.column_stack([windows.starts, windows.vectors])
    return found


def differences(a: Any, b: Any, what: str = "") -> list[str]:
    """Where two contents differ. Vectors may in their last digit: other batches are added up in another order."""
    if isinstance(a, dict) and isinstance(b, dict):
        missing = [f"{what} {key}: only in one" for key in a.keys() ^ b.keys()]
        return missing + [line for key in a.keys() & b.keys() for line in differences(a[key], b[key], f"{what} {key}")]
    if isinstance(a, np.ndarray) and isinstance(b, np.ndarray):
        same = a.shape == b.shape and np.allclose(a, b, rtol=0, atol=2e-3)
    else:
        same = a == b
    return [] if same else [f"{what}: differs"]
