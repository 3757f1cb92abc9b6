"""`motionseek model`: show and list models, write the card of one; import, train and release are beside it."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from search.cli import options
from search.cli.commands.model.decoder import decoder
from search.cli.commands.model.import_run import import_run
from search.cli.commands.model.real_archives import read_archives, real_archives, require_both
from search.cli.commands.model.train import release, train
from search.cli.commands.status import shown
from search.cli.path_types import FILE, FOLDER, NEW_FILE

if TYPE_CHECKING:
    from encoders.bundle.known_models import KnownModel


#: What is shown of a model that has no manifest.
_MEMBERS = ("feature_kind", "fps", "max_frames", "latent_size")


@click.group()
def model() -> None:
    """Show the model, list those that are here, import or train one, release it as a bundle, write its card.

    \b
    Examples:
      motionseek model info
      motionseek model list
      motionseek model train runs/quick --synthetic 2000 --steps 200
    """


model.add_command(import_run)
model.add_command(train)
model.add_command(release)
model.add_command(decoder)


@model.command()
@options.model
@options.as_json
def info(model: str | None, as_json: bool) -> None:
    """Show what the model is, what it was trained on and under which licence.

    \b
    Examples:
      motionseek model info
      motionseek model info --model my_model/ --json
    """
    from encoders.bundle.bundle import Bundle
    from encoders.bundle.known_models import load_model
    from search.cli import terminal

    loaded = load_model(model)
    facts: dict[str, Any] = {"name": loaded.name, "fingerprint": loaded.fingerprint}
    if isinstance(loaded, Bundle):
        facts |= {"folder": str(loaded.folder), "megabytes": round(loaded.megabytes, 1)}
    facts["calibrated"] = loaded.calibration is not None
    stated = loaded.manifest if isinstance(loaded, Bundle) else {name: getattr(loaded, name) for name in _MEMBERS}
    facts |= {key: value for key, value in stated.items() if key not in ("files", "name", "fingerprint")}
    if as_json:
        terminal.document(facts)
    else:
        terminal.table(("", ""), [(name.replace("_", " "), shown(value)) for name, value in facts.items()])


@model.command("list")
@options.as_json
def list_models(as_json: bool) -> None:
    """List the models that --model takes: the shipped one, imported ones, and those of installed packages.

    \b
    Examples:
      motionseek model list
      motionseek model list --json
    """
    from encoders.bundle.known_models import known_models, models_folder
    from search.cli import terminal

    rows = [_listed(known) for known in known_models()]
    if as_json:
        terminal.document({"folder": str(models_folder()), "models": rows})
        return
    columns = ("name", "features", "language_model", "latent_size", "megabytes", "fingerprint", "place")
    table = [tuple("" if row[column] is None else shown(row[column]) for column in columns) for row in rows]
    terminal.table(
        tuple(column.replace("_", " ") for column in columns),
        table,
        right=("latent size", "megabytes"),
        below=("place",),
    )
    for row in rows:
        if row["problem"]:
            terminal.note(str(row["problem"]))


def _listed(known: KnownModel) -> dict[str, Any]:
    """A model as a row of the list; what is not known of it is None."""
    stated = {} if known.manifest is None else known.manifest.values
    files = [] if known.manifest is None else [Path(known.place) / name for name in known.manifest.files]
    return {
        "name": known.name,
        "features": stated.get("feature_kind"),
        "language_model": stated.get("language_model"),
        "latent_size": stated.get("latent_size"),
        "megabytes": round(sum(f.stat().st_size for f in files if f.is_file()) / 1e6, 1) if files else None,
        "fingerprint": None if known.manifest is None else known.manifest.fingerprint[:12],
        "place": known.place,
        "problem": known.problem,
    }


@model.command()
@click.argument("name")
@real_archives
@options.as_json
def calibrate(name: str, real: Path | None, captions: Path | None, labelled: Path | None, as_json: bool) -> None:
    """Calibrate the model NAME, an imported one or a bundle's folder, so that its hits are strong, plausible or weak.

    Hits of real archives are judged, or, where none is given, of 2,300 synthetic clips and of sentences that no motion
    fits. It takes minutes; vectors stay as they are, so libraries need not be made again.

    \b
    Examples:
      motionseek model calibrate tmr-humanml3d
      motionseek model calibrate my_model/ --real data/mocap --captions captions.jsonl --labelled data/hdm05
    """
    from encoders.bundle.bundle import DEFAULT, Bundle
    from encoders.bundle.calibration_file import add_calibration
    from encoders.bundle.known_models import load_model
    from search.cli import terminal
    from search.evaluate.judged_hits import calibrate_on

    archives = read_archives(real, captions, labelled)
    bundle = load_model(name)
    if not isinstance(bundle, Bundle) or bundle.folder == DEFAULT:
        raise click.ClickException(f"{name}: only imported models and bundles of your own are calibrated here")
    add_calibration(bundle.folder, calibrate_on(bundle, archives))
    if as_json:
        terminal.document({"name": bundle.name, "folder": str(bundle.folder), "calibrated": True})
    else:
        click.echo(f"{bundle.name} in {bundle.folder} is calibrated")


@model.command()
@click.argument("out", type=NEW_FILE)
@options.model
@click.option(
    "--real", type=FOLDER, help="Folder of captioned takes with a manifest.tsv; its split val is evaluated on."
)
@click.option("--captions", type=FILE, help="Their captions, JSON lines.")
@click.option("--labelled", type=FOLDER, help="Folder with labels.tsv and queries.tsv.")
@click.option(
    "--count", type=options.Count(64), default=4000, show_default=True, help="Synthetic clips in the gallery."
)
@options.force
def card(
    out: Path,
    model: str | None,
    real: Path | None,
    captions: Path | None,
    labelled: Path | None,
    count: int,
    force: bool,
) -> None:
    """Evaluate the model and write its card to OUT, a Markdown file.

    \b
    Examples:
      motionseek model card model.md --count 1000
      motionseek model card docs/model.md --real data/mocap --captions captions.jsonl --labelled data/bandai1 --force
    """
    from encoders.bundle.bundle import Bundle
    from encoders.bundle.known_models import load_model
    from search.evaluate.card import model_card
    from search.export.replacing import write_text

    require_both(real, captions)
    options.refuse_overwriting(out, force)
    bundle = load_model(model)
    if not isinstance(bundle, Bundle):
        raise click.ClickException(f"{bundle.name} is no bundle, so it has no card")
    write_text(out, model_card(bundle, real=real, captions=captions, labelled=labelled, count=count))
    click.echo(f"written: {out}")
