"""`motionseek judge`: the figures of generated motion that papers report, beside those of real motion."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from encoders.errors import QueryError
from search.cli import options
from search.cli.figure_output import Form, form_option, print_rows
from search.cli.path_types import FILE, FOLDER, NEW_FILE

if TYPE_CHECKING:
    from encoders.protocol import Encoder
    from search.judging.judgement import Judgement
    from search.judging.motion_table import JudgedMotion

_EITHER = click.Path(exists=True, path_type=Path)
#: What a folder of motions is looked for when no --texts are given.
_BESIDE = "motions.tsv"


@click.command()
@click.argument("folders", metavar="FOLDER...", nargs=-1, required=True, type=FOLDER)
@click.option(
    "--texts",
    type=_EITHER,
    help="Table with path and any of text, label, reference, transitions; or a folder with NAME.txt for each motion.",
)
@click.option("--references", type=_EITHER, help="Folder of real motions; with --timelines also a table text, path.")
@click.option("--labels", type=FILE, help="Labels that are recognised, one a line; labels on a line are synonyms.")
@click.option("--timelines", type=FILE, help="Time lines that the motions were generated for, as of STMC's data set.")
@click.option("--crops", type=NEW_FILE, help="Write every crop of --timelines here.")
@click.option("--repeats", type=options.Count(2), default=20, show_default=True, help="Random draws of one FOLDER.")
@click.option("--seed", type=click.IntRange(0), default=0, help="Of the random draws.")
@options.model
@form_option
@options.force
def judge(
    folders: tuple[Path, ...],
    texts: Path | None,
    references: Path | None,
    labels: Path | None,
    timelines: Path | None,
    crops: Path | None,
    repeats: int,
    seed: int,
    model: str | None,
    form: Form,
    force: bool,
) -> None:
    """Judge the generated motions in FOLDER with every figure that what is known of them allows.

    Texts: a table motions.tsv in FOLDER is used where no --texts are given. References are real motions, each of the
    name of the motion that it is the reference of, unless the table says otherwise. Several FOLDERs are repeats of one
    generator, each generated with another seed. docs/judging.md has every figure with its definition.

    \b
    Examples:
      motionseek judge generated/ --texts texts.tsv --references real/
      motionseek judge seed_1/ seed_2/ seed_3/ --texts texts/ --references real/ --format latex
      motionseek judge generated/ --timelines timelines.txt --references clips.tsv --crops crops.csv
    """
    from encoders.bundle.known_models import load_model
    from search.judging.judgement import judge as judge_motions
    from search.judging.motion_table import read_folder

    if crops is not None and timelines is None:
        raise click.UsageError("--crops needs --timelines")
    if timelines is not None:
        if len(folders) > 1 or texts or labels:
            raise click.UsageError("--timelines takes one FOLDER, without --texts and --labels")
        if crops is not None:
            options.refuse_overwriting(crops, force)
        _timelines(folders[0], timelines, references, crops, load_model(model), seed, form)
        return
    if references is not None and not references.is_dir():
        raise QueryError(f"{references}: references are a folder of motions; a table goes with --timelines")
    known, synonyms = _labels(labels) if labels else ((), [])
    sets = [read_folder(folder, texts or _beside(folder)) for folder in folders]
    _same_names(folders, sets)
    real = None if references is None else read_folder(references, _beside(references))
    found = judge_motions(sets, real, load_model(model), labels=known, synonyms=synonyms, repeats=repeats, seed=seed)
    _print(found, form, {})


def _print(found: Judgement, form: Form, more: dict[str, object]) -> None:
    from search.cli import terminal
    from search.judging import judgement_tables

    rows = {"csv": judgement_tables.csv_rows, "latex": judgement_tables.latex_rows}
    print_rows(*rows.get(form, judgement_tables.figure_rows)(found), found.as_dict() | more, form)
    for line in judgement_tables.remarks(found):
        terminal.note(line)


def _beside(folder: Path) -> Path | None:
    return folder / _BESIDE if (folder / _BESIDE).is_file() else None


def _same_names(folders: tuple[Path, ...], sets: list[list[JudgedMotion]]) -> None:
    """Raise where folders that should be repeats hold different motions."""
    names = [{one.name for one in motions} for motions in sets]
    for folder, other in zip(folders[1:], names[1:], strict=True):
        if other != names[0]:
            odd = sorted(other ^ names[0])
            raise QueryError(
                f"{folder}: {len(other)} motions, {folders[0]} has {len(names[0])}; {odd[0]} is not in both, "
                "so they are no repeats"
            )


def _labels(path: Path) -> tuple[list[str], list[frozenset[str]]]:
    """Labels of a file, and the sets of those that share a line, parted by tabs or commas."""
    try:
        lines = path.read_text("utf-8-sig").splitlines()
    except (OSError, UnicodeDecodeError) as error:
        raise QueryError(f"{path}: cannot be read as labels ({error})") from error
    groups = [[name.strip() for name in line.replace("\t", ",").split(",") if name.strip()] for line in lines]
    known = [name for group in groups for name in group]
    if not known:
        raise QueryError(f"{path}: holds no label")
    if len(set(known)) < len(known):
        raise QueryError(f"{path}: has a label twice: {max(known, key=known.count)!r}")
    return known, [frozenset(group) for group in groups if len(group) > 1]


def _timelines(
    folder: Path, timelines: Path, references: Path | None, crops: Path | None, encoder: Encoder, seed: int, form: Form
) -> None:
    from search.export.replacing import write_text
    from search.judging.timeline_figures import crop_table, judge_timelines
    from search.judging.timeline_files import read_references, read_timelines

    if references is not None and references.is_dir():
        raise QueryError(f"{references}: with --timelines references are a table with the columns text and path")
    known = None if references is None else read_references(references)
    found, rows = judge_timelines(read_timelines(timelines, folder), known, encoder, seed=seed)
    if crops is not None:
        write_text(crops, crop_table(rows))
    _print(found, form, {"crops": [row.as_dict() for row in rows]})
