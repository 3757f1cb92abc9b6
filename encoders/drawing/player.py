"""Motions that show themselves moving in a notebook: one piece of HTML that needs nothing else.

A motion becomes a picture of its middle pose, for where scripts do not run, and bytes that `player.js` plays: a
pelvis in 16 bits and the other joints about it in 8, ten frames a second.
"""

from __future__ import annotations

import base64
import json
import struct
from collections.abc import Iterable
from functools import cache
from html import escape
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from encoders.drawing.capsules import CAPSULES, VIEW, aim, capsules, heading, reach, view_axes
from encoders.geometry import resample

Joints = NDArray[np.float32]

_FPS = 10.0
_ROOM = 0.08  # metres beyond the outermost joint
_TINTS = {"body": "#8d857a", "left": "#dd5a22", "right": "#b3aa9c"}  # seen on white and on black


def player(takes: Iterable[tuple[Joints, float, str]], *, seconds: float = 48.0, width: int = 260) -> str:
    """HTML that plays motions side by side, each with a line of text below it.

    Parameters
    ----------
    takes : iterable of (joints, fps, text)
        Positions (T, 22, 3) in metres, Y up.
    seconds : float
        Only the beginning is shown of longer motions.
    width : int
        Of each, in pixels.
    """
    figures = "".join(_figure(joints, fps, text, seconds, width) for joints, fps, text in takes)
    return f'<div style="display:flex;flex-wrap:wrap;gap:14px">{figures}</div><script>{_script()}</script>'


def _figure(joints: Joints, fps: float, text: str, seconds: float, width: int) -> str:
    duration = len(joints) / fps
    shown = resample(joints[: max(round(seconds * fps), 1)], fps, _FPS)
    rest = f" (the first {seconds:g} s of {duration:.0f})" if duration > seconds else ""
    said = escape(text + rest)
    style = f"margin:0;width:{width}px;font:12px/1.4 system-ui,sans-serif;overflow-wrap:anywhere"
    data = base64.b64encode(_packed(shown)).decode()
    caption = f'<figcaption style="padding:4px 2px">{said}</figcaption>'
    return f'<figure style="{style}" data-motionseek="{data}">{_poster(shown, said)}{caption}</figure>'


def _packed(joints: Joints) -> bytes:
    """What `player.js` unpacks, little-endian.

    uint32 frames T, joints J; float32 frames a second, metres a step of the pelvis, of the other joints, heading, zoom,
    eye; int16 (T, 3) pelvis; int16 (T, 2) the camera's aim; int8 (T, J - 1, 3) the other joints from the pelvis.
    """
    pelvis, others = joints[:, :1] - _origin(joints), joints[:, 1:] - joints[:, :1]
    aims = aim(joints, _FPS) - _origin(joints)[[0, 2]]
    far = max(float(np.abs(pelvis).max()), float(np.abs(aims).max()), 1e-3) / 32767
    near = max(float(np.abs(others).max()), 1e-3) / 127
    zoom, eye = _framing(joints)
    head = struct.pack("<2I6f", *joints.shape[:2], _FPS, far, near, heading(joints), zoom, eye)
    steps = ((pelvis / far, "<i2"), (aims / far, "<i2"), (others / near, "i1"))
    return head + b"".join(np.rint(values).astype(kind).tobytes() for values, kind in steps)


def _origin(joints: Joints) -> Joints:
    """Where the first frame stands on the ground."""
    x, _, z = joints[0, 0]
    return np.array([x, 0, z], np.float32)


def _framing(joints: Joints) -> tuple[float, float]:
    """How much wider than a person who stands is shown, and the height in metres at the middle."""
    aside, up = reach(joints, _FPS)
    zoom = max((aside + _ROOM) / 1.05, (up + _ROOM) / 1.95, 1.0)
    return zoom, max(up / 2, 0.86)


def _poster(joints: Joints, label: str) -> str:
    """The middle pose as an SVG of thick lines, seen from the front."""
    frame = len(joints) // 2
    x, z = aim(joints, _FPS)[frame]
    ends = capsules(joints[frame]) - np.array([x, 0, z], np.float32)
    zoom, eye = _framing(joints)
    right, _, towards = view_axes(heading(joints) + VIEW)
    scale = 100 / (2.15 * zoom)
    across, down = 50 + scale * (ends @ right), 50 - scale * (ends[..., 1] - eye)
    lines = "".join(
        f'<path d="M{across[i, 0]:.1f} {down[i, 0]:.1f}L{across[i, 1]:.1f} {down[i, 1]:.1f}"'
        f' stroke="{_TINTS[CAPSULES[i].part]}" stroke-width="{scale * (CAPSULES[i].near + CAPSULES[i].far):.1f}"/>'
        for i in np.argsort((ends @ towards).mean(axis=1)).tolist()
    )
    return (
        f'<svg viewBox="0 0 100 100" role="img" aria-label="{label}" style="display:block;width:100%"'
        f' stroke-linecap="round" fill="none">{lines}</svg>'
    )


@cache
def _script() -> str:
    lines = Path(__file__).with_suffix(".js").read_text(encoding="utf-8").splitlines()
    bare = [line.strip() for line in lines if not line.strip().startswith(("//", "/**"))]
    script = "\n".join(bare).replace('"CAPSULES"', json.dumps(CAPSULES, separators=(",", ":")))
    return script.replace('"VIEW"', str(VIEW))
