"""GrowingLibrary: clips that are added as arrays, without files."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING

from numpy.typing import ArrayLike

from encoders.motion import Motion
from indexer.store.clips import Caption
from indexer.store.stored_library import StoredLibrary

if TYPE_CHECKING:
    from indexer.ingest.arrays import NewClip


class GrowingLibrary(StoredLibrary):
    """A library to which clips are added and from which they are removed."""

    def add(
        self,
        id: str,
        motion: Motion | ArrayLike,
        captions: str | Caption | Sequence[str | Caption] = (),
        *,
        fps: float | None = None,
        up: str | None = None,
    ) -> int:
        """Add a motion as a clip, without any file; a clip of the same id is replaced. The clip's number.

        Parameters
        ----------
        id : str
            Its path in the library, such as "walk" or "session_1/walk".
        motion : Motion or array (T, 22, 3)
            A `Motion`, or joints in SMPL order in any unit and orientation.
        captions : str, Caption, or sequence of them
        fps : float, optional
            Frames a second of an array; 20 if not given.
        up : str, optional
            The axis that is up in an array, "x", "y", "z", "-x", "-y" or "-z"; found by itself if not given.
        """
        from indexer.ingest.arrays import NewClip

        return self.add_many([NewClip(id, motion, captions, fps, up)])[0]

    def add_many(self, clips: Iterable[NewClip]) -> list[int]:
        """Add clips as `add` does, encoded in batches; their numbers, in order.

        Where one is refused, the batches before it stay. Threads of one process wait for each other.

        Raises
        ------
        BundleError
            If the model's vectors are not unit vectors of its size.
        """
        from indexer.ingest import arrays

        return arrays.add(self._writable(), clips, self.bundle)

    def remove(self, *ids: str) -> None:
        """Remove clips that were added by `add` or `add_many`, all of them or none.

        Raises
        ------
        UnknownClip
            If an id names no such clip.
        """
        from indexer.ingest import arrays

        arrays.remove(self._writable(), ids)
