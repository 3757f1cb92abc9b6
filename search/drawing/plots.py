"""Pictures: strips of poses, and similarity over time with the spans found."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from encoders.drawing.capsules import CAPSULES, RADII, TINTS, VIEW, capsules, heading, view_axes
from encoders.errors import QueryError
from encoders.motion import Motion
from search.export.replacing import replacing
from search.hits import Hit
from search.query.question import Question
from search.source import MotionSource

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_INK, _PALE = "#22262e", "#8b93a1"
_LINES = ("#2e6f95", "#d1495b", "#3c8d5a", "#8a5fb0", "#c98a1b")
_FOUND, _TRUE = "#f2c14e", "#3c8d5a"
_TINT = np.array([TINTS[c.part] for c in CAPSULES]) / 255
_POSES, _SPACING = 9, 1.35


def plot_poses(path: Path, groups: Sequence[tuple[str, Sequence[tuple[str, Motion]]]]) -> None:
    """Draw motions as a picture, each a strip of poses from its start to its end.

    Parameters
    ----------
    groups : sequence of (title, sequence of (label, Motion))
    """
    rows = [(title if i == 0 else "", *row) for title, part in groups for i, row in enumerate(part)]
    figure = _figure(7.8, 1.45 * max(len(rows), 1) + 0.3 * len(groups))
    axes = figure.subplots(max(len(rows), 1), 1, squeeze=False)[:, 0]
    for ax, (title, label, motion) in zip(axes, rows, strict=False):
        places = np.arange(_POSES) * _SPACING
        _poses(ax, motion, np.linspace(0, motion.duration, _POSES), places)
        ax.set_xlim(-_SPACING / 2, places[-1] + _SPACING / 2)
        ax.set_anchor("W")
        ax.set_title(label, fontsize=8.5, color=_PALE, loc="left", pad=2)
        if title:
            ax.set_title(title + "\n", fontsize=12, color=_INK, loc="left", pad=4)
            ax.text(0, 1.02, label, fontsize=8.5, color=_PALE, transform=ax.transAxes)
    if not rows:
        axes[0].axis("off")
    _save(figure, path)


def plot_moments(
    path: Path,
    question: Question,
    source: MotionSource,
    found: Sequence[Hit],
    times: NDArray[np.float64],
    similarity: NDArray[np.float32],
) -> None:
    """Draw similarity over time as a picture: poses above, a curve a sentence, spans found, the captions' spans below.

    Parameters
    ----------
    times : float64 array (T,)
        Seconds.
    similarity : float32 array (S, T)
        Of each of the question's sentences.
    """
    figure = _figure(11, 4.6)
    above, ax = figure.subplots(2, 1, height_ratios=(1, 2.2))
    at = np.linspace(0, source.duration, 15)[1:-1]
    _poses(above, source.motion, at, source.start + at, scale=source.duration / 16)
    above.set_xlim(source.start, source.end)
    above.set_title(f"{source.path}   ({source.duration:.1f} s)", fontsize=9, color=_PALE, loc="left")
    low, high = float(similarity.min()), float(similarity.max())
    room = max(high - low, 0.05)
    ax.set_ylim(low - 0.22 * room, high + 0.22 * room)
    for i, (text, values) in enumerate(zip(question.sentences, similarity, strict=True)):
        ax.plot(times, values, color=_LINES[i % len(_LINES)], lw=1.3, label=f"“{text}”")
    for start, end, name, colour, alpha in _marks(found):
        ax.axvspan(start, end, color=colour, alpha=alpha, lw=0)
        ax.text((start + end) / 2, high + 0.1 * room, name, ha="center", va="bottom", fontsize=8, color=_INK)
    for caption in source.captions:
        if caption.start is not None and caption.end is not None:
            ax.plot([caption.start, caption.end], [low - 0.1 * room] * 2, color=_TRUE, lw=5, solid_capstyle="butt")
            ax.text(caption.start, low - 0.2 * room, caption.text, fontsize=7, color=_TRUE, clip_on=True)
    ax.set_xlim(source.start, source.end)
    ax.set_xlabel("seconds", fontsize=9, color=_INK)
    ax.set_ylabel("similarity", fontsize=9, color=_INK)
    ax.tick_params(labelsize=8, colors=_INK)
    ax.spines[["top", "right"]].set_visible(False)
    above_axes = {"loc": "lower right", "bbox_to_anchor": (1, 1), "borderaxespad": 0.0}
    ax.legend(fontsize=8.5, frameon=False, ncols=min(len(question.sentences), 3), **above_axes)
    _save(figure, path)


def _marks(found: Sequence[Hit]) -> list[tuple[float, float, str, str, float]]:
    """Start, end, name, colour and opacity of each span: steps in the colours of their curves, hits by rank."""
    steps = [
        (step.start, step.end, str(i + 1), _LINES[i % len(_LINES)], 0.2)
        for hit in found
        for i, step in enumerate(hit.steps)
    ]
    return steps or [(h.start, h.end, str(h.rank), _FOUND, 0.45 if h.rank == 1 else 0.2) for h in found]


def _figure(width: float, height: float) -> Figure:
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=(width, height), layout="constrained", facecolor="white")
    FigureCanvasAgg(figure)
    return figure


def refuse_format(path: Path) -> None:
    """Stop before anything is done where a picture of this ending cannot be written.

    Raises
    ------
    QueryError
        If it cannot.
    """
    from matplotlib.backends.backend_agg import FigureCanvasAgg

    if path.suffix[1:].lower() not in FigureCanvasAgg.get_supported_filetypes():
        raise QueryError(f"{path}: no picture can be written in this format; end its name in .png, .jpg, .svg or .pdf")


def _save(figure: Figure, path: Path) -> None:
    refuse_format(path)
    with replacing(path) as file:
        figure.savefig(file, dpi=130, format=path.suffix[1:].lower())


def _poses(
    ax: Axes, motion: Motion, times: NDArray[np.float64], places: NDArray[np.floating], *, scale: float = 1.0
) -> None:
    """Draw the poses at `times`, in seconds, at `places` along x, on a ground line; `scale` widens x against y."""
    from matplotlib.collections import PolyCollection

    outlines, nearness = _seen(motion, np.clip(np.round(times * motion.fps).astype(int), 0, len(motion) - 1))
    outlines[..., 0] = outlines[..., 0] * scale + places[:, None, None]
    for pose, near in zip(outlines, nearness, strict=True):
        order = np.argsort(near)
        ax.add_collection(PolyCollection(list(pose[order]), facecolors=_TINT[order], linewidths=0, clip_on=False))
    ax.axhline(0, color=_PALE, lw=0.8, zorder=0)
    ax.set_ylim(-0.08, max(1.9, float(outlines[..., 1].max()) + 0.1))
    if scale == 1.0:
        ax.set_aspect("equal")
    ax.axis("off")


def _seen(motion: Motion, frames: NDArray[np.integer]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Outlines (N, C, K, 2) of the capsules of N poses and how near the viewer they are (N, C).

    In metres to the right of the pelvis, above the ground and towards the viewer.
    """
    ground = np.percentile(motion.joints[..., 1].min(axis=1), 5)
    below = motion.joints[frames, :1] * np.array([1, 0, 1]) + np.array([0, ground, 0])
    ends = capsules(motion.joints[frames] - below.astype(np.float32)).astype(np.float64)
    ends = ends @ view_axes(heading(motion.joints) + VIEW).T
    along = ends[..., 1, :2] - ends[..., 0, :2]
    angles = np.arctan2(along[..., 1], along[..., 0])[..., None] + np.linspace(-np.pi / 2, np.pi / 2, 7)
    halves = [
        ends[..., end, None, :2] + RADII[:, end, None, None] * np.stack([np.cos(turned), np.sin(turned)], axis=-1)
        for end, turned in ((1, angles), (0, angles + np.pi))
    ]
    return np.concatenate(halves, axis=-2), ends[..., 2].mean(axis=-1)
