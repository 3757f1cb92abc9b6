"""Encode a library again, also with another model, from stored poses: no source file is opened."""

from __future__ import annotations

from collections.abc import Callable
from os import PathLike
from pathlib import Path

from encoders.errors import BundleMismatch, LibraryDamaged, LibraryError
from encoders.protocol import Encoder
from indexer.ingest.encode import encode, encode_captions, try_model
from indexer.store import models, poses
from indexer.store.library_reader import FILE
from indexer.store.schema import is_unfinished
from indexer.store.stored_library import StoredLibrary
from indexer.store.writer import Writer, writing

#: Clips encoded and committed at once.
CLIPS_A_BATCH = 32
_WITH_POSES = "FROM clips WHERE id IN (SELECT clip_id FROM poses)"


def reencode(
    library: str | PathLike[str],
    bundle: Encoder | None = None,
    *,
    progress: Callable[[int, int, str], None] | None = None,
) -> list[tuple[str, str]]:
    """Encode every clip and caption of a library again, also the clips whose files have gone.

    The old vectors are searched until the last new one is there, then all change at once. Ended early, a second call
    continues where the first one stopped.

    Parameters
    ----------
    library : path
        The library folder or the indexed folder.
    bundle : Encoder, optional
        The new model; if not given, that of the library, or the shipped one where that is not here any more.
    progress : callable, optional
        Called with clips done, clips to do and the last one's path.

    Returns
    -------
    list of (path, reason)
        The clips that cannot be encoded, as their poses are damaged. They keep what the same model made of them before.

    Raises
    ------
    LibraryError
        If there is no library, or it is being written by another process.
    """
    with StoredLibrary.open(library) as known:
        folder = known.folder
    if bundle is None:
        bundle = model_of(folder, rebuild=True)
    with writing(folder) as writer:
        try_model(writer, bundle)
        with writer.batch():
            model_id = models.begin_rebuild(writer.connection, folder, bundle)
        failed = _encode_clips(writer, bundle, model_id, progress)
        encode_captions(writer, bundle, model_id)
        with writer.batch():
            models.finish_rebuild(writer.connection, model_id, bundle)
    with StoredLibrary.open(folder, bundle=bundle) as made:
        made.prepare()
    return failed


def model_of(folder: Path, *, rebuild: bool = False) -> Encoder:
    """The model that the library in a folder was made with; the shipped one where there is none yet, or one only begun.

    Parameters
    ----------
    rebuild : bool
        Give the shipped one as well where the library's own is not here any more or cannot be made out.

    Raises
    ------
    BundleMismatch
        If it is not here, unless `rebuild`.
    LibraryError
        If the library cannot be read, unless `rebuild`.
    """
    from encoders.bundle.known_models import load_model

    if not (folder / FILE).is_file() or is_unfinished(folder / FILE):
        return load_model()
    with StoredLibrary.open(folder) as known:
        try:
            return known.bundle
        except (BundleMismatch, LibraryError):
            if not rebuild:
                raise
            return load_model()


def _encode_clips(
    writer: Writer, bundle: Encoder, model_id: int, progress: Callable[[int, int, str], None] | None
) -> list[tuple[str, str]]:
    """Vectors for every clip that has none under the model; the clips that cannot be encoded."""
    failed: list[tuple[str, str]] = []
    (total,) = writer.connection.execute(f"SELECT count(*) {_WITH_POSES}").fetchone()
    left = writer.connection.execute(
        f"SELECT id, clip_path {_WITH_POSES} AND id NOT IN (SELECT clip_id FROM embeddings WHERE model_id = ?) "
        "ORDER BY id",
        (model_id,),
    ).fetchall()
    for first in range(0, len(left), CLIPS_A_BATCH):
        batch = left[first : first + CLIPS_A_BATCH]
        motions = {}
        for clip_id, path in batch:
            try:
                motions[clip_id] = poses.read(writer.connection, clip_id)
            except LibraryDamaged as error:
                failed.append((path, str(error)))
        encoded = encode(bundle, list(motions.values())) if motions else []
        with writer.batch():
            for clip_id, vectors in zip(motions, encoded, strict=True):
                models.insert_vectors(writer.connection, clip_id, model_id, vectors)
        if progress is not None:
            progress(total - len(left) + first + len(batch), total, batch[-1][1])
    return failed
