"""The reading process: one request a line on stdin, one response on stdout, until stdin ends.

It begins with READY. A request is a JSON object with `path`, `fps` and `joint_map`; a response is a JSON line,
followed by the joints as float32 bytes where it names `frames`. Files are not trusted: one that crashes or hangs costs
one process.
"""

from __future__ import annotations

import json
import os
import signal
import sys
from hashlib import blake2b
from importlib import import_module
from typing import Any

from encoders.errors import UnreadableMotion
from encoders.motion import Motion
from indexer.formats.reading import read_take
from indexer.rigs.retarget import retarget

READY = b"ready\n"


def read(path: str, fps: float | None, joint_map: dict[str, str] | None) -> tuple[Motion, str]:
    """A file's motion and its rig: root joint, number of joints and four digits that tell namings apart.

    A joint map that names joints which the file does not have is meant for other files and ignored.

    Raises
    ------
    UnreadableMotion
        See `indexer.ingest.load.load_motion`.
    """
    take = read_take(path, fps=fps)
    digest = blake2b("\0".join(take.names).encode("utf-8", "replace"), digest_size=2).hexdigest()
    rig = f"{take.names[0]}-{len(take.names)}-{digest}" if take.names else ""
    unknown = [name for name in (joint_map or {}).values() if name not in take.names]
    try:
        return retarget(take, path=path, joint_map=None if unknown else joint_map), rig
    except UnreadableMotion as error:
        if not unknown:
            raise
        raise UnreadableMotion(path, f"{error.reason} (the joint map given names {unknown[0]!r}, not in it)") from None


def serve(target: str = "indexer.ingest.worker:read") -> None:
    """Serve requests with a function named as "module:function", of the signature of `read`."""
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
        motion, rig = function(request["path"], request["fps"], request["joint_map"])
    except UnreadableMotion as error:
        return {"reason": str(error).removeprefix(f"{error.path}: ")}, b""
    except MemoryError:
        return {"reason": "needs more memory than there is; cut it into shorter takes"}, b""
    except Exception as error:
        return {"reason": f"reading failed unexpectedly ({type(error).__name__}: {error})"}, b""
    return {"frames": len(motion), "fps": motion.fps, "rig": rig}, motion.joints.tobytes()


if __name__ == "__main__":
    serve()
