"""The reading process: one request a line on stdin, one response on stdout, until stdin ends.

It begins with READY. A request is a JSON object with the arguments of `indexer.ingest.load.read_motions`; a response is
a JSON line with the `reason` why the file cannot be read and whether that `passes`, or with its `clips`, followed by
their joints as float32 bytes in the same order. Files are not trusted: one that crashes or hangs costs one process.
"""

from __future__ import annotations

import json
import os
import signal
import sys
from importlib import import_module
from typing import Any

from encoders.errors import UnreadableMotion
from indexer.read_motion import ReadMotion

READY = b"ready\n"


def serve(target: str = "indexer.ingest.load:read_motions") -> None:
    """Serve requests with a function named as "module:function", of the signature of `read_motions`."""
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
        passes = isinstance(error.__cause__, OSError)
        return {"reason": str(error).removeprefix(f"{error.path}: "), "passes": passes}, b""
    except MemoryError:
        return {"reason": "needs more memory than there is; cut it into shorter takes", "passes": False}, b""
    except Exception as error:
        reason = f"reading failed unexpectedly ({type(error).__name__}: {error})"
        return {"reason": reason, "passes": isinstance(error, OSError)}, b""
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
