"""ExportableLibrary: motions of a library as files and pictures."""

from __future__ import annotations

from collections.abc import Sequence
from os import PathLike
from pathlib import Path

from encoders.arguments import checked_count, checked_flag, checked_number, checked_path, checked_span
from encoders.errors import ArgumentError
from encoders.motion import FPS
from indexer.store.library_reader import one_snapshot
from search.abilities.selecting import SelectableLibrary
from search.hits import Hit
from search.references import Ref, span_of


class ExportableLibrary(SelectableLibrary):
    """A library whose motions are written and drawn."""

    @one_snapshot
    def export(
        self,
        ref: Ref,
        out: str | PathLike[str],
        start: float | None = None,
        end: float | None = None,
        *,
        fps: float | None = None,
        up: str | None = None,
        to_fps: float | None = None,
        in_place: bool = False,
        rig: str | PathLike[str] | None = None,
        overwrite: bool = False,
    ) -> Path:
        """Write a motion, or a span of it, to a .bvh, .glb, .npz or .npy file; its path.

        A .bvh keeps rig and frame rate of a source that has a rig, and of a .bvh file its numbers; anything else has
        the 22 joints. Where a file is gone or has changed since it was indexed, the library's poses are written, with
        a `MotionSeekWarning`.

        Parameters
        ----------
        to_fps : float, optional
            Frames a second of what is written; a .npy has always 20.
        in_place : bool
            Leave out the way that the hips travel over the floor, as loops need it.
        rig : path, optional
            A file on whose skeleton a .bvh is written.
        """
        from search.export.cut import RATES, writable, write_cut

        place, like = writable(out, overwrite), None if rig is None else checked_path("rig", rig)
        rate = None if to_fps is None else checked_number("to_fps", to_fps)
        if rate is not None and not RATES[0] <= rate <= RATES[1]:
            raise ArgumentError(f"to_fps={rate:g} must be from {RATES[0]:g} to {RATES[1]:g}")
        span = checked_span(*span_of(ref, start, end))
        flag = checked_flag("in_place", in_place)
        write_cut(self.source(ref, fps=fps, up=up), place, *span, fps=rate, in_place=flag, rig=like)
        return place

    @one_snapshot
    def export_hits(
        self, hits: Sequence[Hit], folder: str | PathLike[str], format: str = "bvh", *, overwrite: bool = False
    ) -> list[Path]:
        """Write the span of each hit as a file into a folder, with a table, `hits.csv`; the paths of the files.

        `credits.txt` holds what the folders of the sources say about credits and terms, where they do.

        Parameters
        ----------
        format : str
            "bvh", which keeps the rig of a source that has one, "glb", "npz" or "npy".
        """
        from search.export.hit_files import export_hits

        if not all(isinstance(hit, Hit) for hit in hits):
            raise ArgumentError("hits must be hits, as search and moments give them")
        place, flag = checked_path("folder", folder), checked_flag("overwrite", overwrite)
        return export_hits(hits, place, format, library=self, overwrite=flag)

    def render(
        self,
        ref: Ref,
        out: str | PathLike[str],
        start: float | None = None,
        end: float | None = None,
        *,
        size: int = 480,
        fps: float = FPS,
        up: str | None = None,
        overwrite: bool = False,
    ) -> Path:
        """Draw a motion, or a span of it, to a .png (a strip of poses), .gif or .mp4 (an animation); its path.

        Parameters
        ----------
        size : int
            Height in pixels.
        fps : float
            Frames a second of the animation. An array to draw is at 20; give another as a `Motion` with its own.

        Raises
        ------
        MissingProgram
            If there is no ffmpeg for an .mp4.
        """
        from search.drawing.film import write_picture
        from search.export.cut import writable

        place = writable(out, overwrite)
        motion = self._cut(ref, start, end, None, up)
        write_picture(motion, place, size=checked_count(size, "size"), fps=checked_number("fps", fps))
        return place
