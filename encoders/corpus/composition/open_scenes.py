"""What a sentence leaves open, decided as people would act it: sides, directions, seats, and what else happens.

"A person jumps" may go up or ahead, and whoever carries something mostly walks. All decisions become facts of the
scene, and captions may leave them out again.
"""

from __future__ import annotations

from dataclasses import replace

from numpy.random import Generator

from encoders.corpus.actions.programs import program_of
from encoders.corpus.scene import ActionStep, Scene, StepGroup

_LYING = ("backward", "backward", "forward", "left", "right")
_SEATS = ("middle", "middle", "middle", "middle", "low")
#: Directions that an action has when none is said, as often as they are listed; other actions go forward if they can.
_OPEN: dict[str, tuple[str, ...]] = {
    "jump": ("up", "up", "in place", "forward", "forward"),
    "hop": ("forward", "in place"),
    "lean": ("forward", "forward", "left", "right", "backward"),
    "reach": ("up", "up", "forward", "forward", "left", "right"),
    "arm circles": ("forward", "backward"),
    "backflip": ("backward",),
    "point": ("forward", "forward", "left", "right", "up", "down"),
    "guide": ("forward", "left", "right"),
    "raise leg": ("forward", "forward", "left", "right", "backward"),
    "leg swing": ("forward", "forward", "left", "right"),
    "slide foot": ("forward", "backward", "left", "right"),
    "lunge": ("forward", "forward", "forward", "left", "right", "backward"),
    "get pushed": ("forward", "backward", "left", "right"),
    "stumble": ("forward", "forward", "forward", "left", "right", "backward"),
    "high knees": ("in place", "forward"),
    "stomp": ("in place", "forward"),
    "dodge": ("left", "right", "backward"),
    "faint": ("left", "right", "backward"),
    "sidestep": ("left", "right"),
    "pivot": ("left", "right", "around"),
    "spin": ("clockwise", "counterclockwise"),
    "touch heel": ("forward", "forward", "backward"),
}
#: Angle of a turn by its direction, if nothing is said of it.
_TURNED = {"left": (90,), "right": (90,), "around": (180,)}
#: Actions of the arms that mostly go with others, and how often somebody walks meanwhile, if nothing is said of it.
_WALKED = {
    "carry": 0.6, "carry on shoulder": 0.65, "carry on head": 0.65, "push cart": 0.75, "drag behind": 0.8,
    "hold umbrella": 0.5, "phone call": 0.3, "hands behind back": 0.25, "hands on hips": 0.15, "cross arms": 0.15,
    "rock baby": 0.15, "hold handrail": 0.2, "read book": 0.15, "surrender": 0.15,
}  # fmt: skip
#: How arms are held during actions of the legs, if nothing is said of them.
_HELD = (
    "carry", "carry", "carry on shoulder", "hands on hips", "hands on hips", "hands behind back", "cross arms",
    "phone call", "surrender", "hands on head", "flex biceps", "rock baby", "t-pose",
)  # fmt: skip
_LEG_ACTIONS = frozenset(
    {"squat", "lunge", "kneel", "kick", "raise leg", "raise knee", "leg swing", "jump", "side kick"}
)
_HELD_MEANWHILE = 0.06
_WALKS = ("forward", "forward", "forward", "forward", "around", "left", "right", "back and forth")
#: Actions of the arms that last as long as what accompanies them.
LASTING = frozenset({*_WALKED, *_HELD})
#: Share of captions that leave out what accompanies an action.
_UNMENTIONED = 0.5


def open_directions(action: str) -> tuple[str, ...]:
    """Directions that an action of unspecified direction may have; empty where it has none of its own choice."""
    program = program_of(action)
    if action in _OPEN:
        return _OPEN[action]
    if _lies(action):
        return tuple(way for way in _LYING if way in program.directions)
    return ("forward",) if "forward" in program.directions else ()


def complete_scene(scene: Scene, rng: Generator) -> Scene:
    """The scene with unspecified sides and directions, and heights of seats, sampled: all its facts are known.

    One performer lies, and sits, the same way throughout.
    """
    lying, seat = str(rng.choice(_LYING)), str(rng.choice(_SEATS))
    groups = []
    for group in scene.steps:
        decided = []
        for step in group:
            action = program_of(step.action)
            side = step.side or (str(rng.choice(action.sides)) if action.sides else "")
            direction, height = step.direction, step.height
            if _lies(step.action) and lying in action.directions:
                direction = lying = direction or lying
            elif not direction and (choices := open_directions(step.action)):
                direction = str(rng.choice(choices))
            if "sit" in (action.starts, action.ends) and seat in action.heights:
                height = seat = height or seat
            degrees = step.degrees
            if action.degrees and not degrees:
                degrees = int(rng.choice(_TURNED.get(direction, (180, 360))))
            decided.append(replace(step, side=side, direction=direction, height=height, degrees=degrees))
        groups.append(tuple(decided))
    return Scene(tuple(groups))


def accompanied(scene: Scene, rng: Generator) -> Scene:
    """The scene with what people do besides: they walk while they carry something, or carry something as they walk."""
    return Scene(tuple(_accompanied(group, rng) for group in scene.steps))


def _accompanied(group: StepGroup, rng: Generator) -> StepGroup:
    if len(group) > 1:
        return group
    step, action = group[0], program_of(group[0].action)
    if rng.random() < _WALKED.get(step.action, 0.0):
        way = str(rng.choice(_WALKS))
        return (ActionStep("walk", direction=way, speed=step.speed, style=step.style), replace(step, speed=""))
    legs = action.parts <= {"legs", "spine"} and action.group in ("locomotion", "posture")
    if (legs or step.action in _LEG_ACTIONS) and not action.held_out and rng.random() < _HELD_MEANWHILE:
        held = program_of(_HELD[int(rng.integers(len(_HELD)))])
        side = str(rng.choice(held.sides)) if held.sides else ""
        return (step, ActionStep(held.name, side=side))
    return group


def unmentioned(scene: Scene, rng: Generator) -> Scene:
    """The scene without some of what `accompanied` may have added, as captions describe it."""
    return Scene(tuple(_main(group) if rng.random() < _UNMENTIONED else group for group in scene.steps))


def _main(group: StepGroup) -> StepGroup:
    """The step that people would name of a gait and a load, or of legs and the way that arms are held."""
    if len(group) != 2:
        return group
    legs, arms = group
    if arms.action in _WALKED and legs.action == "walk":
        return (arms,)
    return (legs,) if arms.action in _HELD else group


def _lies(action: str) -> bool:
    program = program_of(action)
    return program.group == "posture" and "floor" in (program.starts, program.ends) and "backward" in program.directions
