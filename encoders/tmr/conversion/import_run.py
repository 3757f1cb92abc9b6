"""A published run becomes a bundle that answers as the run does: the same vectors, without torch."""

from __future__ import annotations

import warnings
from pathlib import Path

import numpy as np
import torch

from encoders.bundle.bundle import Bundle
from encoders.corpus.composition.seeds import CALIBRATION
from encoders.corpus.composition.synthetic_pairs import synthetic_clips
from encoders.errors import BundleError, MotionSeekWarning
from encoders.features.registry import FEATURE_KINDS, FeatureKind, feature_kind
from encoders.tmr.conversion.from_published import PublishedData, load_run, load_stats, read_config, read_data
from encoders.tmr.conversion.to_bundle import export_bundle, replacing
from encoders.tmr.model.network import TMR
from encoders.tmr.model.padding import pad
from encoders.tmr.text.hub import language_folder
from encoders.tmr.text.language_model import LanguageModel

#: Kinds of features by the names that their folders have in published data.
_KINDS = {"guoh3dfeats": "humanml3d"}
#: Seconds of the longest motion that is encoded as a whole, as the published code does with any. No clip of the
#: published test sets is longer; longer takes are the mean of windows, as for any bundle.
_WHOLE = 100.0
#: How far a number of a unit vector may be from the run's.
_EXACT = 1e-4
#: Synthetic clips that statistics are tried on, and standard deviations: with the published statistics the farthest
#: feature lies at 3 (HumanML3D) and 4 (KIT-ML), with axes, units, or mean and deviation exchanged beyond 18.
_TRIED, _FARTHEST = 20, 10.0
_SENTENCES = ("a person walks", "someone sits down on a chair and then stands up again", "jumps")


def import_run(
    run: Path,
    folder: Path,
    *,
    name: str,
    stats: Path | None = None,
    language_model: str | None = None,
    features: str | None = None,
    decoder: bool = False,
) -> tuple[Bundle, float]:
    """Write the bundle of a run; one already in `folder` is replaced when the new one is complete.

    Parameters
    ----------
    run : Path
        Directory with config.json and weights; see `encoders.tmr.conversion.from_published`.
    folder : Path
        Where the bundle is written.
    stats : Path, optional
        Folder of mean and standard deviation. If not given, the one that the configuration names is looked for in the
        run's folder, those above it, and the working directory.
    language_model : str, optional
        Folder, or name on the Hugging Face hub; the one that the configuration names if not given.
    features : str, optional
        Feature kind, where the configuration's name of it is not known.
    decoder : bool
        Also write the run's decoder, to generate motion with.

    Returns
    -------
    bundle : Bundle
    difference : float
        The largest difference of a number between vectors of the bundle and of the run.

    Raises
    ------
    BundleError
        If anything is missing, damaged, or does not fit the rest; the message says what.
    """
    sizes, data = read_config(run), read_data(run)
    kind = kind_of_run(run, data, features)
    if sizes.motion.features != kind.size or data.size != kind.size:
        stated = sorted({sizes.motion.features, data.size})
        raise BundleError(f"{run / 'config.json'}: {stated} numbers a frame, features {kind.name!r} have {kind.size}")
    place = statistics_of_run(run, data) if stats is None else stats
    mean, std = load_stats(place, kind.size)
    _warn_of_unlikely(place, kind, mean, std)
    network = load_run(run)
    language = _language(run, data, network, language_model)
    with replacing(folder) as new:
        export_bundle(
            new,
            name=name,
            motion_encoder=network.motion_encoder,
            text_encoder=network.text_encoder,
            language=language,
            mean=mean,
            std=(std.astype(np.float64) + data.epsilon).astype(np.float32),
            feature_kind=kind.name,
            max_frames=round(_WHOLE * kind.fps),
            weights="float32",
            licence="that of the imported weights",
            training={
                "imported": run.resolve().name,
                "features": Path(data.features).name,
                "statistics": data.statistics,
            },
            decoder=network.motion_decoder if decoder else None,
        )
        difference = _difference(Bundle.load(new), network, language, mean, std)
        if not difference < _EXACT:
            raise BundleError(f"{run}: the bundle's vectors differ from the run's by {difference:.1e}; report this")
    return Bundle.load(folder), difference


def kind_of_run(run: Path, data: PublishedData, named: str | None = None) -> FeatureKind:
    """The feature kind of a run: the one named, else the one whose folder its configuration names.

    Raises
    ------
    BundleError
        If it is not known, or has another frame rate.
    """
    stated = Path(data.features).name
    if named is None and stated not in _KINDS:
        try:
            kind = feature_kind(stated)
        except BundleError as error:
            raise BundleError(
                f"{run / 'config.json'}: trained on {stated!r}, features that are not known here; known are "
                f"{', '.join([*_KINDS, *FEATURE_KINDS])}; another package can add them (docs/encoders.md)"
            ) from error
    else:
        kind = feature_kind(named or _KINDS[stated])
    if kind.fps != data.fps:
        raise BundleError(
            f"{run / 'config.json'}: trained at {data.fps:g} frames a second, features {kind.name!r} have {kind.fps:g}"
        )
    return kind


def statistics_of_run(run: Path, data: PublishedData) -> Path:
    """The folder of statistics that a configuration names, relative to wherever the run was started.

    Raises
    ------
    BundleError
        If it is neither in the run's folder, nor above it, nor in the working directory.
    """
    resolved = run.resolve()
    for above in (resolved, *resolved.parents, Path.cwd()):
        if (above / data.statistics).is_dir():
            return above / data.statistics
    raise BundleError(
        f"{run}: its statistics {data.statistics} are neither in its folder nor above it; name the folder that holds "
        "mean.pt and std.pt (--stats DIR; the published repository has it)"
    )


def _warn_of_unlikely(place: Path, kind: FeatureKind, mean: np.ndarray, std: np.ndarray) -> None:
    """Warn where human movement lies far outside of statistics: they are of other axes, units or features."""
    rows = np.concatenate([clip.features for clip in synthetic_clips(CALIBRATION, _TRIED, kind)])
    far = np.sqrt((((rows - mean) / std) ** 2).mean(axis=0))
    if far.max() > _FARTHEST:
        warnings.warn(
            f"{place}: feature {far.argmax()} of human movement lies {far.max():.0f} standard deviations from this "
            f"mean; are these statistics of {kind.name!r}, in metres with Y up, and mean and std not exchanged?",
            MotionSeekWarning,
            stacklevel=3,
        )


def _language(run: Path, data: PublishedData, network: TMR, given: str | None) -> LanguageModel:
    """The language model, once it has proved to be the one that the run was trained with."""
    wanted = data.language_model
    name = wanted.rpartition("/")[2]
    if given is not None and not Path(given).is_dir() and given.rpartition("/")[2] != name:
        raise BundleError(f"{run / 'config.json'}: trained with the language model {wanted}, not with {given}")
    folder = language_folder(given or wanted)
    language = LanguageModel.load(folder, name=name, max_tokens=None)
    size = network.text_encoder.config.features
    is_distilled = language.network.config.segments == 0
    lowers = language.tokenize(["A Person"]) == language.tokenize(["a person"])
    differs = {
        f"its tokens have {language.width} numbers, the run reads {size}": language.width != size,
        f"it is {'DistilBERT' if is_distilled else 'BERT'}": ("distil" in name.lower()) != is_distilled,
        "it tells capital letters apart": "uncased" in name.lower() and not lowers,
        "it does not tell capital letters apart": "-cased" in name.lower() and lowers,
    }
    wrong = [what for what, does in differs.items() if does]
    if wrong:
        raise BundleError(f"{folder}: not {wanted}, with which the run was trained: {'; '.join(wrong)}")
    return language


def _difference(bundle: Bundle, network: TMR, language: LanguageModel, mean: np.ndarray, std: np.ndarray) -> float:
    """The largest difference between what bundle and run make of some motions and sentences."""
    rng = np.random.default_rng(0)
    motions = [mean + std * rng.normal(size=(frames, len(mean))) for frames in (7, 120, 200)]
    standardised = [((motion - mean) / std).astype(np.float32) for motion in motions]
    with torch.inference_mode():
        expected = [
            encoder.mean(*pad(rows)).numpy()
            for encoder, rows in (
                (network.motion_encoder, standardised),
                (network.text_encoder, language.token_features(_SENTENCES)),
            )
        ]
    found = bundle.encode_features([motion.astype(np.float32) for motion in motions]), bundle.encode_texts(_SENTENCES)
    return max(
        float(np.abs(ours - theirs / np.linalg.norm(theirs, axis=1, keepdims=True)).max())
        for ours, theirs in zip(found, expected, strict=True)
    )
