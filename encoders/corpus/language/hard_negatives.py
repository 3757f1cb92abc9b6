"""Hard negatives: scenes that differ from a given one in a single attribute or in order.

Bag-of-words models confuse such pairs: the order of two steps, left and right, a direction, a count, an angle.
"""

from __future__ import annotations

from dataclasses import replace

from encoders.corpus.actions.programs import programs
from encoders.corpus.language.weighted_choice import RandomSource, pick
from encoders.corpus.scene import ActionStep, Scene

_OPPOSITE_SIDE = {"left": "right", "right": "left"}
_OPPOSITE_DIRECTION = {
    "forward": "backward", "backward": "forward", "left": "right", "right": "left", "up": "down", "down": "up",
    "clockwise": "counterclockwise", "counterclockwise": "clockwise",
    "forward-left": "forward-right", "forward-right": "forward-left",
    "backward-left": "backward-right", "backward-right": "backward-left",
}  # fmt: skip


def _legal(step: ActionStep) -> bool:
    program = programs().get(step.action)
    if program is None:
        return False
    counted = not step.count or (program.counts is not None and program.counts[0] <= step.count <= program.counts[1])
    turned = not step.degrees or step.degrees in program.degrees
    sided = not step.side or step.side in program.sides
    return sided and counted and turned and (not step.direction or step.direction in program.directions)


def _changes(step: ActionStep) -> list[ActionStep]:
    """The step with one field changed to a contrary value."""
    changed = []
    if step.side in _OPPOSITE_SIDE:
        changed.append(replace(step, side=_OPPOSITE_SIDE[step.side]))
    if step.direction in _OPPOSITE_DIRECTION:
        changed.append(replace(step, direction=_OPPOSITE_DIRECTION[step.direction]))
    if step.count:
        changed += [replace(step, count=step.count + more) for more in (-2, -1, 1, 2) if step.count + more > 0]
    if step.degrees:
        changed += [replace(step, degrees=degrees) for degrees in (step.degrees // 2, 2 * step.degrees)]
    return [other for other in changed if _legal(other)]


def contrasting_scenes(scene: Scene) -> list[Scene]:
    """All scenes that differ from `scene` once: two neighbouring groups swapped, or one field changed."""
    groups = scene.steps
    found = []
    for i in range(len(groups) - 1):
        if groups[i] != groups[i + 1]:
            found.append(Scene((*groups[:i], groups[i + 1], groups[i], *groups[i + 2 :])))
    for i, group in enumerate(groups):
        for j, step in enumerate(group):
            for other in _changes(step):
                changed = (*group[:j], other, *group[j + 1 :])
                found.append(Scene((*groups[:i], changed, *groups[i + 1 :])))
    return [other for other in found if other != scene]


def contrasting_scene(scene: Scene, rng: RandomSource) -> Scene | None:
    """One of `contrasting_scenes(scene)`; None if there is none."""
    options = contrasting_scenes(scene)
    return pick(rng, options) if options else None
