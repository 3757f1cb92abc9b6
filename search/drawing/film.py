"""A motion as a picture for people: a strip of poses over time, or an animation."""

from __future__ import annotations

import subprocess
import tempfile
from collections.abc import Callable, Iterator
from contextlib import suppress
from pathlib import Path
from shutil import copyfileobj, which
from typing import IO, TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from encoders.errors import ArgumentError, MissingProgram, QueryError
from encoders.motion import Motion
from search.drawing.raster import FLOOR, INK, QUIET, Stage
from search.export.replacing import replacing

if TYPE_CHECKING:
    from PIL.Image import Image

_POSES, _APART = 9, 0.25  # poses of a strip at most, and seconds between them at least
_ROOM = 0.04  # beside and above them, to their height
_PALE = 24  # a shadow paler than this is cut off
_LONGEST_GIF = 60.0  # seconds: all frames of a GIF are held until it is written
NO_FFMPEG = "an .mp4 needs ffmpeg; install it, or run: pip install imageio-ffmpeg"


#: Heights in pixels, and frames a second of animations, that can be drawn.
SIZES, RATES = (64, 2160), (1, 60)


def write_picture(motion: Motion, out: Path, *, size: int = 480, fps: float = 20.0) -> int:
    """Draw a motion as what the ending of `out` names: .png a strip of poses, .gif and .mp4 the figure moving.

    Parameters
    ----------
    size : int
        Height of the picture in pixels; animations are square.
    fps : float
        Frames a second of an animation.

    Returns
    -------
    int
        How many poses or frames were drawn.

    Raises
    ------
    QueryError
        If the size or the frame rate is out of range, the ending is none of these, or the motion too long for a .gif.
    MissingProgram
        If there is no ffmpeg for an .mp4.
    """
    for name, value, (least, most) in (("size", size, SIZES), ("fps", fps, RATES)):
        if not least <= value <= most:
            raise ArgumentError(f"{name}={value:g} must be from {least} to {most}")
    writer = WRITERS.get(out.suffix.lower())
    if writer is None:
        raise QueryError(f"{out}: can draw {', '.join(WRITERS)}")
    with replacing(out) as file:
        return writer(file, motion, size, fps)


def _write_strip(file: IO[bytes], motion: Motion, size: int, fps: float) -> int:
    """Poses side by side, each in its place over the second it shows."""
    from PIL import Image, ImageDraw, ImageFont

    count = int(np.clip(motion.duration / _APART, 1, _POSES))
    shown = np.linspace(0, len(motion) - 1, count).round().astype(int)
    stage = Stage(motion, size, size, grid=False)
    poses = _cropped(np.stack([stage.draw(int(frame)) for frame in shown]))
    _, height, width, _ = poses.shape
    margin = round(0.11 * size)
    poses = np.concatenate(poses, axis=1)
    picture = Image.new("RGB", (poses.shape[1], height + margin), FLOOR)
    picture.paste(Image.fromarray(poses), (0, 0))
    pen, font = ImageDraw.Draw(picture), ImageFont.load_default(max(10, round(0.036 * size)))
    line = height + round(0.2 * margin)
    pen.line([(width // 2, line), (poses.shape[1] - width // 2, line)], fill=QUIET, width=max(1, size // 400))
    for i, frame in enumerate(shown):
        x = i * width + width // 2
        pen.line([(x, line - size // 80), (x, line + size // 80)], fill=INK, width=max(1, size // 240))
        pen.text((x, line + size // 50), f"{frame / motion.fps:.1f} s", fill=INK, font=font, anchor="mt")
    picture.save(file, "PNG")
    return count


def _cropped(poses: NDArray[np.uint8]) -> NDArray[np.uint8]:
    """Pictures (N, H, W, 3) without the bare floor above, and equally far on both sides."""
    drawn = (np.abs(poses.astype(np.int16) - FLOOR) > _PALE).any(axis=(0, 3))
    middle, room = poses.shape[2] // 2, round(_ROOM * poses.shape[1])
    rows, columns = np.flatnonzero(drawn.any(axis=1)), np.flatnonzero(drawn.any(axis=0))
    half = min(max(int(np.abs(columns - middle).max()) + room, 5 * room), middle)
    return poses[:, max(rows[0] - room, 0) :, middle - half : middle + half]


def _write_gif(file: IO[bytes], motion: Motion, size: int, fps: float) -> int:
    if motion.duration > _LONGEST_GIF:
        limit = f"a .gif holds {_LONGEST_GIF:g} s at most and this is {motion.duration:.0f} s"
        raise QueryError(f"{limit}; give a start and an end, or draw an .mp4")
    hundredths = max(2, round(100 / fps))  # what the format can express and browsers play
    motion = motion.resample(100 / hundredths)
    stage = Stage(motion, size, size)
    palette = _palette(stage, len(motion))
    first, *rest = (_with_palette(frame, palette) for frame in _frames(stage, len(motion)))
    first.save(file, "GIF", save_all=True, append_images=rest, duration=10 * hundredths, loop=0, optimize=False)
    return len(motion)


def _write_mp4(file: IO[bytes], motion: Motion, size: int, fps: float) -> int:
    motion, size = motion.resample(fps), size + size % 2  # players want even sides
    stage = Stage(motion, size, size)
    given = f"-f rawvideo -pix_fmt rgb24 -s {size}x{size} -r {fps:g} -i -"
    wanted = "-an -c:v libx264 -crf 20 -pix_fmt yuv420p -movflags +faststart"
    with tempfile.TemporaryDirectory(prefix="motionseek-") as folder:
        film, log = Path(folder) / "film.mp4", Path(folder) / "log"
        command = [_ffmpeg(), "-loglevel", "error", *given.split(), *wanted.split(), str(film)]
        with log.open("wb") as errors, subprocess.Popen(command, stdin=subprocess.PIPE, stderr=errors) as process:
            assert process.stdin is not None
            with suppress(BrokenPipeError):  # it has ended, and logged why
                for frame in _frames(stage, len(motion)):
                    process.stdin.write(frame.tobytes())
                process.stdin.close()
        if process.returncode:
            raise QueryError(f"ffmpeg could not write an .mp4: {log.read_text(errors='replace')[:500].strip()}")
        with film.open("rb") as written:
            copyfileobj(written, file)
    return len(motion)


#: Ending -> what draws it.
WRITERS: dict[str, Callable[[IO[bytes], Motion, int, float], int]] = {
    ".png": _write_strip,
    ".gif": _write_gif,
    ".mp4": _write_mp4,
}


def _frames(stage: Stage, count: int) -> Iterator[NDArray[np.uint8]]:
    return (stage.draw(frame) for frame in range(count))


def _palette(stage: Stage, count: int) -> Image:
    """128 colours that serve all frames, so that nothing flickers."""
    from PIL import Image

    some = np.concatenate([stage.draw(int(frame)) for frame in np.linspace(0, count - 1, 4)])
    return Image.fromarray(some).quantize(128, method=Image.Quantize.MEDIANCUT)


def _with_palette(frame: NDArray[np.uint8], palette: Image) -> Image:
    from PIL import Image

    return Image.fromarray(frame).quantize(palette=palette, dither=Image.Dither.NONE)


def _ffmpeg() -> str:
    """The ffmpeg of this computer, else the one that imageio-ffmpeg brings.

    Raises
    ------
    MissingProgram
        If there is neither.
    """
    found = which("ffmpeg")
    if found is not None:
        return found
    try:
        from imageio_ffmpeg import get_ffmpeg_exe

        return str(get_ffmpeg_exe())
    except (ImportError, RuntimeError):
        raise MissingProgram(NO_FFMPEG) from None
