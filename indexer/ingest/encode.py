"""Motions and captions become vectors, which are checked before they are stored."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from encoders.bundle.windows import encode_grids
from encoders.errors import BundleError
from encoders.motion import Motion
from encoders.protocol import Encoder
from encoders.skeleton import BONE_LENGTHS, PARENTS, RAW_OFFSETS
from indexer.store import captions, models
from indexer.store.models import ClipVectors
from indexer.store.writer import Writer

_TEXTS_A_BATCH = 512
#: How far from 1 the length of a unit vector may be in half precision.
_TOLERANCE = 1e-2

Captions = list[tuple[int, str]]


def use_model(writer: Writer, encoder: Encoder) -> int:
    """The id of a model in the library; see `models.use`.

    One that is new there is tried first; see `try_model`.

    Raises
    ------
    BundleError
        If its vectors are not unit vectors of its `latent_size`.
    BundleMismatch
        If the library holds the vectors of another model.
    """
    models.check(writer.connection, writer.folder, encoder)
    try_model(writer, encoder)
    with writer.batch():
        return models.use(writer.connection, writer.folder, encoder)


def try_model(writer: Writer, encoder: Encoder) -> None:
    """Encode a motion and a sentence with a model that is new to the library.

    Raises
    ------
    BundleError
        If its vectors are not unit vectors of its `latent_size`.
    """
    if not models.is_known(writer.connection, encoder):
        encode(encoder, [_trial()])
        _encode_texts(encoder, ["a person stands"])


def encode(bundle: Encoder, motions: Sequence[Motion]) -> list[ClipVectors]:
    """The vectors of motions and of their windows; all of them go through the model together, sorted by length.

    Raises
    ------
    BundleError
        If they are not unit vectors of the model's size.
    """
    features = [bundle.features(motion) for motion in motions]
    vectors = _checked(bundle, "motions", bundle.encode_features(features), len(motions))
    windows = encode_grids(bundle, features, [motion.duration for motion in motions])
    for part in (part for parts in windows for part in parts):
        _checked(bundle, "windows", part.vectors, len(part.starts))
    return [ClipVectors(*both) for both in zip(vectors, windows, strict=True)]


def encode_captions(writer: Writer, encoder: Encoder, model_id: int) -> None:
    """Vectors for the captions that have none under a model, in batches of their own.

    Raises
    ------
    BundleError
        If they are not unit vectors of the model's size.
    """
    for part in captions_without_vectors(writer, model_id):
        with writer.batch():
            insert_caption_vectors(writer, encoder, model_id, part)


def captions_without_vectors(writer: Writer, model_id: int) -> Iterator[Captions]:
    """Ids and texts of the captions that have no vectors under a model, in parts that are encoded together."""
    texts = captions.texts_without_vectors(writer.connection, model_id)
    for first in range(0, len(texts), _TEXTS_A_BATCH):
        yield texts[first : first + _TEXTS_A_BATCH]


def insert_caption_vectors(writer: Writer, encoder: Encoder, model_id: int, part: Captions) -> None:
    """Encode captions and store their vectors, inside a batch of the writer; see `encode_captions`."""
    vectors = _encode_texts(encoder, [text for _, text in part])
    captions.insert_text_vectors(writer.connection, model_id, [text_id for text_id, _ in part], vectors)


def _encode_texts(encoder: Encoder, texts: list[str]) -> NDArray[np.float16]:
    return _checked(encoder, "captions", encoder.encode_texts(texts), len(texts))


def _checked(encoder: Encoder, what: str, vectors: Any, count: int) -> NDArray[np.float16]:
    """Vectors (N, D) in half precision, once they have proved to be unit vectors."""
    shape = (count, encoder.latent_size)
    if not isinstance(vectors, np.ndarray) or vectors.dtype.kind != "f" or vectors.shape != shape:
        given = f"{vectors.dtype} {vectors.shape}" if isinstance(vectors, np.ndarray) else type(vectors).__name__
        raise BundleError(f"{encoder.name}: vectors of {what} must be an array of real numbers {shape}, not {given}")
    lengths = np.linalg.norm(vectors.astype(np.float64), axis=-1)
    if not (np.abs(lengths - 1) < _TOLERANCE).all():
        raise BundleError(f"{encoder.name}: vectors of {what} must be finite and of length 1")
    return vectors.astype(np.float16)


def _trial() -> Motion:
    """Two seconds of standing with straight arms."""
    offsets, joints = RAW_OFFSETS * BONE_LENGTHS[:, None], np.zeros((len(PARENTS), 3))
    for joint, parent in enumerate(PARENTS):
        if parent >= 0:
            joints[joint] = joints[parent] + offsets[joint]
    return Motion(np.tile(joints - [0, joints[:, 1].min(), 0], (40, 1, 1)))
