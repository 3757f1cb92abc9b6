"""The reading process: one request a line on stdin, one response on stdout, until stdin ends.

It begins with READY. A request is a JSON object with the limits for the file, `memory` and `seconds`, and with the
arguments of `indexer.ingest.load.read_motions`; a response is a JSON line with the `reason` why the file cannot be read
and whether that `passes` or is `doubted`, or with its `clips`, followed by their joints as float32 bytes in the same
order. Files are not trusted: one that crashes or hangs costs one process.
"""

from __future__ import annotations

import json
import os
import signal
import sys
from importlib import import_module
from typing import Any

import numpy as np

from encoders.errors import UnreadableMotion
from indexer.ingest import worker_limits
from indexer.read_motion import ReadMotion

READY = b"ready\n"

#: Bounds of a response: frames of all clips together, 14 hours at 20 a second, bytes of the JSON line, and characters
#: of the reason.
MAX_FRAMES, MAX_HEADER, MAX_REASON = 1_000_000, 16 << 20, 2000

TOO_MUCH_MEMORY = "needs more memory than a file of its size may take; cut it into shorter takes"


def serve(target: str = "indexer.ingest.load:read_motions", parent: int | None = None) -> None:
    """Serve requests with a function named as "module:function", of the signature of `read_motions`.

    Parameters
    ----------
    parent : int, optional
        The process whose end ends this one.
    """
    if parent is not None:
        worker_limits.die_with(parent)
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C is the parent's; it ends this process by closing stdin
    module, name = target.split(":")
    function = getattr(import_module(module), name)
    answers = os.fdopen(os.dup(1), "wb")
    os.dup2(os.open(os.devnull, os.O_WRONLY), 1)  # what a reader prints must not mix with the responses
    answers.write(READY)
    answers.flush()
    for line in sys.stdin.buffer:
        request = json.loads(line)
        worker_limits.limit(request.pop("memory"), request.pop("seconds"))
        header, clips = _answer(function, request)
        answers.write(_line(header) + b"\n")
        for clip in clips:
            answers.write(np.ascontiguousarray(clip.motion.joints).data)
        answers.flush()


def _answer(function: Any, request: dict[str, Any]) -> tuple[dict[str, Any], list[ReadMotion]]:
    try:
        clips: list[ReadMotion] = function(**request)
        if sum(len(clip.motion) for clip in clips) > MAX_FRAMES:
            raise UnreadableMotion(request["path"], "more than 14 hours of motion at once; cut it into shorter takes")
    except UnreadableMotion as error:
        passes = isinstance(error.__cause__, OSError)
        return {"reason": str(error).removeprefix(f"{error.path}: "), "passes": passes, "doubted": False}, []
    except MemoryError:
        # Where the limit is the system's, other programs may have taken what there is.
        return {"reason": TOO_MUCH_MEMORY, "passes": False, "doubted": not worker_limits.LIMITS_MEMORY}, []
    except Exception as error:
        reason = f"reading failed unexpectedly ({type(error).__name__}: {error})"
        return {"reason": reason, "passes": isinstance(error, OSError), "doubted": False}, []
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
    return {"clips": records}, clips


def _line(header: dict[str, Any]) -> bytes:
    """The first line of a response, with a reason that the parent takes."""
    if "reason" in header:
        header["reason"] = header["reason"][:MAX_REASON].encode("utf-8", "replace").decode()
    return json.dumps(header).encode()


if __name__ == "__main__":
    serve()
