"""A bundle with a generator beside its encoders, which stay as they are: the same fingerprint, the same libraries."""

from __future__ import annotations

import json
import shutil
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import onnx
from numpy.typing import NDArray

from encoders.bundle.generator_files import DECODER, LABELS, SENTENCES
from encoders.bundle.manifest import MANIFEST, digest, read_manifest
from encoders.tmr.conversion.decoder_graph import decoder_graph, gaussian_graph
from encoders.tmr.conversion.to_bundle import replacing
from encoders.tmr.model.normaliser import Normaliser
from encoders.tmr.synthesis.motion_vae import MotionVAE


def add_generator(
    source: Path,
    folder: Path,
    model: MotionVAE,
    normaliser: Normaliser,
    labels: tuple[list[str], NDArray[np.floating], NDArray[np.floating]],
    training: Mapping[str, Any],
) -> Path:
    """Write the bundle in `source` with the decoder of a trained generator as the bundle `folder`.

    A bundle already there is replaced only when the new one is complete; `source` may be the same folder.

    Parameters
    ----------
    labels : names of L labels, means (L, Z) and logarithms of variances (L, Z)
    training : mapping of plain values
        What the manifest says about it.
    """
    manifest = read_manifest(source)
    with replacing(folder) as new:
        new.mkdir(exist_ok=True)
        for name in manifest.files:
            shutil.copyfile(source / name, new / name)
        onnx.save(decoder_graph(model.motion_decoder, normaliser.mean, normaliser.std, int8=True), new / DECODER)
        onnx.save(gaussian_graph(model.text_gaussian, int8=True), new / SENTENCES)
        names, mu, logvar = labels
        np.savez_compressed(
            new / LABELS, names=np.array(names, np.str_), mu=mu.astype(np.float16), logvar=logvar.astype(np.float16)
        )
        values = dict(manifest.values) | {
            "generator": dict(training),
            "files": {file.name: digest(file) for file in sorted(new.iterdir())},
        }
        (new / MANIFEST).write_text(json.dumps(values, indent=2, sort_keys=True) + "\n", "utf-8")
    return folder
