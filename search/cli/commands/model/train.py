"""`motionseek model train` and `motionseek model release`: from data to a bundle. Both need the extra `train`."""

from __future__ import annotations

import json
from dataclasses import replace
from importlib.util import find_spec
from itertools import chain, product
from pathlib import Path
from typing import TYPE_CHECKING

import click

from encoders.errors import QueryError
from search.cli import options
from search.cli.commands.model.data_training import TMR_RECIPE, DataTraining, data_options, train_on_dataset
from search.cli.commands.model.real_archives import read_archives, real_archives, require_both
from search.cli.path_types import FILE, FOLDER, NEW_FOLDER

if TYPE_CHECKING:
    from collections.abc import Sequence
    from typing import Any

    from encoders.corpus.language.held_out_sentences import HeldOutSentences
    from encoders.features.registry import FeatureKind
    from encoders.tmr.model.network import TMR
    from encoders.tmr.model.normaliser import Normaliser
    from encoders.tmr.training.pairs import PairStore
    from encoders.tmr.training.recipe import Recipe

#: Clips of compositional augmentation, beside some 4,000 real clips.
_AUGMENTED = 1500


@click.command()
@click.argument("run", type=NEW_FOLDER)
@click.option("--synthetic", type=options.Count(1000), default=32_500, show_default=True, help="Synthetic clips.")
@click.option("--gaits", type=options.Number(0, 1), default=0.0, help="Share of them that show locomotion alone.")
@click.option("--real", type=FOLDER, help="Folder of captioned takes with a manifest.tsv.")
@click.option("--captions", type=FILE, multiple=True, help="Their captions, JSON lines; validated with the first.")
@click.option("--idle", type=FOLDER, help="Folder of BVH takes of people who stand and wait; needs --real.")
@click.option("--sentences", type=FILE, help="Human sentences that synthetic clips act out, one a line.")
@click.option("--held-out", type=FILE, multiple=True, help="File of sentences that are never trained on.")
@click.option("--recipe", metavar="tmr|FILE", help="JSON of the recipe fields to change; tmr: TMR's as published.")
@click.option(
    "--from",
    "origins",
    type=FOLDER,
    multiple=True,
    help="Bundle, or runs to average, whose weights a new run begins with.",
)
@click.option("--steps", type=options.Count(0), help="Training steps; 0: head fine-tuning alone.")
@click.option(
    "--minutes", type=click.FloatRange(min=0), default=float("inf"), help="Stop after so long; run again to resume."
)
@click.option("--jobs", type=options.Count(1), help="Processes that synthesise clips; one a core by default.")
@data_options
def train(
    run: Path,
    synthetic: int,
    gaits: float,
    real: Path | None,
    captions: tuple[Path, ...],
    idle: Path | None,
    sentences: Path | None,
    held_out: tuple[Path, ...],
    recipe: str | None,
    origins: tuple[Path, ...],
    steps: int | None,
    minutes: float,
    jobs: int | None,
    **of_data: Any,
) -> None:
    """Train in the folder RUN, or resume the run there; validated on synthetic and real clips as it goes.

    With --data on a captioned data set instead, by the recipe of published TMR, in a run directory of its layout.

    Clips, token features and checkpoints stay in RUN, so that a stopped run loses at most the steps since its last
    validation.

    \b
    Examples:
      motionseek model train runs/default --real data/mocap --captions captions.jsonl --sentences sentences.txt
      motionseek model train runs/quick --synthetic 2000 --steps 200
      motionseek model train runs/ours --from my_model/ --real our_takes/ --captions ours.jsonl --steps 1000
      motionseek model train runs/humanml3d --data datasets/
    """
    require_extra()
    chosen_data = DataTraining(**of_data)
    _refuse_mixture(click.get_current_context(), chosen_data)
    if chosen_data.data is not None:
        train_on_dataset(run, chosen_data, recipe, minutes)
        return
    from encoders.corpus.composition.seeds import RUNS_APART, TRAINING, VALIDATION
    from encoders.corpus.heldout.queries import paraphrase_queries
    from encoders.corpus.language.held_out_sentences import HeldOutSentences
    from encoders.corpus.language.unrelated import unrelated_sentences
    from encoders.features.registry import FEATURE_KINDS
    from encoders.tmr.text.language_model import LanguageModel
    from encoders.tmr.training.dataset import synthetic_store, synthetic_stores
    from encoders.tmr.training.pipeline import prepare
    from encoders.tmr.training.pipeline import train as train_in

    require_both(real, captions or None)
    chosen = read_recipe(None if recipe is None else Path(recipe), steps)
    kind = FEATURE_KINDS["body"]
    start, normaliser = initial_model(origins, chosen) if origins else (None, None)
    language = LanguageModel.load()
    banned = HeldOutSentences(chain(*paraphrase_queries().values(), *(sentences_of(path) for path in held_out)))
    lines = [text for text in sentences_of(sentences) if not banned(text)] if sentences else []
    if idle is not None and real is None:
        raise click.UsageError("--idle adds to takes with captions: give --real and --captions, too")
    real_clips, real_validation = None, None
    if real and captions:
        real_clips, real_validation = real_stores(real, captions[0], kind, banned, idle, captions[1:])
    seed = TRAINING + RUNS_APART * chosen.seed
    clips = synthetic_stores(
        run, synthetic, kind.name, lines, banned, gaits=gaits, seed=seed, jobs=jobs, say=click.echo
    )
    validation = synthetic_store(run / "validation.npz", VALIDATION, 1000, kind.name, (), banned)
    batches, validate, normaliser = prepare(
        chosen, clips, real_clips, validation, real_validation, unrelated_sentences(600), language, run, normaliser
    )
    train_in(run, chosen, batches, validate, normaliser, start=start, every=100, minutes=minutes, say=click.echo)


def _refuse_mixture(context: click.Context, chosen: DataTraining) -> None:
    """Exit where options are given that do nothing with, or without, --data."""
    given = [
        parameter
        for parameter in context.command.params
        if context.get_parameter_source(str(parameter.name)) is click.core.ParameterSource.COMMANDLINE
    ]
    always = {"run", "recipe", "minutes", "data"}
    idle = [
        parameter.opts[0]
        for parameter in given
        if parameter.name not in always and hasattr(chosen, str(parameter.name)) is (chosen.data is None)
    ]
    if idle:
        raise click.UsageError(f"{', '.join(idle)}: {'not without' if chosen.data is None else 'not with'} --data")
    if chosen.data is None and context.params["recipe"] == TMR_RECIPE:
        raise click.UsageError("--recipe tmr trains on a captioned data set: add --data DIR")


def initial_model(origins: Sequence[Path], recipe: Recipe) -> tuple[TMR, Normaliser]:
    """The model and normaliser of a bundle, or of runs, whose weights are averaged.

    Raises
    ------
    QueryError
        If the runs have other networks than the recipe.
    """
    from encoders.tmr.conversion.from_bundle import restore
    from encoders.tmr.model.network import TMR
    from search.release import is_run, mean_weights

    if len(origins) == 1 and not is_run(origins[0]):
        return restore(origins[0], recipe.network)
    require_runs(origins)
    known, weights, normaliser, _ = mean_weights(origins)
    if known.network != replace(recipe.network, decoder=None):
        raise QueryError(f"{origins[0]}: has other networks than the recipe")
    model = TMR(recipe.network)
    model.load_state_dict(weights, strict=recipe.network.decoder is None)
    return model, normaliser


def require_runs(folders: Sequence[Path]) -> None:
    """Exit where a folder holds neither a finished run nor a bundle."""
    runs = [folder for folder in folders if not (folder / "manifest.json").is_file()]
    for run, file in product(runs, ("recipe.json", "last.pt", "normaliser.npz")):
        if not (run / file).is_file():
            raise click.ClickException(
                f"{run}: not a finished run, {file} is missing; 'motionseek model train' writes it"
            )


def require_extra(work: str = "training") -> None:
    """Exit where packages of the extra `train` are missing."""
    missing = [name for name in ("torch", "onnx", "safetensors") if find_spec(name) is None]
    if missing:
        raise click.ClickException(
            f"{work} needs {', '.join(missing)}, not installed here; run in a checkout: pip install '.[train]'"
        )


def read_recipe(path: Path | None, steps: int | None) -> Recipe:
    """The default recipe with the fields that a file and the command line change; exits where they make no recipe."""
    from encoders.tmr.training.recipe import Recipe

    default = Recipe().to_dict()
    changes = options.read_object(path) if path else {}
    unknown = sorted(set(changes) - set(default))
    if unknown:
        raise click.UsageError(f"{path}: a recipe has no {', '.join(unknown)}; see docs/training.md")
    try:
        return Recipe.from_dict(default | changes | ({} if steps is None else {"steps": steps}))
    except (KeyError, TypeError, ValueError) as error:
        raise click.UsageError(f"{path}: no recipe ({error!r}); see docs/training.md") from None


def real_stores(
    folder: Path,
    captions: Path,
    kind: FeatureKind,
    banned: HeldOutSentences,
    idle: Path | None = None,
    more_captions: Sequence[Path] = (),
) -> tuple[PairStore, PairStore | None]:
    """Real clips to train on, also with motion of the folder `idle`, and those to validate on if there are any.

    Sentences held out, and `more_captions`, have nothing to do with validation.

    Raises
    ------
    QueryError
        If no take of the training split has a caption.
    """
    from encoders.corpus.language.held_out_sentences import HeldOutSentences
    from encoders.tmr.training.dataset import real_store
    from indexer.datasets.captioned_takes import captioned_takes, uncaptioned_takes

    takes = captioned_takes(folder, captions, "train", more_captions=more_captions)
    waiting = list(uncaptioned_takes(idle)) if idle else []
    training = real_store(takes, kind, varied=True, held_out=banned, augmented=_AUGMENTED, idle=waiting)
    if not len(training):
        raise QueryError(f"{folder}: no take of split 'train' has a caption; see docs/training.md")
    validation = real_store(captioned_takes(folder, captions, "val"), kind, varied=False, held_out=HeldOutSentences(()))
    return training, validation if len(validation) else None


@click.command()
@click.argument("runs", metavar="RUN...", nargs=-1, required=True, type=FOLDER)
@click.argument("folder", type=NEW_FOLDER)
@click.option("--name", default="motionseek", show_default=True, help="The model's name.")
@real_archives
@click.option("--notes", type=FILE, help="JSON for the manifest: what it was trained on.")
def release(
    runs: tuple[Path, ...],
    folder: Path,
    name: str,
    real: Path | None,
    captions: Path | None,
    labelled: Path | None,
    notes: Path | None,
) -> None:
    """Export a run as the bundle FOLDER: ONNX, weights in 8 bits, calibrated.

    The weights of several runs that began from the same one are averaged, also with the bundle that they began from.

    \b
    Examples:
      motionseek model release runs/default my_model/
      motionseek model release runs/default runs/longer my_model/
    """
    require_extra()
    from search.release import release as release_run

    require_runs(runs)
    training = options.read_object(notes) if notes else None
    archives = read_archives(real, captions, labelled)
    bundle = release_run(runs, folder, name=name, training=training, archives=archives)
    click.echo(f"{bundle.name} {bundle.fingerprint[:12]} in {folder}")


def sentences_of(path: Path) -> list[str]:
    """Lines of a text file, the last column of a table, or the captions in JSON lines that are not for training."""
    try:
        lines = [line.strip() for line in path.read_text("utf-8").splitlines() if line.strip()]
        if path.suffix == ".jsonl":
            rows = [json.loads(line) for line in lines]
            return [caption for row in rows if row.get("split") != "train" for caption in row["captions"]]
    except (AttributeError, KeyError, TypeError, ValueError) as error:
        raise QueryError(f"{path}: holds no sentences ({error!r}); see docs/training.md") from None
    if path.suffix == ".tsv":
        return [line.split("\t")[-1] for line in lines[1:]]
    return lines
