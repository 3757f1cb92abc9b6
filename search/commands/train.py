"""`motionseek model train` and `release`: from data to a bundle. Both need the extra `train`."""

from __future__ import annotations

import json
from pathlib import Path

import click

from search.commands import options

_FOLDER = click.Path(exists=True, file_okay=False, path_type=Path)
_FILE = click.Path(exists=True, dir_okay=False, path_type=Path)


@click.command()
@click.argument("run", type=click.Path(file_okay=False, path_type=Path))
@click.option("--made", type=click.IntRange(1000), default=15_000, show_default=True, help="Clips made by rule.")
@click.option("--real", type=_FOLDER, help="Folder of captioned takes with a manifest.tsv.")
@click.option("--captions", type=_FILE, help="What people wrote about them, JSON lines.")
@click.option("--sentences", type=_FILE, help="Human sentences to act out, one a line.")
@click.option("--held-out", type=_FILE, multiple=True, help="File whose sentences must not become captions.")
@click.option("--recipe", type=_FILE, help="JSON of recipe fields that differ from the default.")
@click.option("--steps", type=click.IntRange(1), help="Training steps.")
@click.option(
    "--minutes", type=click.FloatRange(min=0), default=float("inf"), help="Stop after so long; run again to go on."
)
@click.option("--jobs", type=click.IntRange(1), help="Processes that make clips; one a core if not given.")
def train(
    run: Path,
    made: int,
    real: Path | None,
    captions: Path | None,
    sentences: Path | None,
    held_out: tuple[Path, ...],
    recipe: Path | None,
    steps: int | None,
    minutes: float,
    jobs: int | None,
) -> None:
    """Train in the folder RUN, or go on with what is there; validated on made and real clips as it runs.

    Everything that was made or computed stays in RUN, so that a stopped run loses at most the steps since its last
    validation.

    \b
    Examples:
      motionseek model train runs/default --real data/mocap --captions captions.jsonl --sentences sentences.txt
      motionseek model train runs/quick --made 2000 --steps 200
    """
    from encoders.corpus.language import HeldOut
    from encoders.corpus.seeds import VALIDATION
    from encoders.kinds import FEATURE_KINDS
    from encoders.tmr.language import LanguageModel
    from encoders.tmr.material import made_store, made_stores, real_store, unrelated_sentences
    from encoders.tmr.run import prepare
    from encoders.tmr.run import train as train_in
    from encoders.tmr.train import Recipe
    from indexer.captioned import captioned_takes

    if (real is None) != (captions is None):
        raise click.UsageError("--real and --captions belong together")
    changes = json.loads(recipe.read_text("utf-8")) if recipe else {}
    unknown = sorted(set(changes) - set(Recipe().to_dict()))
    if unknown:
        raise click.UsageError(f"{recipe}: a recipe has no {', '.join(unknown)}; see docs/training.md")
    chosen = Recipe.from_dict(Recipe().to_dict() | changes | ({"steps": steps} if steps else {}))
    kind = FEATURE_KINDS["body"]
    banned = HeldOut(text for path in held_out for text in _sentences(path))
    lines = [text for text in _sentences(sentences) if not banned(text)] if sentences else []
    clips = made_stores(run, made, kind.name, lines, banned, jobs=jobs, say=click.echo)
    validation = made_store(run / "validation.npz", VALIDATION, 1000, kind.name, (), banned)
    stores = [
        real_store(captioned_takes(real, captions, split), kind, varied=split == "train", held_out=banned)
        if real and captions
        else None
        for split in ("train", "val")
    ]
    batches, validate, normaliser = prepare(
        chosen, clips, stores[0], validation, stores[1], unrelated_sentences(600), LanguageModel.load(), run
    )
    train_in(run, chosen, batches, validate, normaliser, every=100, minutes=minutes, say=click.echo)


@click.command()
@click.argument("run", type=_FOLDER)
@click.argument("folder", type=click.Path(file_okay=False, path_type=Path))
@click.option("--name", default="motionseek", show_default=True, help="The model's name.")
@click.option("--real", type=_FOLDER, help="Folder of captioned takes; its split val helps to calibrate.")
@click.option("--captions", type=_FILE, help="What people wrote about them, JSON lines.")
@click.option("--notes", type=_FILE, help="JSON to put into the manifest as what it was trained on.")
def release(run: Path, folder: Path, name: str, real: Path | None, captions: Path | None, notes: Path | None) -> None:
    """Make the bundle FOLDER of the run RUN: exported, weights in 8 bits, calibrated.

    \b
    Examples:
      motionseek model release runs/default my_model/
    """
    from indexer.captioned import captioned_takes
    from search.release import release as release_run

    takes = list(captioned_takes(real, captions, "val")) if real and captions else []
    training = json.loads(notes.read_text("utf-8")) if notes else None
    bundle = release_run(run, folder, name=name, training=training, takes=takes)
    click.echo(f"{bundle.name} {bundle.fingerprint[:12]} in {folder}")


@click.command()
@click.argument("out", type=click.Path(dir_okay=False, path_type=Path))
@click.option("--bundle", "place", type=_FOLDER, help="Another model's folder.")
@click.option("--real", type=_FOLDER, help="Folder of captioned takes with a manifest.tsv; its split val is asked.")
@click.option("--captions", type=_FILE, help="What people wrote about them, JSON lines.")
@click.option("--labelled", type=_FOLDER, help="Folder with labels.tsv and queries.tsv.")
@click.option("--count", type=click.IntRange(64), default=4000, show_default=True, help="Made clips in the gallery.")
@options.force
def card(
    out: Path,
    place: Path | None,
    real: Path | None,
    captions: Path | None,
    labelled: Path | None,
    count: int,
    force: bool,
) -> None:
    """Measure the model and write its card to OUT, a Markdown file.

    \b
    Examples:
      motionseek model card model.md --count 1000
      motionseek model card docs/model.md --real data/mocap --captions captions.jsonl --labelled data/bandai1 --force
    """
    from encoders.bundle import Bundle
    from search.evaluate.card import card as measured

    if out.exists() and not force:
        raise click.ClickException(f"{out} exists; overwrite it with --force")
    out.write_text(measured(Bundle.load(place), real=real, captions=captions, labelled=labelled, count=count), "utf-8")
    click.echo(f"written: {out}")


def _sentences(path: Path) -> list[str]:
    """Lines of a text file, the last column of a table, or the captions in JSON lines that are not for training."""
    lines = [line.strip() for line in path.read_text("utf-8").splitlines() if line.strip()]
    if path.suffix == ".jsonl":
        rows = [json.loads(line) for line in lines]
        return [caption for row in rows if row.get("split") != "train" for caption in row["captions"]]
    if path.suffix == ".tsv":
        return [line.split("\t")[-1] for line in lines[1:]]
    return lines
