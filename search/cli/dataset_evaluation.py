"""What `motionseek evaluate` does with a captioned data set: find its parts, the model's and the sentences', and print.

A bundle encodes captions itself. A run directory has no language model: its tokens come from the data set's stored
features, or from a language model by folder or name.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from importlib.util import find_spec
from itertools import chain
from pathlib import Path
from typing import TYPE_CHECKING, TypeVar

from encoders.errors import BundleError, QueryError
from encoders.features.registry import FeatureKind, feature_kind
from search.cli import terminal
from search.cli.commands.model.train import require_extra
from search.cli.progress import progress_bar
from search.evaluate.retrieval import retrieval_tables
from search.evaluate.retrieval.dataset_retrieval import EvaluatedModel, SentenceSimilarity, evaluate_dataset

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from encoders.protocol import Encoder
    from encoders.tmr.conversion.from_published import PublishedData
    from indexer.datasets.captioned_dataset import CaptionedDataset

T = TypeVar("T")


@dataclass(frozen=True)
class DatasetChoice:
    """The data set, and what of it was named on the command line.

    Attributes
    ----------
    sentence_model, language_model : str or None
        The name of stored embeddings, or a folder with a language model.
    """

    place: Path
    split: str
    motions: Path | None = None
    fps: float | None = None
    sentence_model: str | None = None
    language_model: str | None = None
    stats: Path | None = None

    def open(self, kind: FeatureKind) -> CaptionedDataset:
        """The data set, its motions as features of a kind."""
        from indexer.datasets.captioned_dataset import CaptionedDataset

        return CaptionedDataset.open(self.place, kind, motions=self.motions, fps=self.fps)


def print_retrieval(choice: DatasetChoice, encoder: Encoder | None, run: Path | None, format: str) -> None:
    """Evaluate an encoder, or a run, and print the report."""
    if run is not None:
        dataset, model = _of_run(choice, run)
    else:
        assert encoder is not None
        dataset, model = choice.open(kind_of(encoder)), EvaluatedModel.of_encoder(encoder)
    sentences = sentence_model(dataset, choice)
    with progress_bar("motions") as show:
        report = evaluate_dataset(
            dataset, choice.split, model, sentences, progress=lambda done, total: show(done, total, "")
        )
    if format == "json":
        terminal.document(report.as_dict())
    elif format == "csv":
        print(retrieval_tables.as_csv(report), end="")
    elif format == "latex":
        print(retrieval_tables.as_latex(report), end="")
    else:
        terminal.table(
            retrieval_tables.COLUMNS,
            retrieval_tables.table_rows(report),
            right=("gallery", *retrieval_tables.FIGURES),
        )
        for line in retrieval_tables.summary(report):
            terminal.note(line)


def print_moments(choice: DatasetChoice, encoder: Encoder, as_json: bool) -> None:
    """Search for the captions of parts of motions, beside the paper's windows, and print Markdown tables."""
    from search.evaluate.annotated_takes import dataset_moments
    from search.evaluate.moment_retrieval import evaluate_moments
    from search.evaluate.moment_tables import moment_tables

    dataset = choice.open(kind_of(encoder))
    takes = _at_least_one(
        dataset_moments(dataset, choice.split),
        f"{dataset.folder}: no caption of the split "
        f"{choice.split!r} is about a part of its motion; moments are searched in data sets such as BABEL",
    )
    figures = evaluate_moments(takes, encoder, plain_windows=True, progress=every_tenth)
    name = f"{encoder.name} on {dataset.name}, split {choice.split}"
    if as_json:
        terminal.document({name: figures})
    else:
        print(f"### {name}", *moment_tables(figures), sep="\n\n")


def every_tenth(takes: int) -> None:
    """Say of every tenth take that it is done."""
    if takes % 10 == 0:
        terminal.note(f"{takes} takes done")


def _at_least_one(items: Iterator[T], none: str) -> Iterator[T]:
    """The items, at least one; raises QueryError with `none` where there is none."""
    first = next(items, None)
    if first is None:
        raise QueryError(none)
    return chain([first], items)


def kind_of(encoder: Encoder) -> FeatureKind:
    """The feature kind of an encoder; of one that alone knows its features, a kind that no array is of."""
    try:
        return feature_kind(encoder.feature_kind)
    except BundleError:
        return FeatureKind(encoder.feature_kind, 0, encoder.fps, encoder.features)


def sentence_model(dataset: CaptionedDataset, choice: DatasetChoice) -> SentenceSimilarity | None:
    """Sentence embeddings for the threshold: those named, else stored ones, else the packaged language model's.

    Raises
    ------
    BundleError
        If what is named is neither stored, nor a folder, nor to be had from the hub.
    """
    from indexer.datasets.text_embeddings import StoredSentences

    named = choice.sentence_model
    stored = StoredSentences.open(dataset.folder, named)
    texts = [entry.captions[0].text for entry in dataset.split(choice.split)]
    if stored is not None and stored.has(texts):
        return SentenceSimilarity(stored.name, stored.rows)
    if named is not None:
        require_extra("a sentence model")
    elif not (all(find_spec(name) for name in ("torch", "safetensors")) and _has_packaged_model()):
        return None
    from encoders.tmr.text.hub import load_language

    language = load_language() if named is None else load_language(named)
    return SentenceSimilarity(language.name, language.embed)


def _of_run(choice: DatasetChoice, run: Path) -> tuple[CaptionedDataset, EvaluatedModel]:
    require_extra("a run directory")
    from encoders.tmr.conversion.from_published import read_data
    from encoders.tmr.conversion.import_run import kind_of_run
    from encoders.tmr.conversion.run_encoder import RunEncoder

    data = read_data(run)
    dataset = choice.open(kind_of_run(run, data))
    encoder = RunEncoder.load(run, choice.stats or _statistics(run, data, dataset))
    language_model = choice.language_model or data.language_model

    def encode(captions: list[str]) -> NDArray[np.float32]:
        return encoder.encode_token_features(token_features(dataset, language_model, captions))

    return dataset, EvaluatedModel(encoder.name, encoder.encode_features, encode)


def _statistics(run: Path, data: PublishedData, dataset: CaptionedDataset) -> Path:
    """The folder of a run's statistics: the one that its configuration names, else that of the data set."""
    from encoders.tmr.conversion.import_run import statistics_of_run

    try:
        return statistics_of_run(run, data)
    except BundleError:
        if dataset.stats is None:
            raise
        return dataset.stats


def token_features(dataset: CaptionedDataset, name: str, captions: Sequence[str]) -> Sequence[NDArray[np.floating]]:
    """Token features of captions by a language model: stored ones, else by the model of that folder or name.

    Raises
    ------
    BundleError
        If there is no such model.
    """
    from encoders.tmr.text.hub import load_language
    from indexer.datasets.text_embeddings import StoredTokens

    stored = StoredTokens.open(dataset.folder, name)
    if stored is not None and stored.has(captions):
        return stored.rows(captions)
    return load_language(name).token_features(captions)


def _has_packaged_model() -> bool:
    from encoders.tmr.text.language_model import packaged_folder

    try:
        packaged_folder()
    except BundleError:
        return False
    return True
