"""`motionseek model`: the model that compares words with motion."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import click

from search.cli import options
from search.cli.commands.status import shown
from search.cli.commands.train import card, release, train


@click.group()
def model() -> None:
    """Look at the model, train one, make a bundle of it.

    \b
    Examples:
      motionseek model info
      motionseek model train runs/quick --made 2000 --steps 200
    """


model.add_command(train)
model.add_command(release)
model.add_command(card)


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
    files = loaded.manifest["files"]
    facts: dict[str, Any] = {
        "name": loaded.name,
        "fingerprint": loaded.fingerprint,
        "folder": str(loaded.folder),
        "megabytes": round(sum((loaded.folder / name).stat().st_size for name in files) / 1e6, 1),
        "calibrated": loaded.calibration is not None,
    }
    facts |= {key: value for key, value in loaded.manifest.items() if key not in ("files", "name", "fingerprint")}
    if as_json:
        terminal.document(facts)
    else:
        terminal.table(("", ""), [(name.replace("_", " "), shown(value)) for name, value in facts.items()])
