"""The figures of generated motion: what each is called, in which unit, which way is better, and whose it is."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

Aim = Literal["higher", "lower", "as real"]


@dataclass(frozen=True)
class FigureKind:
    """A figure's name, unit, the way it should go, and the paper that defines it."""

    name: str
    unit: str
    aim: Aim
    source: str


_STMC = "STMC (Petrovich et al., CVPRW 2024), evaluation metrics"
_T2M = "T2M (Guo et al., CVPR 2022), evaluation metrics"
_A2M = "Action2Motion (Guo et al., ACM MM 2020), evaluation metrics"
_TEMOS = "TEMOS (Petrovich et al., ECCV 2022), evaluation metrics"
_T2LM = "T2LM (Lee et al., CVPRW 2024), evaluation metrics"
_WAT = "WAT (Mao et al., CVPR 2022), evaluation metrics"
_PHYSDIFF = "PhysDiff (Yuan et al., ICCV 2023), evaluation metrics"
_PARTS = ("root", "trajectory", "local", "global")

FIGURES: dict[str, FigureKind] = {
    "score_text": FigureKind("TMR-score, motion to text", "0..1", "higher", _STMC),
    "score_motion": FigureKind("TMR-score, motion to motion", "0..1", "higher", _STMC),
    **{f"precision32_{k}": FigureKind(f"R-precision, first {k} of 32", "%", "higher", _T2M) for k in (1, 2, 3)},
    **{f"precision_{k}": FigureKind(f"R-precision, first {k} of all texts", "%", "higher", _STMC) for k in (1, 2, 3)},
    "text_distance": FigureKind("multimodal distance", "", "lower", _T2M),
    "frechet": FigureKind("Frechet distance", "", "lower", "Heusel et al. (NeurIPS 2017), eq. 6; " + _A2M),
    "frechet_crops": FigureKind("Frechet distance of 5 s crops", "", "lower", _STMC),
    "diversity": FigureKind("diversity", "", "as real", _A2M),
    "multimodality_text": FigureKind("multimodality of a text", "", "as real", _T2M),
    "multimodality_label": FigureKind("multimodality of a label", "", "as real", _A2M),
    **{f"accuracy_{k}": FigureKind(f"accuracy, first {k} labels", "%", "higher", _A2M) for k in (1, 5)},
    **{f"ape_{part}": FigureKind(f"position error, {part}", "m", "lower", _TEMOS) for part in _PARTS},
    **{f"ave_{part}": FigureKind(f"variance error, {part}", "m2", "lower", _TEMOS) for part in _PARTS},
    "transition": FigureKind("transition distance", "cm", "as real", _STMC),
    "transition_world": FigureKind(
        "transition distance, world", "m", "as real", "TEACH (Athanasiou et al., 3DV 2022), evaluation metrics"
    ),
    "displacement": FigureKind("best of many: displacement error", "m", "lower", _WAT),
    "displacement_warped": FigureKind("best of many: the same, warped", "m", "lower", _WAT),
    "futures": FigureKind("diversity of futures", "m", "higher", _WAT),
    "futures_warped": FigureKind("diversity of futures, warped", "m", "higher", _WAT),
    "sliding_frechet": FigureKind("sliding scope: Frechet distance", "", "lower", _T2LM),
    "sliding_diversity": FigureKind("sliding scope: diversity", "", "as real", _T2LM),
    "transition_frechet": FigureKind("transition scope: Frechet distance", "", "lower", _T2LM),
    "transition_diversity": FigureKind("transition scope: diversity", "", "as real", _T2LM),
    "skate": FigureKind("foot sliding", "mm a frame", "lower", _PHYSDIFF),
    "skating": FigureKind(
        "frames with a sliding foot", "%", "lower", "GMD (Karunratanakul et al., ICCV 2023), evaluation metrics"
    ),
    "penetration": FigureKind("penetration of the floor", "mm", "lower", _PHYSDIFF),
}
