"""The model card: all figures of a bundle, measured now and written as one page of Markdown."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from encoders.bundle.bundle import Bundle
from encoders.corpus.composition.seeds import TEST
from encoders.corpus.composition.synthetic_pairs import SyntheticClip, synthetic_clips
from encoders.features.registry import feature_kind
from indexer.datasets.captioned_takes import captioned_takes
from indexer.datasets.labelled_clips import labelled_clips
from search.evaluate.captioned_archive import CaptionReport, evaluate_captions
from search.evaluate.corpus_retrieval import evaluate_corpus
from search.evaluate.labelled_archive import LabelReport, evaluate_labels
from search.evaluate.markdown import markdown_table
from search.evaluate.out_of_domain import evaluate_out_of_domain

_ABOUT = """# The model

Written by `motionseek model card`; every figure below was measured by that command on the bundle named here.

| | |
|---|---|
| name | {name} |
| fingerprint | `{fingerprint}` |
| size | {megabytes:.1f} MB |
| architecture | TMR (ICCV 2023) on {kind} features at {fps:g} frames a second, {latent} numbers a vector |
| language model | {language}, frozen, inside `text.onnx` |
| training | {training} |
| licence | {licence} |

Trained on synthetic motion (`encoders/corpus`) and on takes of the CMU Graphics Lab Motion Capture Database
(mocap.cs.cmu.edu, created with funding from NSF EIA-0196217) with sentences of HumanML3D (MIT). Nothing that is for
evaluation only was trained on or selected on.
"""
#: Clips that out-of-domain sentences are compared with.
_OUT_OF_DOMAIN_CLIPS = 300


def model_card(
    bundle: Bundle,
    *,
    real: Path | None = None,
    captions: Path | None = None,
    labelled: Path | None = None,
    count: int = 4000,
) -> str:
    """Measure a bundle and describe it in Markdown.

    Parameters
    ----------
    real, captions : Path, optional
        Folder of captioned takes and their captions, of which the split "val" is evaluated.
    labelled : Path, optional
        Folder with labels.tsv and queries.tsv.
    count : int
        Synthetic clips in the gallery.

    Raises
    ------
    QueryError
        If a table or the captions cannot be read.
    BundleError
        If the bundle carries no calibration.
    """
    clips = list(synthetic_clips(TEST, count, feature_kind(bundle.feature_kind)))
    parts = [_about(bundle), *_synthetic(clips, bundle)]
    if real is not None and captions is not None:
        parts += _captioned(evaluate_captions(captioned_takes(real, captions, "val"), bundle))
    if labelled is not None:
        parts += _labelled(evaluate_labels(labelled_clips(labelled), bundle))
    return "\n".join(parts) + "\n"


def _about(bundle: Bundle) -> str:
    manifest = bundle.manifest
    return _ABOUT.format(
        name=bundle.name,
        fingerprint=bundle.fingerprint[:16],
        megabytes=bundle.megabytes,
        kind=f"`{bundle.feature_kind}`",
        fps=bundle.fps,
        latent=bundle.latent_size,
        language=manifest["language_model"],
        training=", ".join(f"{key} {value}" for key, value in manifest["training"].items()),
        licence=manifest["licence"],
    )


def _synthetic(clips: Sequence[SyntheticClip], bundle: Bundle) -> list[str]:
    figures = evaluate_corpus(clips, bundle)
    rows = [(name, *(f"{v:.1f}" for v in row.values())) for name, row in figures.items() if "R@1" in row]
    gallery = bundle.encode_features([clip.features for clip in clips[:_OUT_OF_DOMAIN_CLIPS]])
    out_of_domain = evaluate_out_of_domain(bundle, gallery)
    negatives = figures.get("hard negatives", {"accuracy": 0.0, "pairs": 0.0})
    return [
        f"## {len(clips)} synthetic clips held out of training\n",
        markdown_table(("", "R@1", "R@2", "R@3", "R@5", "R@10", "median rank"), rows),
        f"\nHard negatives (order, side, direction or count changed), caption ranked above its negative: "
        f"{negatives['accuracy']:.1f} % of {negatives['pairs']:.0f}.",
        f"\nOut-of-domain sentences ({out_of_domain['sentences']:.0f}) called strong: {out_of_domain['strong']:.0f} %, "
        f"plausible: {out_of_domain['plausible']:.0f} %.\n",
    ]


def _captioned(report: CaptionReport) -> list[str]:
    worst = sorted(report.ranks.items(), key=lambda row: -float(np.mean(row[1])))[:8]
    return [
        f"## {report.files} real takes of the validation split\n",
        "For each description and each caption of its files, the rank of the best file with the description; averaged "
        f"over {len(report.ranks)} descriptions.\n",
        markdown_table(("R@k", "percent"), [(str(k), f"{report.recall(k):.1f} %") for k in (1, 5, 10)]),
        f"\nMotion to sentence, R@1 among all these sentences: {report.motion_to_sentence:.1f} % "
        f"({report.motion_to_sentence_by_cosine:.1f} % by cosine alone).\n",
        "Worst mean ranks: " + "; ".join(f"{text} ({np.mean(row) + 1:.0f})" for text, row in worst) + ".\n",
    ]


def _labelled(report: LabelReport) -> list[str]:
    rows = [
        (label, str(report.clips[label]), f"{np.mean(row):.3f}", ", ".join(f"{p:.2f}" for p in row))
        for label, row in report.precisions.items()
    ]
    rows.append(("**mean**", str(sum(report.clips.values())), f"**{report.mean:.3f}**", ""))
    labels = list(report.confusion)
    confusion = [(label, *(f"{100 * share:.0f}" for share in report.confusion[label].values())) for label in labels]
    return [
        "## A labelled archive held out of training and of model selection\n",
        markdown_table(("label", "clips", "mean average precision", "of each query"), rows),
        f"\nMotion to sentence, R@1 among one sentence of each label: {100 * report.top1:.1f} %.\n",
        "Confusion in percent (row: the clips' label; column: the label of their nearest sentence):\n",
        markdown_table(("", *labels), confusion),
    ]
