"""What a synthetic clip shows: action steps, the scene they form, and the clip with its annotations."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from encoders.motion import FPS


@dataclass(frozen=True)
class ActionStep:
    """One action with its attributes; an empty field leaves that attribute unspecified.

    Attributes
    ----------
    action : str
        Name of an action program.
    side : str
        "left", "right" or "both": the side of the hand, arm, foot or leg that acts.
    direction : str
        "forward", "backward", "left", "right", "forward-left", "forward-right", "backward-left", "backward-right",
        "clockwise", "counterclockwise" (seen from above), "around", "up", "down", "in place", "zigzag",
        "back and forth".
    speed : str
        "slow" or "fast".
    amplitude : str
        "small" or "large".
    count : int
        Number of repetitions; 0 leaves it unspecified.
    style : str
        A name of `encoders.corpus.engine.style.STYLES`.
    height : str
        "low", "middle" or "high".
    degrees : int
        How far a turn goes: 45, 90, 180, 270 or 360; 0 leaves it unspecified.
    """

    action: str
    side: str = ""
    direction: str = ""
    speed: str = ""
    amplitude: str = ""
    count: int = 0
    style: str = ""
    height: str = ""
    degrees: int = 0

    def __str__(self) -> str:
        attributes = (self.side, self.direction, self.speed, self.amplitude, self.style, self.height)
        count = f"{self.count} times" if self.count else ""
        degrees = f"{self.degrees} degrees" if self.degrees else ""
        return ", ".join([self.action, *filter(None, (*attributes, degrees, count))])


#: Steps that happen at the same time.
StepGroup = tuple[ActionStep, ...]


@dataclass(frozen=True)
class Scene:
    """Groups of steps in sequence; the steps of one group happen at the same time."""

    steps: tuple[StepGroup, ...]

    def __str__(self) -> str:
        return "; then ".join(" while ".join(map(str, group)) for group in self.steps)


@dataclass(frozen=True)
class SceneClip:
    """A synthetic motion with its annotations.

    Attributes
    ----------
    joints : float32 array (T, 22, 3)
        Metres, Y up.
    fps : float
        Frames per second.
    scene : Scene
        What it shows.
    spans : tuple of (float, float)
        Start and end of each step group, seconds.
    captions : tuple of str
        Sentences that describe the whole clip.
    """

    joints: NDArray[np.float32]
    fps: float = FPS
    scene: Scene = Scene(())
    spans: tuple[tuple[float, float], ...] = ()
    captions: tuple[str, ...] = ()
