"""`motionseek model decoder`: a generator trained beside a model. Needs the extra `train`."""

from __future__ import annotations

from itertools import chain
from pathlib import Path

import click

from encoders.errors import QueryError
from search.cli import options
from search.cli.commands.model.real_archives import require_both
from search.cli.commands.model.train import real_stores, require_extra, sentences_of
from search.cli.path_types import FILE, FOLDER, NEW_FOLDER


@click.command()
@click.argument("run", type=NEW_FOLDER)
@click.argument("folder", type=NEW_FOLDER)
@options.model
@click.option("--synthetic", type=options.Count(1000), default=10_000, show_default=True, help="Synthetic clips.")
@click.option("--real", type=FOLDER, help="Folder of captioned takes with a manifest.tsv.")
@click.option("--captions", type=FILE, help="Their captions, JSON lines.")
@click.option("--sentences", type=FILE, help="Human sentences that synthetic clips act out, one a line.")
@click.option("--held-out", type=FILE, multiple=True, help="File of sentences that are never trained on.")
@click.option("--steps", type=options.Count(1), default=6000, show_default=True, help="Training steps.")
@click.option(
    "--minutes", type=click.FloatRange(min=0.1), default=float("inf"), help="Stop after so long; run again to go on."
)
@click.option("--jobs", type=options.Count(1), help="Processes that synthesise clips; one a core by default.")
def decoder(
    run: Path,
    folder: Path,
    model: str | None,
    synthetic: int,
    real: Path | None,
    captions: Path | None,
    sentences: Path | None,
    held_out: tuple[Path, ...],
    steps: int,
    minutes: float,
    jobs: int | None,
) -> None:
    """Train a decoder beside the model and write both as the bundle FOLDER, with which motions are generated.

    The model itself stays as it is: FOLDER opens the libraries of the model. Clips and weights lie in RUN; the same
    command goes on where it was stopped.

    \b
    Examples:
      motionseek model decoder runs/decoder my_generator/
      motionseek model decoder runs/decoder my_generator/ --real data/mocap --captions captions.jsonl --minutes 60
    """
    require_extra()
    require_both(real, captions)
    import numpy as np

    from encoders.bundle.bundle import Bundle
    from encoders.bundle.known_models import load_model
    from encoders.corpus.composition.seeds import TRAINING
    from encoders.corpus.heldout.queries import paraphrase_queries
    from encoders.corpus.language.held_out_sentences import HeldOutSentences
    from encoders.features.registry import feature_kind
    from encoders.tmr.conversion.with_decoder import add_generator
    from encoders.tmr.model.normaliser import Normaliser
    from encoders.tmr.synthesis.captioned_motions import captioned_motions
    from encoders.tmr.synthesis.vae_training import VAERecipe, label_gaussians, train_vae
    from encoders.tmr.training.dataset import synthetic_stores

    bundle = load_model(model)
    if not isinstance(bundle, Bundle):
        raise QueryError(f"{model}: is no bundle of this project's, so no decoder can be added to it")
    kind = feature_kind(bundle.feature_kind)
    banned = HeldOutSentences(chain(*paraphrase_queries().values(), *(sentences_of(path) for path in held_out)))
    lines = [text for text in sentences_of(sentences) if not banned(text)] if sentences else []
    stores = [synthetic_stores(run, synthetic, kind.name, lines, banned, seed=TRAINING, jobs=jobs, say=click.echo)]
    if real and captions:
        stores.append(real_stores(real, captions, kind, banned)[0])
    data = captioned_motions(stores, bundle, bundle.max_frames)
    click.echo(f"{len(data.motions)} motions, {len(data.vectors)} sentences")
    normaliser = Normaliser.of(np.concatenate([rows.astype(np.float32) for rows in data.motions[::2]]))
    trained, taken = train_vae(run, data, normaliser, VAERecipe(steps=steps), minutes=minutes, say=click.echo)
    notes = {"steps": taken, "motions": len(data.motions), "sentences": len(data.vectors)}
    labels = label_gaussians(trained, data, normaliser)
    made = Bundle.load(add_generator(bundle.folder, folder, trained, normaliser, labels, notes))
    click.echo(f"{made.name} {made.fingerprint[:12]} with a decoder in {folder}, {made.megabytes:.1f} MB")
