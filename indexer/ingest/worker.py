"""The reading process: one request a line on stdin, one response on stdout, until stdin ends.

It begins with READY. A request is a JSON object with the arguments of `read`; a response is a JSON line with the
`reason` why the file cannot be read, or with its `clips`, followed by their joints as float32 bytes in the same order.
Files are not trusted: one that crashes or hangs costs one process.
"""

from __future__ import annotations

import json
import os
import signal
import sys
from dataclasses import replace
from hashlib import blake2b
from importlib import import_module
from typing import Any

from encoders.errors import UnreadableMotion
from indexer.ingest.file_parts import read_part, read_parts
from indexer.read_motion import ReadMotion
from indexer.rigs.retarget import retarget_with_reading
from indexer.take import Take

READY = b"ready\n"


def read_all_parts(
    path: str, fps: float | None = None, joint_map: dict[str, str] | None = None, up: str | None = None
) -> list[ReadMotion]:
    """Every motion of a file, at least one; those that hold no body are named in the first one's warnings.

    Parameters
    ----------
    path : str
    fps : float, optional
        The file's true frame rate.
    joint_map : dict, optional
        Target joint to joint name in the file; one that names joints which the file does not have is meant for other
        files and ignored.
    up : str, optional
        The axis that is up, whatever the file says.

    Raises
    ------
    UnreadableMotion
        See `indexer.ingest.load.load_motion`; with the first one's reason where no motion of the file holds a body.
    """
    parts = read_parts(path, fps=fps)
    found: list[ReadMotion] = []
    failed: list[tuple[str, UnreadableMotion]] = []
    for part, take in parts:
        try:
            found.append(_retargeted(path, take, joint_map, up, part))
        except UnreadableMotion as error:
            failed.append((part or take.name, error))
    if not found:
        raise failed[0][1]
    warnings = [f"{part or 'the first figure'} is left out: {error.reason}" for part, error in failed]
    return [replace(found[0], reading=found[0].reading.warned(*warnings)), *found[1:]]


def read(
    path: str, fps: float | None = None, joint_map: dict[str, str] | None = None, up: str | None = None
) -> ReadMotion:
    """The one motion of a file, or the one that `file#part` names; see `read_all_parts`."""
    part = read_part(path, fps=fps)
    return _retargeted(str(part.file), part.take, joint_map, up, "")


def _retargeted(path: str, take: Take, joint_map: dict[str, str] | None, up: str | None, part: str) -> ReadMotion:
    """A take as a motion with its rig: root joint, number of joints and four digits that tell namings apart."""
    digest = blake2b("\0".join(take.names).encode("utf-8", "replace"), digest_size=2).hexdigest()
    rig = f"{take.names[0]}-{len(take.names)}-{digest}" if take.names else ""
    unknown = [name for name in (joint_map or {}).values() if name not in take.names]
    if up is not None:
        take = replace(take, up=up, up_is_certain=True)
    try:
        motion, reading = retarget_with_reading(take, path=path, joint_map=None if unknown else joint_map)
    except UnreadableMotion as error:
        if not unknown:
            raise
        raise UnreadableMotion(path, f"{error.reason} (the joint map given names {unknown[0]!r}, not in it)") from None
    return ReadMotion(motion, part, rig, reading)


def serve(target: str = "indexer.ingest.worker:read_all_parts") -> None:
    """Serve requests with a function named as "module:function", of the signature of `read_all_parts`."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C is the parent's; it ends this process by closing stdin
    module, name = target.split(":")
    function = getattr(import_module(module), name)
    answers = os.fdopen(os.dup(1), "wb")
    os.dup2(os.open(os.devnull, os.O_WRONLY), 1)  # what a reader prints must not mix with the responses
    answers.write(READY)
    answers.flush()
    for line in sys.stdin.buffer:
        header, data = _answer(function, json.loads(line))
        answers.write(json.dumps(header).encode() + b"\n" + data)
        answers.flush()


def _answer(function: Any, request: dict[str, Any]) -> tuple[dict[str, Any], bytes]:
    try:
        clips: list[ReadMotion] = function(**request)
    except UnreadableMotion as error:
        return {"reason": str(error).removeprefix(f"{error.path}: ")}, b""
    except MemoryError:
        return {"reason": "needs more memory than there is; cut it into shorter takes"}, b""
    except Exception as error:
        return {"reason": f"reading failed unexpectedly ({type(error).__name__}: {error})"}, b""
    records = [
        {
            "frames": len(clip.motion),
            "fps": clip.motion.fps,
            "part": clip.part,
            "rig": clip.rig,
            "reading": clip.reading.record(),
        }
        for clip in clips
    ]
    return {"clips": records}, b"".join(clip.motion.joints.tobytes() for clip in clips)


if __name__ == "__main__":
    serve()
