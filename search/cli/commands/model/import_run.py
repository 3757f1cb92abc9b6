"""`motionseek model import`: a published run becomes a model of this user. Needs the extra `train`."""

from __future__ import annotations

from pathlib import Path

import click

from search.cli import options
from search.cli.commands.model.train import require_extra
from search.cli.path_types import FOLDER


@click.command("import")
@click.argument("run", metavar="RUN_DIR", type=FOLDER)
@click.option("--name", required=True, help="What the model is called here, such as tmr-humanml3d.")
@click.option(
    "--stats",
    type=FOLDER,
    metavar="DIR",
    help="Folder with mean.pt and std.pt of the features. [default: the one config.json names, in or above RUN_DIR]",
)
@click.option(
    "--language-model",
    metavar="DIR|NAME",
    help="Folder of the language model, or its name on the Hugging Face hub. [default: the one config.json names]",
)
@click.option("--features", metavar="KIND", help="Kind of features, where that of config.json is not known.")
@click.option("--decoder", is_flag=True, help="With the run's decoder, for 'motionseek generate'.")
@click.option("--force", is_flag=True, help="Replace a model of this name.")
@options.as_json
def import_run(
    run: Path,
    name: str,
    stats: Path | None,
    language_model: str | None,
    features: str | None,
    decoder: bool,
    force: bool,
    as_json: bool,
) -> None:
    """Import a TMR that its authors' code has trained: RUN_DIR with config.json and weights.

    The weights are read from last_weights/, else from the last checkpoint under logs/checkpoints/. The model is written
    as a bundle into the folder that 'motionseek model list' shows, and works without torch from then on.

    \b
    Examples:
      motionseek model import models/tmr_humanml3d_guoh3dfeats --name tmr-humanml3d
      motionseek model import models/tmr_kitml_guoh3dfeats --name tmr-kitml --stats TMR/stats/kitml/guoh3dfeats \\
        --language-model distilbert-base-uncased/
    """
    require_extra("importing")
    from encoders.bundle.known_models import folder_of
    from encoders.tmr.conversion.import_run import import_run as import_published
    from search.cli import terminal

    folder = folder_of(name)
    if folder.exists() and not force:
        raise click.ClickException(f"there is a model {name!r} in {folder}; choose another name or use --force")
    bundle, difference = import_published(
        run, folder, name=name, stats=stats, language_model=language_model, features=features, decoder=decoder
    )
    if as_json:
        facts = {"name": name, "fingerprint": bundle.fingerprint, "folder": str(folder), "difference": difference}
        terminal.document(facts)
        return
    click.echo(f"{name} {bundle.fingerprint[:12]} in {folder}, {bundle.megabytes:.0f} MB")
    click.echo(f"its vectors differ from the run's by {difference:.0e} at most")
