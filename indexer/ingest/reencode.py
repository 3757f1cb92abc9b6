"""Encode a library with another model, from stored poses: no source file is opened."""

from __future__ import annotations

from collections.abc import Callable
from os import PathLike

from encoders.protocol import Encoder
from indexer.ingest.encode import encode, encode_captions, use_model
from indexer.store.stored_library import StoredLibrary
from indexer.store.writer import Writer, writing

#: Clips encoded and committed at once.
CLIPS_A_BATCH = 32


def reencode(
    library: str | PathLike[str],
    bundle: Encoder | None = None,
    *,
    progress: Callable[[int, int, str], None] | None = None,
) -> int:
    """Encode every clip and caption of a library again; how many clips.

    The old vectors are searched until the last new one is there, then all change at once. Ended early, a second call
    continues where the first one stopped.

    Parameters
    ----------
    library : path
        The library folder or the indexed folder.
    bundle : Encoder, optional
        The new model; the default one if not given.
    progress : callable, optional
        Called with clips done, clips to do and the last one's path.

    Raises
    ------
    LibraryError
        If there is no library, its poses are damaged, or it is being written by another process.
    """
    if bundle is None:
        from encoders.bundle.bundle import Bundle

        bundle = Bundle.load()
    with StoredLibrary.open(library) as poses, writing(poses.folder) as writer:
        model_id = use_model(writer, bundle, current=False)
        total = _encode_clips(poses, writer, bundle, model_id, progress)
        encode_captions(writer, bundle, model_id)
        with writer.batch():
            writer.switch_model(model_id)
        folder = poses.folder
    with StoredLibrary.open(folder, bundle=bundle) as made:
        made.prepare()
    return total


def _encode_clips(
    library: StoredLibrary,
    writer: Writer,
    bundle: Encoder,
    model_id: int,
    progress: Callable[[int, int, str], None] | None,
) -> int:
    """Vectors for every clip that has none under the model; how many clips there are."""
    ids = library.ids()
    left = library.ids("clips.id NOT IN (SELECT clip_id FROM embeddings WHERE model_id = ?)", [model_id])
    for first in range(0, len(left), CLIPS_A_BATCH):
        batch = left[first : first + CLIPS_A_BATCH]
        encoded = encode(bundle, [library.motion(clip_id) for clip_id in batch])
        with writer.batch():
            for clip_id, vectors in zip(batch, encoded, strict=True):
                writer.put_vectors(int(clip_id), vectors, model_id)
        if progress is not None:
            done = len(ids) - len(left) + first + len(batch)
            progress(done, len(ids), library.clip(batch[-1]).path)
    return len(ids)
