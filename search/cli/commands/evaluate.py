"""`motionseek evaluate`: how well a model finds things, on your own archive or on made motion."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from encoders.errors import QueryError
from search.cli import options

if TYPE_CHECKING:
    from encoders.protocol import Encoder

_PROTOCOLS = ("labels", "described", "corpus", "nonsense", "moments")
_FILE = click.Path(path_type=Path)
_COMPOSED = "made takes"


@click.command()
@click.argument("folder", required=False, type=click.Path(exists=True, file_okay=False, path_type=Path))
@click.option(
    "--protocol", type=click.Choice(_PROTOCOLS), default="labels", show_default=True, help="What is measured."
)
@click.option("--labels", type=_FILE, default=Path("labels.tsv"), help="Table with columns path and label.")
@click.option("--queries", type=_FILE, default=Path("queries.tsv"), help="Table with columns label and query.")
@click.option("--captions", type=_FILE, help="JSON lines with trial, start_frame, end_frame, fps, captions, split.")
@click.option("--split", default="val", show_default=True, help="Split of the captioned takes to ask about.")
@click.option("--labelled", type=_FILE, help="Folder with labels.tsv and queries.tsv, for moments in joined clips.")
@click.option("--segments", type=_FILE, help='JSON, {trial: [{"start", "end", "label"}]}: what people marked in takes.')
@click.option("--count", type=click.IntRange(1), help="Made clips (4000; 300 for nonsense), or made takes (300).")
@click.option("--bundle", "place", type=click.Path(exists=True, file_okay=False), help="Another model's folder.")
@options.as_json
def evaluate(
    folder: Path | None,
    protocol: str,
    labels: Path,
    queries: Path,
    captions: Path | None,
    split: str,
    labelled: Path | None,
    segments: Path | None,
    count: int | None,
    place: str | None,
    as_json: bool,
) -> None:
    """Score the model: on an archive of yours in FOLDER, or on motion made by rule.

    labels: rank all labelled clips of FOLDER for each query of each label, by average precision.
    described: the rank of the best file for each description in FOLDER's manifest.tsv, and for what people wrote.
    corpus: retrieval among made clips nobody trained on. nonsense: how often sentences about other things are
    called strong. moments: how well sentences are found in long takes, beside the paper's way, as Markdown: in made
    takes of actions held out of training; with FOLDER and --captions in a third as many takes joined from its clips
    (and those of --labelled) and where people wrote of parts of takes; with --segments where they timed labels.

    \b
    Examples:
      motionseek evaluate my_mocap/ --labels labels.tsv --queries queries.tsv
      motionseek evaluate data/mocap --protocol described --captions captions.jsonl
      motionseek evaluate --protocol corpus --count 1000
      motionseek evaluate data/mocap --protocol moments --captions captions.jsonl --count 50
    """
    from encoders.bundle.bundle import Bundle

    bundle = Bundle.load(place)
    if protocol == "labels":
        _labels(_needed(folder, protocol), labels, queries, bundle, as_json)
    elif protocol == "described":
        if captions is None:
            raise QueryError("--protocol described needs --captions FILE")
        _described(_needed(folder, protocol), captions, split, bundle, as_json)
    elif protocol == "corpus":
        _show(_corpus(count or 4000, bundle), as_json)
    elif protocol == "moments":
        _moments(count or 300, folder, captions, split, labelled, segments, bundle, as_json)
    else:
        _show({"out of domain": _nonsense(count or 300, bundle)}, as_json)


def _needed(folder: Path | None, protocol: str) -> Path:
    if folder is None:
        raise QueryError(f"--protocol {protocol} needs a FOLDER")
    return folder


def _labels(folder: Path, labels: Path, queries: Path, bundle: Encoder, as_json: bool) -> None:
    from search.cli import terminal
    from search.evaluate.labelled_archive import evaluate_labels

    report = evaluate_labels(folder, labels, queries, bundle)
    if as_json:
        terminal.document(report.as_dict())
        return
    for path, reason in report.unreadable:
        terminal.note(f"left out: {path}: {reason}")
    rows = [
        (label, str(report.clips[label]), f"{sum(row) / len(row):.3f}", " ".join(f"{p:.3f}" for p in row))
        for label, row in report.precisions.items()
    ]
    rows.append(("mean", str(sum(report.clips.values())), f"{report.mean:.3f}", ""))
    terminal.table(("label", "clips", "mean AP", "AP of each query"), rows, right=("clips", "mean AP"))
    terminal.note(f"motion to sentence, right among the labels at rank 1: {100 * report.top1:.1f} %")


def _described(folder: Path, captions: Path, split: str, bundle: Encoder, as_json: bool) -> None:
    from indexer.datasets.captioned_takes import captioned_takes
    from search.cli import terminal
    from search.evaluate.captioned_archive import evaluate_described

    report = evaluate_described(captioned_takes(folder, captions, split), bundle)
    if as_json:
        terminal.document(report.as_dict())
        return
    rows = [(text, str(len(row)), f"{sum(row) / len(row) + 1:.1f}") for text, row in report.ranks.items()]
    terminal.table(("description", "sentences", "mean rank"), rows, right=("sentences", "mean rank"))
    found = ", ".join(f"first {k}: {report.found(k):.1f} %" for k in (1, 5, 10))
    terminal.note(f"{len(report.ranks)} descriptions, {report.files} files; best right file among the {found}")
    terminal.note(
        f"motion to sentence, first right: {report.told:.1f} %; by cosine alone {report.told_by_cosine:.1f} %"
    )


def _corpus(count: int, bundle: Encoder) -> dict[str, dict[str, float]]:
    from encoders.corpus.composition.seeds import TEST
    from encoders.corpus.composition.synthetic_pairs import synthetic_clips
    from encoders.features.registry import FEATURE_KINDS
    from search.evaluate.corpus_retrieval import evaluate_corpus

    return evaluate_corpus(synthetic_clips(TEST, count, FEATURE_KINDS[bundle.feature_kind]), bundle)


def _moments(
    count: int,
    folder: Path | None,
    captions: Path | None,
    split: str,
    labelled: Path | None,
    segments: Path | None,
    bundle: Encoder,
    as_json: bool,
) -> None:
    from indexer.datasets.captioned_takes import captioned_takes
    from search.cli import terminal
    from search.evaluate import annotated_takes
    from search.evaluate.moment_retrieval import evaluate_moments
    from search.evaluate.moment_tables import moment_tables

    sets = {_COMPOSED: annotated_takes.composed(count)}
    if folder is not None and captions is not None:
        takes = list(captioned_takes(folder, captions, split))
        clips = annotated_takes.described_clips(takes) + (annotated_takes.labelled_clips(labelled) if labelled else [])
        sets["takes joined from real clips"] = annotated_takes.joined(clips, max(count // 3, 1))
        sets["sentences people wrote of parts of takes"] = annotated_takes.captioned_moments(takes)
    if folder is not None and segments is not None:
        sets["segments people timed in takes"] = annotated_takes.timed_segments(folder, segments)
    figures: dict[str, dict[str, dict[str, float]]] = {}
    for name, takes_of in sets.items():
        figures[name] = evaluate_moments(takes_of, bundle, steps=name == _COMPOSED, progress=_every_tenth)
        if not as_json:
            print(f"### {name}", *moment_tables(figures[name]), sep="\n\n", end="\n\n", flush=True)
    if as_json:
        terminal.document(figures)


def _every_tenth(takes: int) -> None:
    from search.cli import terminal

    if takes % 10 == 0:
        terminal.note(f"{takes} takes asked")


def _nonsense(count: int, bundle: Encoder) -> dict[str, float]:
    from encoders.corpus.composition.seeds import TEST
    from encoders.corpus.composition.synthetic_pairs import synthetic_clips
    from encoders.features.registry import FEATURE_KINDS
    from search.evaluate.out_of_domain import evaluate_nonsense

    clips = synthetic_clips(TEST, count, FEATURE_KINDS[bundle.feature_kind])
    return evaluate_nonsense(bundle, bundle.encode_features([clip.features for clip in clips]))


def _show(figures: dict[str, dict[str, float]], as_json: bool) -> None:
    from search.cli import terminal

    if as_json:
        terminal.document(figures)
        return
    columns = list(dict.fromkeys(key for row in figures.values() for key in row))
    rows = [(name, *(f"{row[key]:.1f}" if key in row else "" for key in columns)) for name, row in figures.items()]
    terminal.table(("", *columns), rows, right=columns)
