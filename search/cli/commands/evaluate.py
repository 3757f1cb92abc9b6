"""`motionseek evaluate`: retrieval figures of a model, on your own archive or on synthetic motion."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from encoders.errors import QueryError
from search.cli import options
from search.cli.path_types import FOLDER

if TYPE_CHECKING:
    from encoders.protocol import Encoder

_PROTOCOLS = ("retrieval", "labels", "captions", "corpus", "out-of-domain", "moments", "compose")
_FORMATS = ("table", "json", "csv", "latex")
_FILE = click.Path(path_type=Path)
_SYNTHETIC = "synthetic takes"


@click.command()
@click.argument("folder", required=False, type=FOLDER)
@click.option(
    "--protocol",
    type=click.Choice(_PROTOCOLS),
    help="What is measured. [default: retrieval where FOLDER is a captioned data set, else labels]",
)
@click.option("--labels", type=_FILE, default=Path("labels.tsv"), help="Table with columns path and label.")
@click.option("--queries", type=_FILE, default=Path("queries.tsv"), help="Table with columns label and query.")
@click.option("--captions", type=_FILE, help="JSON lines with trial, start_frame, end_frame, fps, captions, split.")
@click.option("--split", help="Split of the data set (test; for moments and captioned takes val).")
@click.option("--labelled", type=_FILE, help="Folder with labels.tsv and queries.tsv, for moments in joined clips.")
@click.option("--segments", type=_FILE, help='Timed labels of takes: JSON, {trial: [{"start", "end", "label"}]}.')
@click.option("--timelines", type=_FILE, help="Time lines to compose: lines 'sentence # start # end # body parts'.")
@click.option(
    "--count",
    type=options.Count(1),
    help="Synthetic clips (4000; 300 for out-of-domain), synthetic takes (300), or the first time lines (all).",
)
@options.model
@click.option("--run", type=FOLDER, help="A run directory of TMR, in place of --model; needs the extra train.")
@click.option("--stats", type=FOLDER, help="Folder with the mean.pt and std.pt of --run.")
@click.option("--motions", type=FOLDER, help="Folder of the data set's motions.")
@options.fps
@click.option("--language-model", metavar="NAME|DIR", help="Of --run: stored token features, or a model's folder.")
@click.option("--sentence-model", metavar="NAME|DIR", help="Of sentence similarity: stored, or a model's folder.")
@click.option("--format", "format", type=click.Choice(_FORMATS), default="table", help="Of retrieval's figures.")
@options.as_json
def evaluate(
    folder: Path | None,
    protocol: str | None,
    labels: Path,
    queries: Path,
    captions: Path | None,
    split: str | None,
    labelled: Path | None,
    segments: Path | None,
    timelines: Path | None,
    count: int | None,
    model: str | None,
    run: Path | None,
    stats: Path | None,
    motions: Path | None,
    fps: float | None,
    language_model: str | None,
    sentence_model: str | None,
    format: str,
    as_json: bool,
) -> None:
    """Evaluate the model on a captioned data set or an archive of yours in FOLDER, or on synthetic motion.

    Moments are searched in synthetic takes of held-out actions; with FOLDER and --captions in a third as many takes
    joined from its clips (and those of --labelled) and for captions of parts; with --segments for timed labels.

    \b
    Protocols:
      retrieval      the TMR paper's four protocols on a data set with annotations.json
      labels         average precision of each label's queries among the labelled clips of FOLDER
      captions       rank of the best file for each description in FOLDER's manifest.tsv and each caption
      corpus         retrieval among synthetic clips held out of training
      out-of-domain  how often sentences that no motion fits are called strong
      moments        moment retrieval in long takes, or in the motions of a captioned data set, beside the TMR
                     paper's sliding windows, as Markdown
      compose        motions composed for --timelines out of FOLDER, which is indexed, beside cuts put end to end

    \b
    Examples:
      motionseek evaluate datasets/ --split test --format latex
      motionseek evaluate datasets/annotations/babel --protocol moments --motions AMASS/
      motionseek evaluate my_mocap/ --labels labels.tsv --queries queries.tsv
      motionseek evaluate data/mocap --protocol captions --captions captions.jsonl
      motionseek evaluate --protocol corpus --count 1000
      motionseek evaluate data/mocap --protocol moments --captions captions.jsonl --count 50
      motionseek evaluate my_mocap/ --protocol compose --timelines timelines.txt
    """
    from encoders.bundle.known_models import load_model
    from indexer.datasets.captioned_dataset import is_dataset
    from search.cli.dataset_evaluation import DatasetChoice, print_moments, print_retrieval

    is_set = folder is not None and is_dataset(folder)
    protocol = protocol or ("retrieval" if is_set or run else "labels")
    if run is not None and (protocol != "retrieval" or model is not None):
        raise click.UsageError("--run is for --protocol retrieval, in place of --model")
    if protocol == "compose":
        _composed(_required(folder, protocol), timelines, count, model, as_json)
        return
    bundle = load_model(model)
    if protocol == "retrieval" or (protocol == "moments" and is_set):
        default = "val" if protocol == "moments" else "test"
        place = _required(folder, protocol)
        choice = DatasetChoice(place, split or default, motions, fps, sentence_model, language_model, stats)
        if protocol == "moments":
            print_moments(choice, bundle, as_json)
        else:
            print_retrieval(choice, bundle, run, "json" if as_json else format)
    elif protocol == "labels":
        _labels(_required(folder, protocol), labels, queries, bundle, as_json)
    elif protocol == "captions":
        if captions is None:
            raise QueryError("--protocol captions needs --captions FILE")
        _captions(_required(folder, protocol), captions, split or "val", bundle, as_json)
    elif protocol == "corpus":
        _show(_corpus(count or 4000, bundle), as_json)
    elif protocol == "moments":
        _moments(count or 300, folder, captions, split or "val", labelled, segments, bundle, as_json)
    else:
        _show({"out of domain": _out_of_domain(count or 300, bundle)}, as_json)


def _required(folder: Path | None, protocol: str) -> Path:
    if folder is None:
        raise QueryError(f"--protocol {protocol} needs a FOLDER")
    return folder


def _labels(folder: Path, labels: Path, queries: Path, encoder: Encoder, as_json: bool) -> None:
    from indexer.datasets.labelled_clips import labelled_clips
    from search.cli import terminal
    from search.evaluate.labelled_archive import evaluate_labels

    report = evaluate_labels(labelled_clips(folder, labels, queries), encoder)
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
    terminal.note(f"motion to sentence, R@1 among one sentence of each label: {100 * report.top1:.1f} %")


def _captions(folder: Path, captions: Path, split: str, encoder: Encoder, as_json: bool) -> None:
    from indexer.datasets.captioned_takes import captioned_takes
    from search.cli import terminal
    from search.evaluate.captioned_archive import evaluate_captions

    report = evaluate_captions(captioned_takes(folder, captions, split), encoder)
    if as_json:
        terminal.document(report.as_dict())
        return
    rows = [(text, str(len(row)), f"{sum(row) / len(row) + 1:.1f}") for text, row in report.ranks.items()]
    terminal.table(("description", "captions", "mean rank"), rows, right=("captions", "mean rank"))
    recalls = ", ".join(f"R@{k} {report.recall(k):.1f} %" for k in (1, 5, 10))
    terminal.note(f"{len(report.ranks)} descriptions, {report.files} files: {recalls}")
    terminal.note(
        f"motion to sentence, R@1: {report.motion_to_sentence:.1f} %; "
        f"by cosine alone {report.motion_to_sentence_by_cosine:.1f} %"
    )


def _corpus(count: int, encoder: Encoder) -> dict[str, dict[str, float]]:
    from encoders.corpus.composition.seeds import TEST
    from encoders.corpus.composition.synthetic_pairs import synthetic_clips
    from encoders.features.registry import feature_kind
    from search.evaluate.corpus_retrieval import evaluate_corpus

    return evaluate_corpus(synthetic_clips(TEST, count, feature_kind(encoder.feature_kind)), encoder)


def _moments(
    count: int,
    folder: Path | None,
    captions: Path | None,
    split: str,
    labelled: Path | None,
    segments: Path | None,
    encoder: Encoder,
    as_json: bool,
) -> None:
    from indexer.datasets.captioned_takes import captioned_takes
    from indexer.datasets.labelled_clips import labelled_clips
    from search.cli import terminal
    from search.cli.dataset_evaluation import every_tenth
    from search.evaluate import annotated_takes
    from search.evaluate.moment_retrieval import evaluate_moments
    from search.evaluate.moment_tables import moment_tables

    sets = {_SYNTHETIC: annotated_takes.synthetic_takes(count)}
    if folder is not None and captions is not None:
        takes = list(captioned_takes(folder, captions, split))
        clips = annotated_takes.described_motions(takes)
        if labelled is not None:
            clips += annotated_takes.labelled_motions(labelled_clips(labelled))
        sets["takes joined from real clips"] = annotated_takes.joined_takes(clips, max(count // 3, 1))
        sets["captions of parts of takes"] = annotated_takes.captioned_moments(takes)
    if folder is not None and segments is not None:
        sets["timed segments"] = annotated_takes.timed_segments(folder, segments)
    figures: dict[str, dict[str, dict[str, float]]] = {}
    for name, annotated in sets.items():
        figures[name] = evaluate_moments(annotated, encoder, sequences=name == _SYNTHETIC, progress=every_tenth)
        if not as_json:
            print(f"### {name}", *moment_tables(figures[name]), sep="\n\n", end="\n\n", flush=True)
    if as_json:
        terminal.document(figures)


def _composed(folder: Path, timelines: Path | None, count: int | None, model: str | None, as_json: bool) -> None:
    from encoders.bundle.known_models import load_model
    from search.cli import terminal
    from search.compose.timeline import read_timelines
    from search.judging.composed_motion import evaluate_composed
    from search.library import Library

    if timelines is None:
        raise QueryError("--protocol compose needs --timelines FILE")
    lines = read_timelines(timelines)[:count]

    def said(done: int) -> None:
        if done % 50 == 0:
            terminal.note(f"{done} of {len(lines)} time lines done")

    with Library.open(folder, bundle=None if model is None else load_model(model)) as library:
        figures = evaluate_composed(library, lines, said)
    if as_json:
        terminal.document(figures.as_dict())
        return
    _show(figures.rows, False)
    terminal.note(
        f"{figures.timelines} time lines, {figures.clips} clips, {figures.seconds:.2f} s each; joint speed, 99th "
        f"percentile: {figures.speed_at_joins:.2f} m/s at joins, {figures.speed_in_clips:.2f} in the clips"
    )


def _out_of_domain(count: int, encoder: Encoder) -> dict[str, float]:
    from encoders.corpus.composition.seeds import TEST
    from encoders.corpus.composition.synthetic_pairs import synthetic_clips
    from encoders.features.registry import feature_kind
    from search.evaluate.out_of_domain import evaluate_out_of_domain

    clips = synthetic_clips(TEST, count, feature_kind(encoder.feature_kind))
    return evaluate_out_of_domain(encoder, encoder.encode_features([clip.features for clip in clips]))


def _show(figures: dict[str, dict[str, float]], as_json: bool) -> None:
    from search.cli import terminal

    if as_json:
        terminal.document(figures)
        return
    columns = list(dict.fromkeys(key for row in figures.values() for key in row))
    rows = [
        (name, *(_rounded(key, row[key]) if key in row else "" for key in columns)) for name, row in figures.items()
    ]
    terminal.table(("", *columns), rows, right=columns)


def _rounded(name: str, figure: float) -> str:
    return f"{figure:.3f}" if name == "TMR-score" else f"{figure:.2f}" if name.endswith("cm") else f"{figure:.1f}"
