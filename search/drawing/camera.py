"""A camera that looks at a point above the ground: where things appear, and which ground is seen."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from encoders.drawing.capsules import view_axes

_FIELD_OF_VIEW = np.deg2rad(26)
_PITCH = 0.2

Floats = NDArray[np.float32]


@dataclass(frozen=True)
class Camera:
    """A camera aimed at the point (0, `eye`, 0).

    Attributes
    ----------
    width, height : int
        Of the picture, in pixels.
    yaw : float
        Where it stands, as an angle about Y from +Z, in radians.
    away : float
        Metres from its aim.
    eye : float
        Height of its aim in metres.
    """

    width: int
    height: int
    yaw: float
    away: float
    eye: float

    @cached_property
    def axes(self) -> Floats:
        """Unit vectors to the right, up and towards the viewer (3, 3), one a row."""
        return view_axes(self.yaw, _PITCH)

    @property
    def pixels_per_metre(self) -> float:
        """At the distance of the aim."""
        return float(self.height / (2 * np.tan(_FIELD_OF_VIEW / 2) * self.away))

    def project(self, points: Floats, radii: Floats) -> tuple[Floats, Floats]:
        """Where balls appear.

        Parameters
        ----------
        points : float32 array (..., 3)
            Metres, relative to the ground under the aim.
        radii : float32 array (...)
            Metres.

        Returns
        -------
        places : float32 array (..., 3)
            Pixels to the right of the left edge, down from the upper edge, and towards the viewer.
        radii : float32 array (...)
            Pixels.
        """
        seen = (points - np.array([0, self.eye, 0], np.float32)) @ self.axes.T
        scale = self.pixels_per_metre * self.away / np.maximum(self.away - seen[..., 2], 0.1)
        x = self.width / 2 + seen[..., 0] * scale
        y = self.height / 2 - seen[..., 1] * scale
        return np.stack([x, y, seen[..., 2] * self.pixels_per_metre], axis=-1), radii * scale

    @cached_property
    def ground(self) -> Floats:
        """The point x, z of the ground (height, width, 2) that each pixel shows, in metres from below the aim; not a
        number above the horizon."""
        y, x = np.mgrid[: self.height, : self.width].astype(np.float32) + 0.5
        ahead = self.pixels_per_metre * self.away
        rays = np.stack([x - self.width / 2, self.height / 2 - y, np.full_like(x, -ahead)], axis=-1) @ self.axes
        stands = np.array([0, self.eye, 0], np.float32) + self.away * self.axes[2]
        down = np.where(rays[..., 1] < 0, -stands[1] / np.minimum(rays[..., 1], -1e-6), np.nan)
        points: Floats = (stands + down[..., None] * rays).astype(np.float32)
        return points[..., [0, 2]]
