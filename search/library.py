"""Library: an indexed folder that answers questions."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from numpy.typing import ArrayLike

from encoders.arguments import checked_count, checked_flag, checked_span, unit_vector
from encoders.errors import ArgumentError
from indexer.store.library_reader import one_snapshot
from search.abilities.adding import GrowingLibrary
from search.abilities.answering import AnsweringLibrary
from search.abilities.exporting import ExportableLibrary
from search.abilities.marking import MarkedLibrary
from search.compose.timeline import TRANSITION, Timeline
from search.hits import Hits
from search.moments.one_motion import moments_of
from search.moments.queried_motion import QueriedMotion
from search.query.filters import FilterArguments, refuse_filters
from search.query.mixed import WEIGHT, checked_weight, difference_of, mixed
from search.query.question import EncodedQuestion, Question
from search.ranking.answers import checked_strength
from search.ranking.description import Description, describe_motion
from search.references import Ref, is_vector, span_of

# What only some methods need is imported there, so that `motionseek search` starts fast.
if TYPE_CHECKING:
    from typing_extensions import Unpack

    from search.compose.composition import Composition
    from search.moments.segments import Segment
    from search.stacks.stacking import Copy, Progress


class Library(AnsweringLibrary, ExportableLibrary, GrowingLibrary, MarkedLibrary):
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
        """The moments that answer a question, in one motion or anywhere in the library; see `moments`.

        Where nothing in the library matches the steps of a sentence, it is looked for as one.
        """
        k, least = checked_count(k), checked_strength(min_strength)
        if ref is None:
            library, allowed = self.narrowed(filters)
            hits = library._moment_hits(self.encode(question), k, least, allowed)
            if question.undivided and (not hits or hits.nothing_matches):
                # Steps that run into one another, "runs and then jumps", may be known as one movement alone.
                whole = library._moment_hits(self.encode(Question((question.undivided,))), k, least, allowed)
                return hits if not whole or whole.nothing_matches else whole
            return hits
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
        return library._aligned_hits(question, motion, k, least, allowed)

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

    def _vector(self, vector: Any, kind: str = "sentence") -> EncodedQuestion:
        """A query vector as a question."""
        return EncodedQuestion(unit_vector(vector, self.bundle.latent_size)[None], kind=kind)
