"""`motionseek generate`: motions for a sentence, made by a model with a decoder, and how good the model finds them."""

from __future__ import annotations

from pathlib import Path

import click

from encoders.errors import BundleMismatch, LibraryError, LibraryNotFound, QueryError
from search.cli import options
from search.cli.path_types import NEW_FILE


@click.command()
@click.argument("sentence")
@click.argument("out", type=NEW_FILE)
@click.option("--label", "is_label", is_flag=True, help="SENTENCE is a label that the model knows, such as 'kick'.")
@click.option("--seconds", type=options.Number(min=0.1), default=4.0, show_default=True, help="Of each motion.")
@click.option("--samples", type=options.Count(1, 64), default=1, show_default=True, help="Motions that are drawn.")
@click.option("--seed", type=options.Count(0), default=0, show_default=True, help="Of the draws.")
@options.model
@options.force
@options.library
@options.as_json
def generate(
    sentence: str,
    out: Path,
    is_label: bool,
    seconds: float,
    samples: int,
    seed: int,
    model: str | None,
    force: bool,
    folder: str | None,
    as_json: bool,
) -> None:
    """Generate motions for SENTENCE and write them to OUT, a .bvh, .glb, .npz or .npy file.

    Several samples are OUT-1, OUT-2 and so on. Each is printed with its TMR-score, 0.5 for unrelated, 1 for the best
    there is, beside that of the best clip of the library: real motion is what to compare with, and mostly better. The
    model must have a decoder; docs/generating.md says how one is trained.

    \b
    Examples:
      motionseek generate "a person kicks with the left leg" kick.bvh --model my_generator/ --samples 3
      motionseek generate kick kick.bvh --label --seconds 3 --model my_generator/
    """
    import numpy as np

    from encoders.bundle.bundle import Bundle
    from encoders.bundle.generator import MotionGenerator
    from encoders.bundle.known_models import load_model
    from search.cli import terminal
    from search.export.cut import WRITERS, write_cut
    from search.generation import best_real, scores_of
    from search.references import source_of

    if out.suffix.lower() not in WRITERS:
        raise click.UsageError(f"{out}: unsupported format; use {', '.join(WRITERS)}")
    files = [out] if samples == 1 else [out.with_stem(f"{out.stem}-{i + 1}") for i in range(samples)]
    for file in files:
        options.refuse_overwriting(file, force)
    bundle = load_model(model)
    if not isinstance(bundle, Bundle):
        raise QueryError(f"{model}: is no bundle, so it has no decoder")
    generator = MotionGenerator(bundle)
    gaussian = generator.of_label(sentence) if is_label else generator.of_sentence(sentence)
    motions = generator.motions(gaussian, seconds, samples, np.random.default_rng(seed))
    scores = scores_of(motions, sentence, bundle)
    for file, motion in zip(files, motions, strict=True):
        write_cut(source_of(motion), file)
    real, why = None, "the library is empty"
    try:
        with options.open_library(folder) as library:
            real = best_real(library, sentence, bundle)
    except (LibraryError, BundleMismatch) as error:
        if folder:
            raise
        why = "no library here" if isinstance(error, LibraryNotFound) else str(error)
    made = [{"path": str(file), "score": score} for file, score in zip(files, scores, strict=True)]
    if as_json:
        found = None if real is None else {"path": real.path, "score": real.score}
        terminal.document({"sentence": sentence, "model": bundle.name, "generated": made, "best_real": found})
        return
    terminal.table(("TMR-score", "file"), [(f"{row['score']:.3f}", str(row["path"])) for row in made])
    if real is None:
        terminal.note(f"no real motion to compare with: {why}")
    else:
        better = sum(score > real.score for score in scores)
        terminal.note(f"best clip of the library: {real.score:.3f} {real.path}; {better} of {samples} samples above it")
