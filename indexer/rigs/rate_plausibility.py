"""Whether people move as fast as a motion says, or its frame rate must be wrong.

The bounds lie outside all that was recorded at a known rate: of 984 takes, from standing idle to sprints and flips, the
fastest reach 4.5 metres a second where 5 is allowed, and whoever moves a limb 0.6 m gets it to 0.5 where 0.3 is asked.
A rate that is wrong by less than a factor of three to ten, depending on the movement, shows nothing.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from encoders.motion import Motion
from encoders.skeleton import INDEX

_LIMBS = [INDEX[name] for name in ("left_ankle", "right_ankle", "left_wrist", "right_wrist")]
#: Metres a second of all hands and feet against the hips, half of the time; and of the fastest, almost never.
_TOO_FAST, _TOO_SLOW = 5.0, 0.3
#: Metres of a limb's way below which slowness shows nothing.
_WAY = 0.6
#: The fastest that a hand or foot usually becomes, metres a second.
_USUAL = 2.9
_RATES = np.array([12.0, 15.0, 24.0, 30.0, 60.0, 120.0, 240.0])


def rate_warnings(motion: Motion, fps: float) -> tuple[str, ...]:
    """A warning where people cannot move as a motion does that was recorded at `fps`, with the rate that would fit."""
    joints = motion.joints.astype(np.float64)
    limbs: NDArray[np.float64] = joints[:, _LIMBS] - joints[:, :1]
    if len(limbs) < motion.fps / 2:
        return ()
    speeds = np.linalg.norm(np.diff(limbs, axis=0), axis=-1) * motion.fps
    usual, fastest = float(np.median(speeds.mean(axis=1))), float(np.quantile(speeds, 0.995))
    way = float(np.ptp(limbs, axis=0).max())
    if usual > _TOO_FAST:
        found = "faster"
    elif way > _WAY and fastest < _TOO_SLOW:
        found = "slower"
    else:
        return ()
    plausible = _RATES[np.abs(np.log(_RATES / (fps * _USUAL / fastest))).argmin()]
    return (
        f"at {fps:g} frames a second people move {found} than they do; if that is wrong give the true rate with --fps,"
        f" perhaps {plausible:g}",
    )
