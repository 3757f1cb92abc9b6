"""The model card: every figure of a bundle, measured now and written as one page."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from pathlib import Path

import numpy as np

from encoders.bundle.bundle import Bundle
from encoders.corpus.composition.seeds import TEST
from encoders.corpus.composition.synthetic_pairs import SyntheticClip, synthetic_clips
from encoders.features.registry import FEATURE_KINDS
from indexer.datasets.captioned_takes import captioned_takes
from search.evaluate.captioned_archive import evaluate_described
from search.evaluate.corpus_retrieval import evaluate_corpus
from search.evaluate.labelled_archive import LabelReport, evaluate_labels
from search.evaluate.out_of_domain import evaluate_nonsense

_ABOUT = """# The model

Made by `motionseek model card`; every figure below was measured by that command on the bundle named here.

| | |
|---|---|
| name | {name} |
| fingerprint | `{fingerprint}` |
| size | {megabytes:.1f} MB |
| what it is | TMR (ICCV 2023) on {kind} features at {fps:g} frames a second, {latent} numbers a vector |
| language model | {language}, frozen, inside `text.onnx` |
| training | {training} |
| licence | {licence} |

Trained on motion made by rule (`encoders/corpus`) and on takes of the CMU Graphics Lab Motion Capture Database
(mocap.cs.cmu.edu, created with funding from NSF EIA-0196217) with sentences of HumanML3D (MIT). Nothing marked for
evaluation only was trained on or selected on.
"""


def card(
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
        Captioned takes; their split "val" is asked.
    labelled : Path, optional
        A folder with labels.tsv and queries.tsv.
    count : int
        Made clips in the gallery.
    """
    clips = list(synthetic_clips(TEST, count, FEATURE_KINDS[bundle.feature_kind]))
    parts = [_about(bundle), *_made(clips, bundle)]
    if real is not None and captions is not None:
        parts += _real(real, captions, bundle)
    if labelled is not None:
        parts += _labelled(evaluate_labels(labelled, Path("labels.tsv"), Path("queries.tsv"), bundle))
    return "\n".join(parts) + "\n"


def _about(bundle: Bundle) -> str:
    manifest = bundle.manifest
    size = sum((bundle.folder / name).stat().st_size for name in manifest["files"])
    return _ABOUT.format(
        name=bundle.name,
        fingerprint=bundle.fingerprint[:16],
        megabytes=size / 1e6,
        kind=f"`{bundle.feature_kind}`",
        fps=bundle.fps,
        latent=bundle.latent_size,
        language=manifest["language_model"],
        training=", ".join(f"{key} {value}" for key, value in manifest["training"].items()),
        licence=manifest["licence"],
    )


def _made(clips: Sequence[SyntheticClip], bundle: Bundle) -> list[str]:
    figures = evaluate_corpus(clips, bundle)
    rows = [(name, *(f"{v:.1f}" for v in row.values())) for name, row in figures.items() if "R@1" in row]
    some = bundle.encode_features([clip.features for clip in clips[:300]])
    nonsense = evaluate_nonsense(bundle, some)
    swapped = figures.get("swapped", {"told apart": 0.0, "pairs": 0.0})
    return [
        f"## {len(clips)} made motions that nobody trained on\n",
        table(("", "R@1", "R@2", "R@3", "R@5", "R@10", "median rank"), rows),
        f"\nSwapped pairs (order, side, direction or count changed), true sentence above the false one: "
        f"{swapped['told apart']:.1f} % of {swapped['pairs']:.0f}.",
        f"\nSentences about other things ({nonsense['sentences']:.0f}) called strong: {nonsense['strong']:.0f} %, "
        f"plausible: {nonsense['plausible']:.0f} %.\n",
    ]


def _real(folder: Path, captions: Path, bundle: Bundle) -> list[str]:
    report = evaluate_described(captioned_takes(folder, captions, "val"), bundle)
    worst = sorted(report.ranks.items(), key=lambda row: -float(np.mean(row[1])))[:8]
    return [
        f"## {report.files} real takes of the validation split\n",
        "For each description and each sentence people wrote, the rank of the best file it describes; averaged over "
        f"{len(report.ranks)} descriptions.\n",
        table(("first", "found"), [(str(k), f"{report.found(k):.1f} %") for k in (1, 5, 10)]),
        f"\nMotion to sentence, first of all these sentences right: {report.told:.1f} % "
        f"({report.told_by_cosine:.1f} % by cosine alone).\n",
        "Found worst (mean rank): " + "; ".join(f"{text} ({np.mean(row) + 1:.0f})" for text, row in worst) + ".\n",
    ]


def _labelled(report: LabelReport) -> list[str]:
    rows = [
        (label, str(report.clips[label]), f"{np.mean(row):.3f}", ", ".join(f"{p:.2f}" for p in row))
        for label, row in report.precisions.items()
    ]
    rows.append(("**mean**", str(sum(report.clips.values())), f"**{report.mean:.3f}**", ""))
    return [
        "## A labelled archive it has never seen (reported, never selected on)\n",
        table(("label", "clips", "mean average precision", "of each query"), rows),
        f"\nMotion to sentence, right among the labels at rank 1: {100 * report.top1:.1f} %.\n",
        "What each label's clips are taken for (rows: the label; columns: the nearest sentence's), in percent:\n",
        confusion(report),
    ]


def confusion(report: LabelReport) -> str:
    """Per-class confusion as a table."""
    labels = list(report.confusion)
    rows = [(label, *(f"{100 * share:.0f}" for share in report.confusion[label].values())) for label in labels]
    return table(("", *labels), rows)


def table(header: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """A Markdown table."""
    lines = [header, ["---"] * len(header), *rows]
    return "\n".join("| " + " | ".join(line) + " |" for line in lines)
