"""A trained TMR becomes a bundle: two ONNX graphs with small weights, a tokenizer and a manifest.

Matrices are stored as int8 and turned back to floating point when the graph is loaded, the embeddings of word pieces in
4 bits, of which only the rows that a sentence needs are turned back; activations are floating point throughout.
"""

from __future__ import annotations

import json
import shutil
import tempfile
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any, Literal

import numpy as np
import onnx
from numpy.typing import NDArray

from encoders.bundle.generator_files import DECODER
from encoders.bundle.manifest import CALIBRATION, FORMAT, MANIFEST, MOTION, TEXT, TOKENIZER, digest
from encoders.features.registry import FEATURE_KINDS
from encoders.tmr.conversion.decoder_graph import decoder_graph
from encoders.tmr.conversion.onnx_graph import motion_graph, text_graph
from encoders.tmr.model.network import Decoder, TransformerEncoder
from encoders.tmr.text.language_model import LanguageModel


def export_bundle(
    folder: Path,
    *,
    name: str,
    motion_encoder: TransformerEncoder,
    text_encoder: TransformerEncoder,
    language: LanguageModel,
    mean: NDArray[np.float32],
    std: NDArray[np.float32],
    feature_kind: str,
    max_frames: int,
    weights: Literal["int8", "float32"] = "int8",
    licence: str = "MIT",
    training: Mapping[str, Any] | None = None,
    calibration: Mapping[str, NDArray[Any]] | None = None,
    decoder: Decoder | None = None,
) -> Path:
    """Write a bundle; a bundle already in `folder` is replaced only when the new one is complete.

    Parameters
    ----------
    mean, std : (F,)
        Of the features; the motion graph takes raw features and normalises them.
    max_frames : int
        Longest motion, in feature frames, that passes the encoder as a whole.
    training : mapping of plain values
        What the manifest says about training.
    calibration : mapping of arrays
        Written as calibration.npz; changes no embedding.
    decoder : Decoder, optional
        Of a variational model: written as decoder.onnx, and text.onnx then gives variances beside the means, so that
        motions can be generated.
    """
    kind = FEATURE_KINDS[feature_kind]
    if np.shape(mean) != (kind.size,) or np.shape(std) != (kind.size,):
        raise ValueError(f"mean {np.shape(mean)} and std {np.shape(std)} must be ({kind.size},) for {feature_kind!r}")
    with replacing(Path(folder)) as new:
        new.mkdir()
        int8 = weights == "int8"
        onnx.save(motion_graph(motion_encoder, mean, std, int8=int8), new / MOTION)
        text = text_graph(text_encoder, language.network, language.max_tokens, int8=int8, variances=decoder is not None)
        onnx.save(text, new / TEXT)
        if decoder is not None:
            onnx.save(decoder_graph(decoder, mean, std, int8=int8), new / DECODER)
        (new / TOKENIZER).write_text(language.tokenizer.to_str(), "utf-8")
        if calibration is not None:
            np.savez_compressed(new / CALIBRATION, **calibration)  # type: ignore[arg-type]
        manifest = {
            "format": FORMAT,
            "name": name,
            "feature_kind": feature_kind,
            "fps": kind.fps,
            "max_frames": max_frames,
            "latent_size": motion_encoder.latent,
            "language_model": language.name,
            "max_tokens": language.max_tokens,
            "weights": weights,
            "licence": licence,
            "training": dict(training or {}),
            "files": {file.name: digest(file) for file in sorted(new.iterdir())},
        }
        (new / MANIFEST).write_text(json.dumps(manifest, indent=2, sort_keys=True) + "\n", "utf-8")
    return folder


@contextmanager
def replacing(folder: Path) -> Iterator[Path]:
    """The path of a new folder beside `folder`, whose place it takes at the end; if anything fails, nothing changes."""
    folder.parent.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(dir=folder.parent, prefix=f".{folder.name}-") as temporary:
        new = Path(temporary) / "new"
        yield new
        if folder.exists():
            folder.rename(Path(temporary) / "old")
        shutil.move(new, folder)
