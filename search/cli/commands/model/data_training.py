"""`motionseek model train --data`: TMR's recipe on a captioned data set. Needs the extra `train`."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

import click

from encoders.errors import MissingSplit
from search.cli import options
from search.cli.path_types import FOLDER

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from encoders.tmr.text.token_features import TokenTable
    from encoders.tmr.training.captioned_clips import CaptionedClips, TextFeatures
    from encoders.tmr.training.tmr_recipe import TMRRecipe
    from indexer.datasets.captioned_dataset import CaptionedDataset
    from indexer.datasets.timed_captions import CaptionedEntry

T = TypeVar("T")

#: The name of the recipe that --data trains by.
TMR_RECIPE = "tmr"
_OPTIONS = (
    click.option("--data", type=FOLDER, help="A captioned data set, to train on by TMR's recipe."),
    click.option("--motions", type=FOLDER, help="With --data: the folder of its motions."),
    click.option("--stats", type=FOLDER, help="With --data: folder of mean.pt and std.pt."),
    click.option("--features", metavar="KIND", default="humanml3d", show_default=True, help="With --data: their kind."),
    click.option("--language-model", metavar="NAME|DIR", help="With --data: stored tokens, a folder, or on the hub."),
    click.option("--sentence-model", metavar="NAME|DIR", help="With --data: of the similarity of captions, likewise."),
    click.option("--epochs", type=options.Count(1), help="With --data: epochs in all. [default: 500]"),
    click.option("--device", metavar="cpu|cuda", help="With --data. [default: cuda where there is one]"),
    options.fps,
)


def data_options(command: Callable[..., Any]) -> Callable[..., Any]:
    """Adds the options that go with --data; the command gets them as `**of_data`."""
    for option in reversed(_OPTIONS):
        command = option(command)
    return command


@dataclass(frozen=True)
class DataTraining:
    """What `data_options` were given."""

    data: Path | None
    motions: Path | None
    stats: Path | None
    features: str
    language_model: str | None
    sentence_model: str | None
    epochs: int | None
    device: str | None
    fps: float | None


def train_on_dataset(run: Path, chosen: DataTraining, recipe: str | None, minutes: float) -> None:
    """Train in RUN, or resume the run there.

    Raises
    ------
    DatasetError
        If the data set cannot be used; the subclasses name the cause.
    BundleError
        If a language model or statistics that are named cannot be had.
    """
    from encoders.features.registry import feature_kind
    from encoders.tmr.conversion.from_published import load_stats
    from encoders.tmr.training.captioned_clips import statistics
    from encoders.tmr.training.tmr_run import TMRTraining, best_device
    from indexer.datasets.captioned_dataset import CaptionedDataset

    assert chosen.data is not None
    settings = read_tmr_recipe(recipe, chosen.epochs)
    kind = feature_kind(chosen.features)
    dataset = CaptionedDataset.open(chosen.data, kind, motions=chosen.motions, fps=chosen.fps)
    entries = dataset.split("train")
    dataset.motions.check_rate(entries)
    try:
        held_out = dataset.split("val")
    except MissingSplit as error:
        click.echo(f"not validated: {error}", err=True)
        held_out = []
    texts = text_features(dataset, [*entries, *held_out], chosen.language_model, chosen.sentence_model, run)
    clips = _clips(dataset, entries)
    begun = run / "stats" if (run / "stats" / "std.pt").is_file() else None
    place = chosen.stats or begun or dataset.stats
    stats = load_stats(place, kind.size) if place is not None else statistics(clips)
    device = chosen.device or best_device()
    click.echo(f"{len(clips)} motions of {dataset.name}, {len(held_out)} to validate on; on {device}")
    click.echo(f"statistics of the features: {place or 'of the split train'}")
    click.echo(f"tokens by {texts.language_model}, similarity of captions by {texts.sentence_model}")
    training = TMRTraining(run, settings, kind, clips, texts, stats, device)
    training.run(_clips(dataset, held_out) if held_out else None, minutes=minutes, say=click.echo)


def read_tmr_recipe(recipe: str | None, epochs: int | None) -> TMRRecipe:
    """TMR's recipe with the fields that a JSON file and the command line change; exits where they make no recipe."""
    from encoders.tmr.training.tmr_recipe import TMRRecipe

    changes: dict[str, Any] = {}
    if recipe not in (None, TMR_RECIPE):
        changes = options.read_object(Path(str(recipe)))
    unknown = sorted(set(changes) - set(TMRRecipe().to_dict()))
    if unknown:
        raise click.UsageError(f"{recipe}: TMR's recipe has no {', '.join(unknown)}; see docs/training.md")
    try:
        return TMRRecipe(**changes | ({} if epochs is None else {"epochs": epochs}))
    except (TypeError, ValueError) as error:
        raise click.UsageError(f"{recipe}: no recipe ({error}); see docs/training.md") from None


def text_features(
    dataset: CaptionedDataset,
    entries: Iterable[CaptionedEntry],
    language_model: str | None,
    sentence_model: str | None,
    folder: Path,
) -> TextFeatures:
    """Features of all captions: those stored with the data set, else by a language model, computed once into `folder`.

    Raises
    ------
    BundleError
        If a model that is named is neither stored, nor a folder, nor to be had from the hub.
    """
    from encoders.tmr.text.hub import load_language
    from encoders.tmr.text.language_model import DEFAULT
    from encoders.tmr.text.token_features import TokenTable
    from encoders.tmr.training.captioned_clips import TextFeatures
    from indexer.datasets.text_embeddings import StoredSentences, StoredTokens

    captions = list(dict.fromkeys(caption.text for entry in entries for caption in entry.captions))
    rows = {caption: row for row, caption in enumerate(captions)}

    @cache
    def computed(named: str) -> tuple[str, TokenTable]:
        language = load_language(named)
        return language.name, TokenTable(captions, language, folder)

    of_tokens: Callable[[Sequence[str]], Sequence[NDArray[np.floating]]]
    stored_tokens = StoredTokens.open(dataset.folder, language_model)
    has_tokens = stored_tokens is not None and stored_tokens.has(captions)
    if stored_tokens is not None and has_tokens:
        name, width, of_tokens = stored_tokens.name, stored_tokens.width, stored_tokens.rows
    else:
        name, table = computed(language_model or DEFAULT)
        width, of_tokens = table.features.shape[1], _by_row(table.rows, rows)
    stored = StoredSentences.open(dataset.folder, sentence_model)
    if stored is not None and stored.has(captions):
        return TextFeatures(name, width, of_tokens, stored.name, stored.rows)
    other, table = computed(sentence_model or (DEFAULT if has_tokens else language_model) or DEFAULT)
    return TextFeatures(name, width, of_tokens, other, _by_row(table.sentences.__getitem__, rows))


def _by_row(of_rows: Callable[[list[int]], T], rows: Mapping[str, int]) -> Callable[[Sequence[str]], T]:
    """What takes the rows of sentences, as something that takes the sentences."""
    return lambda sentences: of_rows([rows[sentence] for sentence in sentences])


def _clips(dataset: CaptionedDataset, entries: Sequence[CaptionedEntry]) -> CaptionedClips:
    from encoders.tmr.training.captioned_clips import CaptionedClips

    return CaptionedClips(
        [[caption.text for caption in entry.captions] for entry in entries],
        lambda i, c: dataset.motions.clip(entries[i], entries[i].captions[c]),
    )
