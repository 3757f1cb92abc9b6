"""A judgement of generated motions: every figure beside that of real motions, with intervals over repeats."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from encoders.errors import QueryError
from encoders.protocol import Encoder
from search.judging.encoded_motions import EncodedMotions
from search.judging.figure_kinds import FIGURES
from search.judging.generated_figures import Comparison, Figures, Missing, drawn_figures, fixed_figures
from search.judging.metrics.repeats import mean_and_interval
from search.judging.metrics.scopes import WINDOW
from search.judging.motion_table import JudgedMotion, paired

#: Repeats of random draws, as the papers have them.
REPEATS = 20


@dataclass(frozen=True)
class Measured:
    """A figure: its mean over repeats, the half-width of its 95 % interval, nan where nothing is drawn, and repeats."""

    value: float
    interval: float
    repeats: int


@dataclass(frozen=True)
class Judgement:
    """Figures by the names of `figure_kinds.FIGURES`.

    Attributes
    ----------
    evaluator : str
        Name and beginning of the fingerprint of the model whose vectors are compared.
    motions, references : int
        How many; of the first folder.
    generated, real : {figure: Measured}
        `real`: of the references, by themselves.
    missing : {figure: why the generated motions have none}
    short : list of str
        Names of motions of the first folder that are too short for a window of long motion.
    """

    evaluator: str
    motions: int
    references: int
    generated: Mapping[str, Measured]
    real: Mapping[str, Measured]
    missing: Missing
    short: Sequence[str] = ()

    def as_dict(self) -> dict[str, Any]:
        """Plain values, for JSON."""
        return {
            "evaluator": self.evaluator,
            "motions": self.motions,
            "references": self.references,
            "figures": {
                name: {
                    "name": kind.name,
                    "unit": kind.unit,
                    "better": kind.aim,
                    "source": kind.source,
                    "generated": _plain(self.generated.get(name)),
                    "real": _plain(self.real.get(name)),
                }
                for name, kind in FIGURES.items()
                if name in self.generated
            },
            "missing": dict(self.missing),
            "too short for a window": list(self.short),
        }


def judge(
    sets: Sequence[Sequence[JudgedMotion]],
    real: Sequence[JudgedMotion] | None,
    encoder: Encoder,
    *,
    labels: Sequence[str] = (),
    synonyms: Sequence[frozenset[str]] = (),
    repeats: int = REPEATS,
    seed: int = 0,
) -> Judgement:
    """Judge what a generator made.

    Parameters
    ----------
    sets : sequence of sets of motions
        One set: figures with random draws are the means of `repeats` draws. Several: each is a repeat, generated with
        another seed, with draws of its own.
    real : sequence of JudgedMotion, optional
        Real motions. They are given the text and label of the motion whose reference they are.
    labels : sequence of str
        The recogniser's labels; by default those that are asked for.

    Raises
    ------
    QueryError
        If some motions have a reference and others none; see `motion_table.paired`.
    """
    chosen = list(labels) or sorted({one.label for motions in sets for one in motions if one.label})
    unknown = sorted({one.label for motions in sets for one in motions if one.label} - set(chosen))
    if unknown:
        raise QueryError(f"the label {unknown[0]!r} is asked for and is none of the {len(chosen)} labels")
    pairs = [None if real is None else paired(motions, real) for motions in sets]
    references = None if real is None else EncodedMotions(_described(real, sets[0], pairs[0]), encoder)
    cases = [
        Comparison(EncodedMotions(motions, encoder), references, own, chosen, synonyms)
        for motions, own in zip(sets, pairs, strict=True)
    ]
    generated, missing = _repeated(cases, repeats, seed)
    of_real: dict[str, Measured] = {}
    if references is not None:
        itself = Comparison(references, references, range(len(references.motions)), chosen, synonyms)
        measured, _ = _repeated([itself], repeats, seed)
        of_real = {name: figure for name, figure in measured.items() if name in generated}
    evaluator = f"{encoder.name} ({encoder.fingerprint[:12]})"
    short = [one.name for one in sets[0] if len(one.motion) < WINDOW]
    return Judgement(evaluator, len(sets[0]), len(real or ()), generated, of_real, missing, short)


def _described(
    real: Sequence[JudgedMotion], motions: Sequence[JudgedMotion], pairs: Sequence[int] | None
) -> list[JudgedMotion]:
    """Real motions with the sentence and label of what was generated for them."""
    said = {} if pairs is None else {place: motions[i] for i, place in reversed(list(enumerate(pairs)))}
    return [
        replace(
            one,
            text=one.text or (said[i].text if i in said else ""),
            label=one.label or (said[i].label if i in said else ""),
        )
        for i, one in enumerate(real)
    ]


def _repeated(cases: Sequence[Comparison], repeats: int, seed: int) -> tuple[dict[str, Measured], Missing]:
    """Figures over repeats: of draws for a single set, else of sets."""
    count = repeats if len(cases) == 1 else len(cases)
    drawn = [drawn_figures(cases[i % len(cases)], seed + i) for i in range(count)]
    return averaged([*map(fixed_figures, cases), *drawn])


def averaged(repeats: Sequence[tuple[Figures, Missing]]) -> tuple[dict[str, Measured], Missing]:
    """Each figure over the repeats that have it; one that is missing in any is missing."""
    missing: Missing = {}
    values: dict[str, list[float]] = {}
    for figures, reasons in repeats:
        missing |= reasons
        for name, value in figures.items():
            values.setdefault(name, []).append(value)
    return {
        name: Measured(*mean_and_interval(values[name]), len(values[name]))
        for name in FIGURES
        if name in values and name not in missing
    }, missing


def _plain(figure: Measured | None) -> dict[str, float | int | None] | None:
    if figure is None:
        return None
    interval = None if np.isnan(figure.interval) else figure.interval
    return {"value": figure.value, "interval": interval, "repeats": figure.repeats}
