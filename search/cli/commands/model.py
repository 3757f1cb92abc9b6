"""`motionseek model`: show, train, release and evaluate the model that compares sentences with motion."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import click

from search.cli import options
from search.cli.commands.status import shown
from search.cli.commands.train import release, require_both, train

_FOLDER = click.Path(exists=True, file_okay=False, path_type=Path)
_FILE = click.Path(exists=True, dir_okay=False, path_type=Path)


@click.group()
def model() -> None:
    """Show the model, train one, release it as a bundle, write its card.

    \b
    Examples:
      motionseek model info
      motionseek model train runs/quick --synthetic 2000 --steps 200
    """


model.add_command(train)
model.add_command(release)


@model.command()
@click.option("--bundle", type=click.Path(exists=True, file_okay=False, path_type=Path), help="Another model's folder.")
@options.as_json
def info(bundle: Path | None, as_json: bool) -> None:
    """Show what the model is, what it was trained on and under which licence.

    \b
    Examples:
      motionseek model info
      motionseek model info --bundle my_model/ --json
    """
    from encoders.bundle.bundle import Bundle
    from search.cli import terminal

    loaded = Bundle.load(bundle)
    facts: dict[str, Any] = {
        "name": loaded.name,
        "fingerprint": loaded.fingerprint,
        "folder": str(loaded.folder),
        "megabytes": round(loaded.megabytes, 1),
        "calibrated": loaded.calibration is not None,
    }
    facts |= {key: value for key, value in loaded.manifest.items() if key not in ("files", "name", "fingerprint")}
    if as_json:
        terminal.document(facts)
    else:
        terminal.table(("", ""), [(name.replace("_", " "), shown(value)) for name, value in facts.items()])


@model.command()
@click.argument("out", type=click.Path(dir_okay=False, path_type=Path))
@click.option("--bundle", "place", type=_FOLDER, help="Another model's folder.")
@click.option(
    "--real", type=_FOLDER, help="Folder of captioned takes with a manifest.tsv; its split val is evaluated on."
)
@click.option("--captions", type=_FILE, help="Their captions, JSON lines.")
@click.option("--labelled", type=_FOLDER, help="Folder with labels.tsv and queries.tsv.")
@click.option(
    "--count", type=click.IntRange(64), default=4000, show_default=True, help="Synthetic clips in the gallery."
)
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
    """Evaluate the model and write its card to OUT, a Markdown file.

    \b
    Examples:
      motionseek model card model.md --count 1000
      motionseek model card docs/model.md --real data/mocap --captions captions.jsonl --labelled data/bandai1 --force
    """
    from encoders.bundle.bundle import Bundle
    from search.evaluate.card import model_card
    from search.export.replacing import write_text

    require_both(real, captions)
    options.refuse_overwriting(out, force)
    bundle = Bundle.load(place)
    write_text(out, model_card(bundle, real=real, captions=captions, labelled=labelled, count=count))
    click.echo(f"written: {out}")
