"""Library: an indexed folder that answers questions."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from functools import cached_property, lru_cache
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from encoders.arguments import (
    checked_count,
    checked_flag,
    checked_number,
    checked_path,
    checked_span,
    unit_vector,
)
from encoders.errors import ArgumentError
from encoders.motion import FPS, Motion
from encoders.protocol import TokenEncoder
from indexer.argument_checks import checked_rate, checked_up
from indexer.store.clips import Caption, Clip
from indexer.store.library_reader import one_snapshot
from search.compose.timeline import TRANSITION, Timeline
from search.hits import Hit, Hits
from search.marking import MarkedLibrary
from search.moments.across_library import answers_in_candidates, moments_across
from search.moments.one_motion import clip_answer, moments_of
from search.moments.queried_motion import QueriedMotion
from search.query.filters import FilterArguments, Filters, refuse_filters
from search.query.mixed import WEIGHT, checked_weight, difference_of, mixed
from search.query.question import EncodedQuestion, Question
from search.ranking.alignment import RERANKED, rerank_by_alignment
from search.ranking.answers import Answer, as_hits, checked_strength
from search.ranking.batched import batched
from search.ranking.by_amounts import ranked_by_amounts
from search.ranking.clip_scores import ClipScore, ExactGallery, best_clips, rank_by_window, rank_clips
from search.ranking.description import Description, describe_motion
from search.ranking.late_interaction import rerank_by_tokens
from search.ranking.text_matches import TextMatch, fused, text_matches
from search.references import Ref, is_vector, source_of, span_of
from search.source import MotionSource

# What only some methods need is imported there, so that `motionseek search` starts fast.
if TYPE_CHECKING:
    from typing_extensions import Unpack

    from indexer.ingest.arrays import NewClip
    from search.compose.composition import Composition
    from search.moments.segments import Segment
    from search.stacks.stacking import Copy, Progress

Ids = NDArray[np.int64]

#: Clips read at once, and of those found, whose moments are looked for.
_CHUNK, _REFINED = 1000, 10
#: Filters whose clips are cached: of a million clips at most 8 MB each.
_FILTERS = 16


class Library(MarkedLibrary):
    """A library of motions that answers questions. Safe to share between threads.

    Searches answer with at most `k` hits, best first, of at least `min_strength` ("weak", "plausible" or "strong"). If
    it is not given, weak ones are left out where the first is better. They take filters as keyword arguments, which
    choose the clips to search in: `min_duration` and `max_duration` in seconds, `path` (a pattern such as "fights/*"),
    `rig`, `format`, `captioned` (True or False), `split`, and of what people have marked `starred` (True or False),
    `tag`, `collection`.

    A reference `ref` is a file; a clip of the library by path (after its root's name, where there are several), name or
    "#number"; a `Clip`, a `Hit`, a `Motion`, or an array of joints (T, 22, 3) with its frame rate `fps` (default 20).
    `fps` and `up`, the axis that is up ("x", "y", "z", "-x", "-y" or "-z"), overrule what a file says.
    Where a method takes `start` and `end`, in seconds, a hit stands for its span; elsewhere for its whole clip.

    All errors are below `MotionSeekError`. Every method raises `ArgumentError`, which names the argument, for a value
    of a wrong type or out of range; `UnknownClip` or `UnreadableMotion` where a reference means no clip or no readable
    file; `QueryError` where a sentence is empty or a span is empty, outside the motion or too short to compare; and
    `BundleMismatch` where the library holds the vectors of another model. What changes the library raises
    `LibraryLocked` while another process does.
    """

    #: Whether the poses of the clips are at hand.
    has_poses = True

    def clips(self, sort: str | None = None, **filters: Unpack[FilterArguments]) -> Iterator[Clip]:
        """The clips, read in chunks, so that memory does not grow with the library.

        Parameters
        ----------
        sort : str, optional
            "name", "longest", "shortest" or "newest"; in order of their numbers if not given.
        """
        allowed = self.allowed(**filters)
        if sort is not None:
            return self._chunks(self.sorted_among(sort, allowed))
        return super().clips() if allowed is None else self._chunks(allowed)

    def sorted_among(self, sort: str, allowed: Ids | None) -> Ids:
        """Those of some ids, or of all, that are clips, by an order of `clips`."""
        ids = self.sorted_ids(sort)
        return ids if allowed is None else ids[np.isin(ids, allowed)]

    def _chunks(self, ids: Ids) -> Iterator[Clip]:
        for first in range(0, len(ids), _CHUNK):
            yield from self.clips_by_id(ids[first : first + _CHUNK].tolist()).values()

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

    @one_snapshot
    def search(
        self,
        query: str | ArrayLike,
        k: int = 10,
        *,
        like: Ref | None = None,
        start: float | None = None,
        end: float | None = None,
        weight: float = WEIGHT,
        min_strength: str | None = None,
        exact: bool = False,
        **filters: Unpack[FilterArguments],
    ) -> Hits:
        """The clips that fit a sentence best, each with the moment that does, the first of its `moments`.

        Clips whose names, folders, captions, tags or collections have its words are found as well; see `Hit.matched`.

        Parameters
        ----------
        query : str or array (D,) or (1, D)
            A sentence, or a vector of the model's space, of any length, such as one of `Encoder.encode_texts`.
        like : optional
            A motion that they shall be like, too: "like this but slower".
        start, end : float, optional
            The span of that motion in seconds; all of it, or that of a hit, by default.
        weight : float
            How much of the question is the sentence, 0 to 1; the rest is the motion.
        exact : bool
            Compare every vector of a large library, which is otherwise searched by clusters that may miss a few.
        """
        if like is not None:
            checked_flag("exact", exact)
            span = span_of(like, start, end)
            return self._search_like(query, like, span, k, checked_weight(weight), min_strength, exact, filters)
        if start is not None or end is not None:
            raise ArgumentError("start and end are a span of like, which is not given")
        question = self.encode(Question.of(query, split_steps=False)) if isinstance(query, str) else self._vector(query)
        return self.search_encoded(question, k, min_strength=min_strength, exact=exact, **filters)

    def _search_like(
        self,
        query: str | ArrayLike,
        like: Ref,
        span: tuple[float | None, float | None],
        k: int,
        weight: float,
        min_strength: str | None,
        exact: bool,
        filters: FilterArguments,
    ) -> Hits:
        if not isinstance(query, str):
            raise ArgumentError("like goes with a sentence, and a vector is given")
        source, text = self.source(like), difference_of(query)
        vector = self.bundle.encode_motions([source.cut(*span)])[0]
        question = mixed(self.encode(Question.of(text, split_steps=False)), vector, weight)
        library, allowed = self.narrowed(filters, without=source.clip_id)
        return library._clip_hits(question, checked_count(k), checked_strength(min_strength), allowed, exact=exact)

    @one_snapshot
    def search_encoded(
        self,
        question: EncodedQuestion,
        k: int = 10,
        *,
        min_strength: str | None = None,
        exact: bool = False,
        **filters: Unpack[FilterArguments],
    ) -> Hits:
        """The clips that fit a question that is encoded already; see `search`."""
        k, least, exact = checked_count(k), checked_strength(min_strength), checked_flag("exact", exact)
        library, allowed = self.narrowed(filters)
        return library._clip_hits(question, k, least, allowed, exact=exact)

    @one_snapshot
    def moments(
        self,
        text: str | None,
        ref: Ref | None = None,
        k: int = 10,
        *,
        then: Sequence[str] = (),
        meanwhile: Sequence[str] = (),
        split_steps: bool = True,
        min_strength: str | None = None,
        fps: float | None = None,
        up: str | None = None,
        **filters: Unpack[FilterArguments],
    ) -> Hits:
        """The moments at which a sentence happens: in one motion, or anywhere in the library.

        Parameters
        ----------
        text : str or None
            A sentence; None where `then` or `meanwhile` say all.
        ref : optional
            The motion to search in; without one, the whole library, where filters may be given.
        then : sequence of str
            Steps that follow, where the sentence does not state them itself ("walks, then sits down").
        meanwhile : sequence of str
            What happens at the same time.
        split_steps : bool
            Whether a sentence that states steps is split into them.
        """
        question = Question.of(text, then, meanwhile, split_steps=split_steps)
        return self.answer(question, ref, k, min_strength=min_strength, fps=fps, up=up, **filters)

    @one_snapshot
    def answer(
        self,
        question: Question,
        ref: Ref | None = None,
        k: int = 10,
        *,
        min_strength: str | None = None,
        fps: float | None = None,
        up: str | None = None,
        **filters: Unpack[FilterArguments],
    ) -> Hits:
        """The moments that answer a question, in one motion or anywhere in the library; see `moments`."""
        k, least = checked_count(k), checked_strength(min_strength)
        if ref is None:
            library, allowed = self.narrowed(filters)
            return library._moment_hits(self.encode(question), k, least, allowed)
        refuse_filters(filters)
        source = self.source(ref, fps=fps, up=up)
        return moments_of(QueriedMotion(self.bundle, source, self.encode(question)), k, least)

    def encode(self, question: Question) -> EncodedQuestion:
        """The question with its query vectors."""
        return question.encode(self.bundle)

    @one_snapshot
    def describe(
        self,
        ref: Ref,
        k: int = 5,
        start: float | None = None,
        end: float | None = None,
        *,
        fps: float | None = None,
        up: str | None = None,
    ) -> list[Description]:
        """The sentences that fit a motion, or a span of it, best: the library's captions and the shipped vocabulary.

        Returns
        -------
        list of Description
            Pairs (sentence, score) with their `strength`; best first, no sentence twice. The score is a cosine less
            what is taken from sentences near every motion.
        """
        captions, _, vectors = self.caption_vectors()
        motion = self._cut(ref, start, end, fps, up)
        return describe_motion(self.bundle, motion, checked_count(k), captions, vectors)

    @one_snapshot
    def segment(
        self,
        ref: Ref,
        labels: Sequence[str] | None = None,
        *,
        captions: bool = False,
        fps: float | None = None,
        up: str | None = None,
    ) -> list[Segment]:
        """Label a motion from beginning to end.

        Parameters
        ----------
        labels : sequence of str, optional
            The labels; the shipped vocabulary if not given.
        captions : bool
            Take the library's captions as labels.

        Returns
        -------
        list of Segment
            In order and without gaps; the label is empty where none fits.
        """
        from search.moments.segments import segment_motion

        if checked_flag("captions", captions) and labels is not None:
            raise ArgumentError("labels and captions=True exclude each other; give one")
        given = sorted(set(self.caption_vectors()[0])) if captions else labels
        return segment_motion(self.bundle, self.source(ref, fps=fps, up=up), given)

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
            Frames a second of what is written.
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

    @one_snapshot
    def similar(
        self,
        ref: Ref | list[float],
        k: int = 10,
        start: float | None = None,
        end: float | None = None,
        *,
        moments: bool = False,
        min_strength: str | None = None,
        fps: float | None = None,
        up: str | None = None,
        **filters: Unpack[FilterArguments],
    ) -> Hits:
        """The clips, or with `moments` the spans, most like a motion or a span of it; never from the clip itself.

        Parameters
        ----------
        ref
            A reference, or a vector (D,) or (1, D) of the model's space, such as one of `Encoder.encode_motions`.
        """
        k, moments, least = checked_count(k), checked_flag("moments", moments), checked_strength(min_strength)
        library, allowed = self.narrowed(filters)
        if isinstance(ref, list) or is_vector(ref):
            if (start, end, fps, up) != (None, None, None, None):
                raise ArgumentError("start, end, fps and up are for motions, and a vector is given")
            question = self._vector(ref, kind="motion")
            if moments:
                return library._moment_hits(question, k, least, allowed)
            return library._clip_hits(question, k, least, allowed)
        source, (start, end) = self.source(ref, fps=fps, up=up), checked_span(*span_of(ref, start, end))
        motion = source.comparable_cut(start, end)
        # A span that is a whole clip of the library means the clip; of a file, --start 0 means that it is a cut.
        is_whole_clip = source.clip_id >= 0 and motion.duration > source.duration - 0.5 / motion.fps
        is_cut = (start, end) != (None, None) and not is_whole_clip
        question = EncodedQuestion(self.bundle.encode_motions([motion]), kind="motion")
        if source.clip_id >= 0:
            library, allowed = self.narrowed(filters, without=source.clip_id)
        if moments:
            return library._moment_hits(question, k, least, allowed)
        if is_cut:  # most often a part of what it is like
            return library._clip_hits(question, k, least, allowed, by_window=True)
        found = best_clips(library, question.vectors[0], max(k, RERANKED), allowed=allowed, whole_share=1.0)
        ranked = rerank_by_alignment(self.bundle, self, motion, found)
        sources = self._sources([score.clip_id for score in ranked])
        named = [(sources[score.clip_id], score) for score in ranked if score.clip_id in sources]
        answers = [Answer(source, s.moment(source.duration), (s.score,)) for source, s in named]
        return as_hits(self.bundle, question, answers, k, least)

    def duplicates(
        self, *, progress: Progress | None = None, **filters: Unpack[FilterArguments]
    ) -> list[tuple[Copy, ...]]:
        """The stacks: clips that show one performance, in several rigs, from several files, or mirrored.

        They are told by how the joints move. The first call on a library reads all poses; later ones only what changed.

        Parameters
        ----------
        progress : callable, optional
            Called with how much is done, and how much there is to do.

        Returns
        -------
        list of tuples of Copy
            Each of two clips and more, in order of their numbers: `clip_id`, and whether it is the first one
            `mirrored`. Of clips that do not pass the filters nothing is said.
        """
        from search.stacks.stacking import among, stacks

        allowed = self.allowed(**filters)
        return stacks(self, progress) if allowed is None else among(stacks(self, progress), allowed)

    @one_snapshot
    def compose(
        self,
        timeline: Timeline,
        *,
        samples: int = 1,
        seed: int = 0,
        after: Ref | None = None,
        transition: float = TRANSITION,
        **filters: Unpack[FilterArguments],
    ) -> list[Composition]:
        """Motions for a time line of sentences, made of the library's clips; see `search.compose`.

        Parameters
        ----------
        timeline : Timeline
            Sentences with their seconds and body parts.
        samples, seed : int
            How many different motions, the best first, and what chooses those after it.
        after : optional
            A motion that comes before the time line.
        transition : float
            Seconds in which one piece goes over into the next.
        """
        from search.compose.composition import compose

        before = None if after is None else self.source(after).motion
        library, allowed = self.narrowed(filters)
        return compose(
            timeline, library, samples=samples, seed=seed, after=before, transition=transition, allowed=allowed
        )

    def source(self, ref: Ref, *, fps: float | None = None, up: str | None = None) -> MotionSource:
        """The motion that a reference means, with what the library knows of it."""
        return source_of(ref, self, fps=checked_rate(fps), up=checked_up(up))

    @one_snapshot
    def allowed(self, **filters: Unpack[FilterArguments]) -> Ids | None:
        """The ids of the clips that pass the filters, sorted; None for all. Recent ones are cached: do not change."""
        return self._passing(self.state, Filters.of(filters))

    @cached_property
    def _passing(self) -> Callable[[object, Filters], Ids | None]:
        return lru_cache(_FILTERS)(lambda state, filters: filters.ids(self))

    def narrowed(self, filters: FilterArguments, *, without: int = -1) -> tuple[Library, Ids | None]:
        """What is searched where filters are given and one clip is left out: a library, and the ids as of `allowed`."""
        allowed = self.allowed(**filters)
        if without < 0:
            return self, allowed
        return self, np.setdiff1d(self.ids() if allowed is None else allowed, [without])

    def text_matches(self, sentence: str, allowed: Ids | None) -> Mapping[int, TextMatch]:
        """The clips that have the words of a sentence in their names, folders, captions, tags or collections."""
        return text_matches(self, self.bundle, sentence, allowed=allowed)

    def _cut(self, ref: Ref, start: float | None, end: float | None, fps: float | None, up: str | None) -> Motion:
        return self.source(ref, fps=fps, up=up).cut(*checked_span(*span_of(ref, start, end)))

    def _vector(self, vector: Any, kind: str = "sentence") -> EncodedQuestion:
        """A query vector as a question."""
        return EncodedQuestion(unit_vector(vector, self.bundle.latent_size)[None], kind=kind)

    def _clip_hits(
        self,
        question: EncodedQuestion,
        k: int,
        least: str | None,
        allowed: Ids | None,
        *,
        by_window: bool = False,
        exact: bool = False,
    ) -> Hits:
        """With `by_window` clips are ranked by their best window alone."""
        matches = self.text_matches(" ".join(question.wanted), allowed)

        def answers() -> Iterator[Answer]:
            if by_window:
                ranked = rank_by_window(self, question.vectors[0], allowed=allowed)
            else:
                ranked = self._ranked(question, allowed, matches, exact)
            for batch in batched(ranked, _REFINED):
                sources = self._sources([score.clip_id for score in batch])
                for score in (score for score in batch if score.clip_id in sources):
                    motion = QueriedMotion(self.bundle, sources[score.clip_id], question)
                    matched = matches[score.clip_id].places if score.clip_id in matches else ()
                    yield clip_answer(motion, score.score)._replace(matched=matched)

        ranked = ranked_by_amounts(question, answers()) if self.has_poses else answers()
        return as_hits(self.bundle, question, ranked, k, least)

    def _ranked(
        self, question: EncodedQuestion, allowed: Ids | None, matches: Mapping[int, TextMatch], exact: bool
    ) -> Iterator[ClipScore]:
        query, encoder = question.vectors[0], self.bundle
        ranked = rank_clips(ExactGallery(self) if exact else self, query, allowed=allowed)
        takes_away = question.wanted != question.sentences  # which token vectors would bring back
        if isinstance(encoder, TokenEncoder) and len(question.sentences) == 1 and self.has_poses and not takes_away:
            ranked = rerank_by_tokens(encoder, self, question.sentences[0], ranked)
        if not matches:
            return ranked
        by_text = best_clips(self, query, len(matches), allowed=np.array(sorted(matches), np.int64))
        return fused(ranked, by_text, matches)

    def _moment_hits(self, question: EncodedQuestion, k: int, least: str | None, allowed: Ids | None) -> Hits:
        if question.how == "alone":
            answers = moments_across(self.bundle, self, self._source_of, question, allowed=allowed)
        else:
            answers = answers_in_candidates(self.bundle, self, self._sources, question, allowed=allowed)
        ranked = ranked_by_amounts(question, answers) if self.has_poses else answers
        return as_hits(self.bundle, question, ranked, k, least)

    def _source_of(self, clip_id: int) -> MotionSource:
        return MotionSource.of_clip(self, self.clip(clip_id))

    def _sources(self, ids: Iterable[int]) -> dict[int, MotionSource]:
        return {id: MotionSource.of_clip(self, clip) for id, clip in self.clips_by_id(ids).items()}
