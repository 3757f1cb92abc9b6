"""Clips from scenes: a random performer's curves, joined, varied as captured motion is, and posed on a skeleton."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.random import Generator

from encoders.corpus.actions.programs import parts_of, program_of
from encoders.corpus.composition.open_scenes import LASTING, complete_scene
from encoders.corpus.engine.arm_carriage import carry_idle_hands, hold_arms
from encoders.corpus.engine.clip_ends import begin_and_end
from encoders.corpus.engine.curves import ARMS, CHANNELS, Array, Curves
from encoders.corpus.engine.joining import at_rest, chain, overlay, pause, smooth_noise
from encoders.corpus.engine.posing import pose, random_geometry
from encoders.corpus.engine.stance import Stance, sample_stance, stand, step_about
from encoders.corpus.engine.style import STYLES, apply_manner, sample_individual, sample_manner
from encoders.corpus.heldout.heldout_styles import HELD_OUT_STYLES
from encoders.corpus.scene import ActionStep, Scene, SceneClip
from encoders.motion import FPS

_ALL_STYLES = {**STYLES, **HELD_OUT_STYLES}


def perform_step(
    step: ActionStep, individual: Array, rng: Generator, frames: int = 0, stance: Stance | None = None
) -> Curves:
    """Perform one step in a performer's own manner and stance; `frames` is a hint.

    Raises
    ------
    KeyError
        If the action or the style is unknown.
    """
    manner = sample_manner(step.style, individual, rng, styles=_ALL_STYLES)
    curves = program_of(step.action).make(step, manner, rng, frames)
    apply_manner(curves, manner, rng)
    return stand(curves, stance, rng) if stance else curves


#: Actions of the legs that arms may accompany in any way, beside those that occupy no arm.
_ARMS_FREE = frozenset(
    {"jump", "leap", "jump over", "land", "step over", "step up", "step down", "squat", "lunge", "side lunges", "kneel"}
    | {"crouch", "sit", "sit down", "stand up", "kick", "side kick", "roundhouse kick", "knee strike", "kick ball"}
    | {"raise leg", "raise knee", "leg swing", "stretch leg", "hurdle step", "heel raise", "balance on one leg"}
    | {"tiptoes with bent knees", "bend forward", "dodge", "get pushed"}
)
_FREE_SHARE, _STEPPING = 0.3, 0.25


def _perform_group(
    group: Sequence[ActionStep], individual: Array, stance: Stance, rng: Generator, variation: float
) -> Curves:
    """Simultaneous steps: the one that needs the legs (else the first) carries the others."""
    if len(group) == 1:
        step, parts = group[0], parts_of(group[0])
        curves = perform_step(step, individual, rng, 0, stance)
        if (step.action in _ARMS_FREE or not parts & ARMS) and rng.random() < _FREE_SHARE * variation:
            hold_arms(curves, rng)
        restless = program_of(step.action).group in ("gesture", "object", "sport", "exercise") or step.action == "stand"
        if restless and rng.random() < _STEPPING * variation:
            step_about(curves, rng, rng.uniform(0.1, 0.5 if step.action == "stand" else 1.1))
        return curves
    carrier = max(range(len(group)), key=lambda i: ("legs" in parts_of(group[i]), -i))
    extras = [(step.action, perform_step(step, individual, rng)) for i, step in enumerate(group) if i != carrier]
    longest = max(len(curves) for _, curves in extras)
    frames = int(max(longest + rng.integers(4, 24), rng.uniform(2.0, 5.0) * FPS))
    base = perform_step(group[carrier], individual, rng, frames, stance)
    for action, extra in extras:
        if action in LASTING and rng.random() < 0.6 * variation:  # held before the clip begins, and after it ends
            base = overlay(base, _stretched(extra, len(base)), 0, eased=False)
        else:
            base = overlay(base, extra, int(rng.integers(0, max(len(base) - len(extra), 0) + 1)))
    return base


def _stretched(curves: Curves, frames: int) -> Curves:
    """The middle of a movement that lasts, as many frames of it, there and back."""
    first, last = len(curves) // 3, max(len(curves) * 2 // 3, len(curves) // 3 + 2)
    there = np.arange(first, last)
    at = np.resize(np.concatenate([there, there[::-1]]), frames)
    return Curves(curves.data[at], [(0, frames)], curves.parts)


def perform_scene(scene: Scene, rng: Generator, *, variation: float = 1.0) -> Curves:
    """Perform a whole scene by one performer; one span per step group."""
    individual = sample_individual(rng) * variation
    stance = sample_stance(rng, variation)
    movements = [
        _perform_group(group, individual, stance, rng, variation) for group in complete_scene(scene, rng).steps
    ]
    movements = [
        pause(m, 0, int(rng.integers(1, 16))) if rng.random() < 0.25 * variation and at_rest(m, -1) else m
        for m in movements
    ]
    curves = chain(movements)
    if rng.random() < 0.06 * variation:
        carry_idle_hands(curves, rng)
    return begin_and_end(curves, scene, rng, variation)


#: Amplitude of slow noise on each channel: metres, radians, arm lengths.
_NOISE = np.zeros(CHANNELS)
_NOISE[[0, 1, 2]] = [0.004, 0.002, 0.004]
_NOISE[4:7] = 0.025
_NOISE[7:10] = [0.035, 0.045, 0.06]
_NOISE[10:13] = 0.06
for _arm in (25, 35):
    _NOISE[_arm : _arm + 3] = 0.018
    _NOISE[_arm + 3] = 0.08
_FEET = [13, 14, 15, 19, 20, 21]


def _add_noise(curves: Curves, rng: Generator, variation: float) -> None:
    strength = variation * float(np.exp(rng.normal(0.0, 0.5)))
    curves.data += strength * _NOISE * smooth_noise(len(curves), CHANNELS, rng, 1.2)
    # Nobody is straight: each performer holds hips and chest a little turned, and leans.
    aside, twist = variation * rng.normal(0.0, [0.035, 0.07])
    curves.spine[:, 1:] += [aside, twist]
    curves.pelvis[:, 2] -= 0.4 * twist
    if rng.random() < 0.3 * variation:  # slight foot sliding and floating, as in imperfect captures
        curves.data[:, _FEET] += rng.uniform(0.0, 0.012) * smooth_noise(len(curves), len(_FEET), rng, 2.0)


def _clock(frames: int, rng: Generator, variation: float) -> Array:
    """Time warp: the source frame of each frame of a clip, (F',), at 0.75 to 1.3 times the speed."""
    longest = int(frames / 0.75) + 1
    rate = np.exp(variation * (rng.normal(0.0, 0.08) + 0.05 * smooth_noise(longest, 1, rng, 0.7)[:, 0]))
    at = np.concatenate([[0.0], np.cumsum(np.clip(rate, 0.75, 1.3))])
    return np.asarray(at[at <= frames - 1])


def _sample(joints: Array, clock: Array) -> Array:
    low = np.minimum(clock.astype(np.int64), len(joints) - 1)
    share = (clock - low)[:, None, None]
    return np.asarray(joints[low] * (1 - share) + joints[np.minimum(low + 1, len(joints) - 1)] * share)


def _finish(
    scene: Scene, curves: Curves, joints: Array, rng: Generator, variation: float, captions: Sequence[str]
) -> SceneClip:
    """Warp time and add sensor noise."""
    spans = np.array(curves.spans, dtype=np.float64)
    if variation:
        clock = _clock(len(joints), rng, variation)
        joints = _sample(joints, clock)
        spans = np.interp(spans, [*clock, len(curves)], np.arange(len(clock) + 1))
        jitter = variation * rng.gamma(1.0, 0.0012)
        joints = joints + rng.standard_normal(joints.shape, dtype=np.float32) * jitter
    times = tuple((float(first / FPS), float(last / FPS)) for first, last in spans)
    return SceneClip(joints.astype(np.float32), FPS, scene, times, tuple(captions))


def make_clip(scene: Scene, rng: Generator, *, captions: Sequence[str] = (), variation: float = 1.0) -> SceneClip:
    """Synthesise a clip of a scene by one random performer.

    Parameters
    ----------
    rng : Generator
        The only source of randomness: the same state gives the same clip.
    captions : sequence of str
        Passed on to the clip.
    variation : float
        1: performers, rigs, timing and sensor noise vary as in captures; 0: the plain movement on the canonical body.

    Raises
    ------
    KeyError
        If an action or a style is unknown.
    """
    curves = perform_scene(scene, rng, variation=variation)
    _add_noise(curves, rng, variation)
    joints = pose(curves, random_geometry(rng, spread=variation))
    return _finish(scene, curves, joints, rng, variation, captions)
