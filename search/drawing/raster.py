"""A person drawn in numpy: lit capsules, a soft shadow and a grid on the ground."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from encoders.drawing.capsules import CAPSULES, RADII, TINTS, VIEW, aim, capsules, heading, reach
from encoders.geometry import interpolate
from encoders.motion import Motion
from search.drawing.camera import Camera

Floats = NDArray[np.float32]

#: The page's colours, light.
PAPER, INK, QUIET = (248, 246, 241), (29, 26, 22), (100, 94, 84)
FLOOR = (239, 235, 227)
_LINE = np.array((201, 193, 178), np.float32)
_TINT = np.array([TINTS[c.part] for c in CAPSULES], np.float32)
_LIGHT = np.array([-0.45, 0.8, 0.5], np.float32) / np.float32(np.linalg.norm([0.45, 0.8, 0.5]))
_BARE = np.array(FLOOR, np.float32)
_SHADOW = 0.34
_FAR = 2.4  # metres from below the aim to where the grid has faded
_FINE = 2  # samples across a pixel
_COARSE = 3  # pixels across a sample of the shadow, which is soft


class Stage:
    """A motion seen by a camera that follows it.

    Parameters
    ----------
    width, height : int
        Of the pictures, in pixels.
    grid : bool
        Draw lines on the ground, half a metre apart.
    """

    def __init__(self, motion: Motion, width: int, height: int, *, grid: bool = True) -> None:
        aside, up = reach(motion.joints, motion.fps)
        zoom = float(np.clip(max(aside / 0.9, up / 1.85), 1, 2.2))
        away = 4.9 * zoom / min(1.0, 1.15 * width / height)
        eye = float(np.clip(up / 2 - 0.05, 0.86, 1.6))
        yaw = heading(motion.joints) + VIEW
        self._motion, self._aim = motion, aim(motion.joints, motion.fps)
        self._fine = Camera(width * _FINE, height * _FINE, yaw, away, eye)
        ground = Camera(width, height, yaw, away, eye).ground
        self._horizon = int(np.argmax(np.linalg.norm(ground, axis=-1).min(axis=1) < _FAR))  # the first row with ground
        self._ground = ground[self._horizon :]
        self._grid = _Grid(self._ground) if grid else None
        self._floor = np.empty((height, width, 3), np.float32)
        self._floor[:] = _BARE

    def draw(self, frame: int) -> NDArray[np.uint8]:
        """The picture (height, width, 3) of a frame."""
        below = np.array([self._aim[frame, 0], 0, self._aim[frame, 1]], np.float32)
        limbs = capsules(self._motion.joints[frame] - below)
        picture = self._floor.copy()
        ground = picture[self._horizon :]
        if self._grid is not None:
            ground += self._grid.lines(self._aim[frame])[..., None] * (_LINE - _BARE)
        ground *= 1 - _shadow(self._ground, limbs)[..., None]
        _paint(picture, *self._fine.project(limbs, RADII))
        return np.asarray(np.clip(picture + 0.5, 0, 255), np.uint8)


class _Grid:
    """Lines on the ground (H, W, 2), half a metre apart, that fade outward."""

    def __init__(self, ground: Floats) -> None:
        cell = 2 * ground
        width = np.abs(np.gradient(cell, axis=0)) + np.abs(np.gradient(cell, axis=1))
        faded = np.clip((np.linalg.norm(ground, axis=-1) - 0.3) / (_FAR - 0.3), 0, 1)
        self._strength = np.nan_to_num(0.75 * (1 - faded * faded * (3 - 2 * faded)))
        self._cells = np.moveaxis(np.nan_to_num(cell), -1, 0).copy()
        self._widths = np.moveaxis(np.nan_to_num(np.maximum(width, 1e-4), nan=1.0), -1, 0).copy()

    def lines(self, centre: Floats) -> Floats:
        """How much of a line each pixel shows (H, W), the camera being aimed at `centre`."""
        x, z = (self._cells[i] + 2 * centre[i] for i in (0, 1))
        near_x, near_z = (np.abs(c - np.rint(c)) / width for c, width in zip((x, z), self._widths, strict=True))
        drawn: Floats = self._strength * (1 - np.minimum(np.minimum(near_x, near_z), 1))
        return drawn


def _shadow(ground: Floats, limbs: Floats) -> Floats:
    """How dark each pixel of the ground is (H, W): the higher a limb, the softer and paler its shadow."""
    height, width = ground.shape[:2]
    middle = ground[_COARSE // 2 :: _COARSE, _COARSE // 2 :: _COARSE]
    seen = np.abs(np.nan_to_num(middle, nan=np.inf)).max(axis=-1) < np.abs(limbs[..., [0, 2]]).max() + 0.6
    here = middle[seen]
    start, along = limbs[:, 0, [0, 2]], limbs[:, 1, [0, 2]] - limbs[:, 0, [0, 2]]
    up = np.maximum(limbs[..., 1].mean(axis=-1), 0)[:, None]
    soft = 0.05 + 0.16 * up
    from_start = here[None] - start[:, None]
    square = np.maximum((along * along).sum(axis=-1), 1e-6)[:, None]
    at = np.clip(np.einsum("cpi,ci->cp", from_start, along) / square, 0, 1)
    beside = np.linalg.norm(from_start - at[..., None] * along[:, None], axis=-1) - RADII.mean(axis=1)[:, None]
    edge = np.clip((beside + soft) / (2 * soft), 0, 1)
    dark = (_SHADOW / (1 + 1.3 * up) * (1 - edge * edge * (3 - 2 * edge))).max(axis=0)
    coarse = np.zeros(middle.shape[:2], np.float32)
    coarse[seen] = dark
    return _enlarged(coarse, height, width)


def _enlarged(coarse: Floats, height: int, width: int) -> Floats:
    """An image (h, w) at another size, in straight lines between samples."""
    for axis, size in enumerate((height, width)):
        at = np.clip((np.arange(size) + 0.5) / _COARSE - 0.5, 0, coarse.shape[axis] - 1)
        coarse = interpolate(coarse, at, axis)
    return coarse


def _paint(picture: Floats, places: Floats, radii: Floats) -> None:
    """Draw capsules into a picture.

    Parameters
    ----------
    places : float32 array (C, 2, 3), radii : float32 array (C, 2)
        Both ends as the camera sees them, in samples, of which a pixel has `_FINE` x `_FINE`.
    """
    low = np.floor((places[..., :2] - radii[..., None]).min(axis=(0, 1)) / _FINE).astype(int)
    high = np.ceil((places[..., :2] + radii[..., None]).max(axis=(0, 1)) / _FINE).astype(int)
    (left, top), (right, bottom) = np.maximum(low, 0), np.minimum(high, (picture.shape[1], picture.shape[0]))
    if left >= right or top >= bottom:
        return
    height, width = (bottom - top) * _FINE, (right - left) * _FINE
    depth = np.full((height, width), -np.inf, np.float32)
    colour = np.zeros((height, width, 3), np.float32)
    corner = np.array([left, top, 0], np.float32) * _FINE
    for ends, thick, tint in zip(places - corner, radii, _TINT, strict=True):
        _paint_capsule(depth, colour, ends, thick, tint)
    covered = _coarsened(np.isfinite(depth).astype(np.float32)[..., None])
    part = picture[top:bottom, left:right]
    part *= 1 - covered
    part += _coarsened(colour)


def _coarsened(samples: Floats) -> Floats:
    """The mean of the samples of each pixel."""
    total = np.zeros_like(samples[::_FINE, ::_FINE])
    for row, column in np.ndindex(_FINE, _FINE):
        total += samples[row::_FINE, column::_FINE]
    total /= _FINE**2
    return total


def _paint_capsule(depth: Floats, colour: Floats, ends: Floats, radii: Floats, tint: Floats) -> None:
    """Draw one capsule where it is in front of what is there.

    It is the union of the balls at a + s (b - a) with radius r(s), s from 0 to 1. A pixel sees the ball that stands out
    most, which maximises z(s) = s b_z + sqrt(Q(s)), where Q(s) = r(s)^2 - (distance from the pixel to the ball)^2 is a
    quadratic; the maximum of a line over an ellipse has a closed form.
    """
    low = np.maximum(np.floor((ends[:, :2] - radii[:, None]).min(axis=0)).astype(int), 0)
    high = np.minimum(np.ceil((ends[:, :2] + radii[:, None]).max(axis=0)).astype(int), depth.shape[::-1])
    if (low >= high).any():
        return
    x = (np.arange(low[0], high[0], dtype=np.float32) + 0.5 - ends[0, 0])[None]
    y = (np.arange(low[1], high[1], dtype=np.float32) + 0.5 - ends[0, 1])[:, None]
    along, thinner = ends[1] - ends[0], radii[0] - radii[1]
    bend = max(along[0] ** 2 + along[1] ** 2 - thinner**2, 1e-2)
    slope = x * along[0] + y * along[1] - radii[0] * thinner
    free = np.maximum(radii[0] ** 2 - x * x - y * y + slope * slope / bend, 0)
    at = np.clip(slope / bend + along[2] * np.sqrt(free / (bend * (bend + along[2] ** 2))), 0, 1)
    radius = radii[0] - at * thinner
    aside, down = x - at * along[0], y - at * along[1]
    out_squared = radius * radius - aside * aside - down * down
    out = np.sqrt(np.maximum(out_squared, 0))
    z = ends[0, 2] + at * along[2] + out
    box = slice(low[1], high[1]), slice(low[0], high[0])
    front = (out_squared > 0) & (z > depth[box])
    depth[box][front] = z[front]
    normal = np.stack([aside[front], -down[front], out[front]], axis=-1) / radius[front][:, None]
    colour[box][front] = _lit(normal, tint)


def _lit(normal: Floats, tint: Floats) -> Floats:
    """Colours (P, 3) of a surface: wrapped light from above the viewer's left shoulder, and a thin rim."""
    lit = 0.5 + 0.5 * (normal @ _LIGHT)
    gain = 0.5 + 0.66 * lit * lit * (3 - 2 * lit)
    rim = 255 * 0.12 * (1 - normal[:, 2]) ** 3 * lit
    shaded: Floats = np.minimum(gain[:, None] * tint + rim[:, None], 255)
    return shaded
