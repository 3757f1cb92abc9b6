"""Small data sets in the layout of TMR's, written for tests."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

#: Caption, start and end in seconds.
Captions = Sequence[tuple[str, float, float]]


def write_dataset(
    root: Path,
    captions: Mapping[str, Captions],
    splits: Mapping[str, Sequence[str]],
    *,
    name: str = "toy",
    size: int = 263,
    fps: float = 20.0,
    seed: int = 0,
) -> Path:
    """Annotations, splits and random features of `size` numbers a frame, each motion as long as its captions go."""
    annotations: dict[str, Any] = {}
    rng = np.random.default_rng(seed)
    for key, rows in captions.items():
        path, duration = f"SYN/{key}", max(end for _, _, end in rows)
        annotations[key] = {
            "path": path,
            "duration": duration,
            "annotations": [
                {"seg_id": f"{key}_{i}", "text": text, "start": start, "end": end}
                for i, (text, start, end) in enumerate(rows)
            ],
        }
        file = root / "motions" / "guoh3dfeats" / f"{path}.npy"
        file.parent.mkdir(parents=True, exist_ok=True)
        np.save(file, rng.normal(size=(round(duration * fps), size)).astype(np.float32))
    folder = root / "annotations" / name
    (folder / "splits").mkdir(parents=True)
    (folder / "annotations.json").write_text(json.dumps(annotations), "utf-8")
    for split, keys in splits.items():
        (folder / "splits" / f"{split}.txt").write_text("".join(f"{key}\n" for key in keys), "utf-8")
    return root


def write_embeddings(folder: Path, sentences: Sequence[str], *, width: int = 8, seed: int = 0) -> None:
    """Token features of two to four tokens a sentence, and unit vectors, under the published names."""
    rng = np.random.default_rng(seed)
    lengths = rng.integers(2, 5, len(sentences))
    ends = np.cumsum(lengths)
    vectors = rng.normal(size=(len(sentences), 16)).astype(np.float32)
    arrays = {
        "token_embeddings/distilbert-base-uncased": rng.normal(size=(ends[-1], width)).astype(np.float32),
        "token_embeddings/distilbert-base-uncased_slice": np.stack([ends - lengths, ends], axis=1),
        "sent_embeddings/sentence-transformers/all-mpnet-base-v2": vectors
        / np.linalg.norm(vectors, axis=1, keepdims=True),
    }
    for name, array in arrays.items():
        file = folder / f"{name}.npy"
        file.parent.mkdir(parents=True, exist_ok=True)
        np.save(file, array)
        if not name.endswith("_slice"):
            index = json.dumps({sentence: row for row, sentence in enumerate(sentences)})
            file.with_name(f"{file.stem}_index.json").write_text(index, "utf-8")
